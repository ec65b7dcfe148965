// Walks through the elements of a DICOM file (PS3.5 chapter 7, PS3.10); see the header.
#include "io/helper/dicom_check.hpp"

#include <algorithm>
#include <charconv>
#include <set>

#include "io/helper/dicom_bytes.hpp"
#include "io/helper/dicom_pixels.hpp"
#include "io/inflate.hpp"

namespace palpate::io {
namespace {

constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t item = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr std::uint32_t pixel_data = 0x7fe00010;
constexpr int deepest = 64;
constexpr std::uint64_t most_beside_pixels = std::uint64_t{64} << 20;  // of a deflated file
const char* const deflated_syntax = "1.2.840.10008.1.2.1.99";

struct Element {
    std::uint32_t tag = 0;
    std::uint32_t length = 0;
    std::string vr;
};

class Walk {
  public:
    explicit Walk(const std::filesystem::path& file) : file_(file), bytes_(file) {}

    DicomExtent whole_file() {
        try {
            const std::string syntax = meta_information();
            begin_data_set(syntax);
            walk(data_set_, UINT64_MAX, syntax != "1.2.840.10008.1.2", 0);
            if (extent_.rows > 0 && extent_.columns > 0) check_pixels(syntax);
        } catch (const DamagedStream& e) {
            fail(std::string("is damaged (") + e.what() + ")");
        }
        return extent_;
    }

    /// After whole_file(): all of a deflated file, with the transfer syntax of one that is not.
    std::vector<std::byte> inflated() const {
        const auto all = bytes_.unpacked();
        std::vector<std::byte> plain(all.begin(), all.end());
        // One UID is the beginning of the other; the rest is padding.
        std::fill_n(plain.begin() + static_cast<std::ptrdiff_t>(syntax_at_ + 19), 3, std::byte{0});
        return plain;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Failure(quoted(file_) + " " + what + "; copy or export it again");
    }

    /// Group 2, which is explicit little endian in every file; returns the transfer syntax.
    std::string meta_information() {
        if (!bytes_.reaches(140)) fail("is too short for a DICOM file");
        std::uint64_t at = 132;
        std::string syntax;
        while (bytes_.reaches(at + 8) && number<std::uint16_t>(at) == 0x0002) {
            const Element e = element(at, true);
            if (e.tag == 0x00020002) extent_.sop_class = text(at, e);
            if (e.tag == 0x00020010) {
                syntax = text(at, e);
                syntax_at_ = at;
            }
            at = past_value(at, e);
        }
        if (extent_.sop_class.empty()) fail("is cut off in its first lines, or damaged there");
        data_set_ = at;
        return syntax;
    }

    void begin_data_set(const std::string& syntax) {
        if (syntax == "1.2.840.10008.1.2.2") bytes_.set_swapped();
        extent_.deflated = syntax == deflated_syntax;
        if (!extent_.deflated) return;
        bytes_.deflated_from(data_set_);
        extent_.compression = "deflate";
    }

    template <class T>
    T number(std::uint64_t at) {
        if (!bytes_.reaches(at + sizeof(T))) fail("is cut off");
        return bytes_.number<T>(at);
    }

    std::uint32_t tag_at(std::uint64_t at) {
        return std::uint32_t{number<std::uint16_t>(at)} << 16 | number<std::uint16_t>(at + 2);
    }

    /// Reads tag, type and length; moves `at` to the value.
    Element element(std::uint64_t& at, bool is_explicit) {
        Element e;
        e.tag = tag_at(at);
        at += 4;
        if (!is_explicit || e.tag >> 16 == 0xfffe) {
            e.length = number<std::uint32_t>(at);
            at += 4;
            return e;
        }
        e.vr = {number<char>(at), number<char>(at + 1)};
        static const std::set<std::string> long_ones = {"OB", "OW", "OF", "OD", "OL", "OV", "SQ",
                                                        "UC", "UR", "UT", "UN", "SV", "UV"};
        static const std::set<std::string> short_ones = {"AE", "AS", "AT", "CS", "DA", "DS", "DT",
                                                         "FD", "FL", "IS", "LO", "LT", "PN", "SH",
                                                         "SL", "SS", "ST", "TM", "UI", "UL", "US"};
        const bool is_long = long_ones.count(e.vr) > 0;
        if (!is_long && short_ones.count(e.vr) == 0)
            fail("is damaged (an element of no known type)");
        e.length = is_long ? number<std::uint32_t>(at + 4) : number<std::uint16_t>(at + 2);
        at += is_long ? 8 : 4;
        return e;
    }

    std::string text(std::uint64_t at, const Element& e) {
        std::string value;
        for (std::uint64_t i = 0; i < std::min<std::uint32_t>(e.length, 64); ++i) {
            const char c = number<char>(at + i);
            if (c != '\0') value += c;
        }
        return trimmed(value);
    }

    std::uint64_t past_value(std::uint64_t at, const Element& e) {
        const std::uint64_t end = at + e.length;
        if (extent_.deflated && end > data_set_ + most_beside_pixels + allowed_pixels_) {
            fail("is damaged (its deflated data unpack to more than its header asks for)");
        }
        if (!bytes_.reaches(end)) fail("is cut off or damaged (an element reaches beyond its end)");
        return end;
    }

    std::int64_t* size_in(std::uint32_t tag) {
        switch (tag) {
            case 0x00280002:
                return &extent_.components;
            case 0x00280008:
                return &extent_.frames;
            case 0x00280010:
                return &extent_.rows;
            case 0x00280011:
                return &extent_.columns;
            case 0x00280100:
                return &extent_.bits;
            default:
                return nullptr;
        }
    }

    /// The elements that say how large the image is; one that comes twice may say two things.
    void take_size(std::uint64_t at, const Element& e) {
        std::int64_t* const size = size_in(e.tag);
        if (size == nullptr || e.length == 0) return;
        if (!taken_.insert(e.tag).second) fail("is damaged (it gives the size of its image twice)");
        if (size != &extent_.frames) {
            *size = number<std::uint16_t>(at);
            return;
        }
        const std::string digits = text(at, e);
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), extent_.frames);
        const bool is_number = error == std::errc{} && end == digits.data() + digits.size();
        if (!is_number || extent_.frames < 1 || extent_.frames > 1 << 20) {
            fail("has '" + digits.substr(0, 20) + "' frames, which is not possible");
        }
    }

    /// The elements from `at` up to `end`, or up to the end of an item or of the file; returns
    /// where it stopped.
    std::uint64_t walk(std::uint64_t at, std::uint64_t end, bool is_explicit, int depth) {
        if (depth > deepest) fail("is damaged (nested too deep)");
        while (at < end && (depth > 0 || bytes_.reaches(at + 1))) {
            if (!bytes_.reaches(at + 8)) fail("is cut off");
            const Element e = element(at, is_explicit);
            if (e.tag == item_end || e.tag == sequence_end) return at;
            if (depth == 0) take_size(at, e);
            const bool pixels = e.tag == pixel_data && depth == 0;
            if (pixels) begin_pixels(at, e);
            if (e.length != undefined_length) {
                at = past_value(at, e);
            } else {
                // A sequence of unknown type is always implicit (PS3.5, 6.2.2).
                at = items(at, is_explicit && e.vr != "UN", pixels, depth);
            }
        }
        return at;
    }

    void begin_pixels(std::uint64_t at, const Element& e) {
        if (pixels_.found) fail("is damaged (it has its samples twice)");
        pixels_.found = true;
        if (e.length == undefined_length) return;
        pixels_.plain = e.length;
        // Before as much is unpacked.
        if (extent_.rows > 0 && extent_.columns > 0) check_plain_pixels(file_, e.length, extent_);
        allowed_pixels_ = at - data_set_ + e.length;
    }

    /// The items of a sequence, or the fragments of compressed pixel data, without a length.
    std::uint64_t items(std::uint64_t at, bool is_explicit, bool fragments, int depth) {
        while (true) {
            if (!bytes_.reaches(at + 8)) fail("is cut off (a sequence has no end)");
            const Element e = element(at, is_explicit);
            if (e.tag == sequence_end) return at;
            if (e.tag != item) fail("is damaged (a sequence has something else than items)");
            if (e.length != undefined_length) {
                if (fragments) pixels_.fragments.push_back({at, e.length});
                at = past_value(at, e);
            } else if (fragments) {
                fail("is damaged (a fragment has no length)");
            } else {
                at = walk(at, UINT64_MAX, is_explicit, depth + 1);
            }
        }
    }

    void check_pixels(const std::string& syntax) {
        if (!pixels_.found) return;  // GDCM says so
        if (pixels_.plain) {
            if (const auto note = check_plain_pixels(file_, *pixels_.plain, extent_)) {
                extent_.notes.push_back(*note);
            }
            return;
        }
        extent_.compression = check_compressed_pixels(file_, syntax, bytes_, pixels_, extent_);
    }

    const std::filesystem::path& file_;
    DicomBytes bytes_;
    DicomExtent extent_;
    DicomPixels pixels_;
    std::set<std::uint32_t> taken_;
    std::uint64_t syntax_at_ = 0, data_set_ = 0;
    std::uint64_t allowed_pixels_ = 0;  // bytes of a deflated file up to the end of its pixels
};

}  // namespace

std::uint64_t DicomExtent::bytes() const {
    return (static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns) *
                static_cast<std::uint64_t>(frames) * static_cast<std::uint64_t>(components) *
                static_cast<std::uint64_t>(bits) +
            7) /
           8;
}

DicomExtent check_dicom(const std::filesystem::path& file) {
    return Walk(file).whole_file();
}

std::vector<std::byte> inflated_dicom(const std::filesystem::path& file) {
    Walk walk(file);
    walk.whole_file();
    return walk.inflated();
}

bool has_no_image(const std::string& sop_class) {
    static const char* const storage = "1.2.840.10008.5.1.4.1.1.";
    if (sop_class == "1.2.840.10008.1.3.10") return true;  // DICOMDIR
    for (const char* kind : {"9.", "11.", "66", "88.", "104.", "481."}) {
        if (sop_class.rfind(storage + std::string(kind), 0) == 0) return true;
    }
    return false;
}

}  // namespace palpate::io

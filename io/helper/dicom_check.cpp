// Walks through the elements of a DICOM file (PS3.5 chapter 7, PS3.10). See the header.
#include "io/helper/dicom_check.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <map>
#include <set>

#include "io/helper/dicom_bytes.hpp"
#include "io/helper/dicom_pixels.hpp"
#include "io/inflate.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t item = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr std::uint32_t pixel_data = 0x7fe00010;
constexpr int deepest = 64;
constexpr std::uint64_t most_beside_pixels = std::uint64_t{64} << 20;  // of a deflated file
constexpr std::size_t most_changes = 10000;  // 16 overlays have some 20 elements each
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
            if (extent_.sop_class.empty()) fail("is cut off in its first lines, or damaged there");
            take_out_overlays();
            take_high_bit();
            extent_.needs_copy = extent_.deflated || !changes_.empty();
            if (extent_.rows > 0 && extent_.columns > 0) check_pixels(syntax);
        } catch (const DamagedStream& e) {
            fail(std::string("is damaged (") + e.what() + ")");
        }
        return extent_;
    }

    /// After whole_file().
    std::vector<std::byte> tidied() {
        const auto all =
            extent_.deflated ? bytes_.unpacked() : bytes_.view(0, bytes_.mapped_size());
        std::vector<std::byte> tidy;
        tidy.reserve(all.size());
        std::uint64_t from = 0;
        const auto copy_up_to = [&](std::uint64_t end) {
            tidy.insert(tidy.end(), all.begin() + static_cast<std::ptrdiff_t>(from),
                        all.begin() + static_cast<std::ptrdiff_t>(end));
        };
        if (extent_.deflated) {
            // One UID is the beginning of the other; the rest is padding.
            changes_.push_back({syntax_at_ + 19, 3, std::string(3, '\0')});
        }
        std::ranges::sort(changes_, {}, &Change::at);
        for (const Change& change : changes_) {
            copy_up_to(change.at);
            for (const char c : change.put) tidy.push_back(static_cast<std::byte>(c));
            from = change.at + change.removed;
        }
        copy_up_to(all.size());
        return tidy;
    }

  private:
    /// Bytes in place of others.
    struct Change {
        std::uint64_t at = 0, removed = 0;
        std::string put;
    };

    [[noreturn]] void fail(const std::string& what) const {
        throw Failure(quoted(file_) + " " + what + "; copy or export it again");
    }

    /// Group 2, which is explicit little endian in every file; returns the transfer syntax. Some
    /// files have no such group, and some not the 128 bytes and four letters before it (PS3.10).
    std::string meta_information() {
        if (!bytes_.reaches(140)) fail("is too short for a DICOM file");
        std::uint64_t at = number<std::uint32_t>(128) == 0x4d434944 ? 132 : 0;  // "DICM"
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
        data_set_ = at;
        if (!syntax.empty()) return syntax;
        extent_.notes.emplace_back(
            "it does not say how its elements are written (no transfer "
            "syntax): that was seen from the first of them");
        return is_upper(number<char>(at + 4)) && is_upper(number<char>(at + 5))
                   ? "1.2.840.10008.1.2.1"
                   : "1.2.840.10008.1.2";
    }

    static bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

    void begin_data_set(const std::string& syntax) {
        if (syntax == "1.2.840.10008.1.2.2") bytes_.set_swapped();
        extent_.deflated = syntax == deflated_syntax;
        if (!extent_.deflated) return;
        bytes_.deflated_from(data_set_, most_beside_pixels);
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
        std::string digits = text(at, e);
        if (digits.starts_with('+')) digits.erase(0, 1);
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
            if (depth == 0 && only_zeros_from(at)) return at;
            if (!bytes_.reaches(at + 8)) fail("is cut off");
            const std::uint64_t start = at;
            const Element e = element(at, is_explicit);
            const std::uint64_t value = at;
            if (e.tag == item_end || e.tag == sequence_end) return at;
            if (depth == 0) take_size(at, e);
            const bool pixels = e.tag == pixel_data && depth == 0;
            if (pixels) begin_pixels(e);
            if (e.length != undefined_length) {
                at = past_value(at, e);
                if (depth == 0) tidy_up(start, value, e);
            } else {
                // A sequence of unknown type is always implicit (PS3.5, 6.2.2).
                at = items(at, is_explicit && e.vr != "UN", pixels, depth);
            }
        }
        return at;
    }

    /// Padding to the blocks of a medium, after the last element.
    bool only_zeros_from(std::uint64_t at) {
        // Elements may be zeros, too: every byte is looked at once.
        if (at < zeros_end_) return false;
        std::uint64_t& end = zeros_end_;
        for (end = at; bytes_.reaches(end + 1); ++end) {
            if (number<char>(end) != 0) return false;
        }
        change({at, end - at, ""});  // GDCM aborts on some of them
        extent_.notes.push_back("there are " + std::to_string(end - at) +
                                " zero bytes after its last element: they were ignored");
        return true;
    }

    std::string bytes_of(std::uint16_t number) const {
        const char low = static_cast<char>(number & 0xff), high = static_cast<char>(number >> 8);
        return bytes_.swapped() ? std::string{high, low} : std::string{low, high};
    }

    void change(Change what) {
        count_change();
        changes_.push_back(std::move(what));
    }

    /// They would need more memory than the elements themselves if there were as many.
    void count_change() {
        if (++counted_changes_ > most_changes) {
            fail("is damaged (it has elements again and again that an image has once)");
        }
    }

    /// What a library is to be given instead of an element of the data set, which is all there.
    void tidy_up(std::uint64_t start, std::uint64_t at, const Element& e) {
        // Of PixelSpacing and other lengths, positions and slopes.
        static const std::set<std::uint32_t> numbers = {
            0x00180050, 0x00180088, 0x00181164, 0x00200032, 0x00200037,
            0x00280030, 0x00182010, 0x00201041, 0x00281052, 0x00281053};
        if (e.tag == 0x00080016 && extent_.sop_class.empty()) extent_.sop_class = text(at, e);
        if (e.tag == 0x00280101 && e.length == 2) stored_at_ = at;
        if (e.tag == 0x00280102 && e.length == 2) high_bit_ = number<std::uint16_t>(at);
        if (e.tag == 0x00280004 && text(at, e) == "MONOCHROME1") {
            std::uint64_t one = at;
            while (number<char>(one) != '1') ++one;
            change({one, 1, "2"});
            add_note(extent_.notes,
                     "its MONOCHROME1 says that greater values are shown darker: "
                     "values were taken as they are stored");
        }
        if (e.tag >> 24 == 0x60) {
            count_change();
            Overlay& overlay = overlays_[e.tag >> 16];
            overlay.elements.push_back({start, at + e.length - start, ""});
            overlay.has_data |= (e.tag & 0xffff) == 0x3000;
        }
        if (numbers.contains(e.tag) && e.length <= 1024) tidy_number(start, at, e);
    }

    /// Samples above the lowest of their bits, as old files may have them. GDCM would take some of
    /// their bits off: for it, they use the bits below as well.
    void take_high_bit() {
        if (stored_at_ == 0 || high_bit_ > 31 || !pixels_.plain) return;
        const int stored = number<std::uint16_t>(stored_at_), used = high_bit_ + 1;
        if (stored == 0 || used <= stored) return;
        extent_.shift = used - stored;
        change({stored_at_, 2, bytes_of(static_cast<std::uint16_t>(used))});
        add_note(extent_.notes, "its samples lie " + std::to_string(extent_.shift) +
                                    " bits above the lowest (HighBit): they were shifted down");
    }

    /// Numbers of a binary type where a text is usual, which GDCM aborts on; empty for texts.
    std::string binary_as_text(std::uint64_t at, const Element& e) {
        std::string text;
        const auto append = [&](auto zero) {
            using T = decltype(zero);
            for (std::uint64_t i = 0; i + sizeof(T) <= e.length; i += sizeof(T)) {
                if (!text.empty()) text += '\\';
                append_number(text, static_cast<double>(number<T>(at + i)));
            }
        };
        if (e.vr == "FD") append(double{});
        if (e.vr == "FL") append(float{});
        if (e.vr == "SS") append(std::int16_t{});
        if (e.vr == "US") append(std::uint16_t{});
        if (e.vr == "SL") append(std::int32_t{});
        if (e.vr == "UL") append(std::uint32_t{});
        return text;
    }

    void tidy_number(std::uint64_t start, std::uint64_t at, const Element& e) {
        std::string value = binary_as_text(at, e);
        const bool is_binary = !value.empty();
        for (std::uint64_t i = 0; i < e.length && !is_binary; ++i) value += number<char>(at + i);
        value = trimmed(value.substr(0, value.find('\0')));
        const bool one_length = e.tag == 0x00280030 && !value.empty() &&
                                value.find_first_of("\\,") == std::string::npos;
        if (one_length) {
            value += '\\' + value;
            add_note(extent_.notes,
                     "its PixelSpacing has one number, which was taken for rows "
                     "and columns");
        }
        static const std::set<std::string> texts = {"UT", "UC", "LT", "ST", "LO", "SH", "CS"};
        const bool other_type = texts.contains(e.vr);
        if (!one_length && !other_type && !is_binary) return;
        if (value.size() % 2 == 1) value += ' ';
        const auto length = static_cast<std::uint16_t>(value.size());
        // Without types, the length has four bytes.
        const std::string head = !e.vr.empty()      ? "DS" + bytes_of(length)
                                 : bytes_.swapped() ? bytes_of(0) + bytes_of(length)
                                                    : bytes_of(length) + bytes_of(0);
        change({start + 4, at + e.length - start - 4, head + value});
    }

    /// Overlays without data of their own lie in bits that the samples do not use.
    void take_out_overlays() {
        for (auto& [group, overlay] : overlays_) {
            if (overlay.has_data) continue;
            std::ranges::move(overlay.elements, std::back_inserter(changes_));
            add_note(extent_.notes, "overlays in unused bits of its samples were ignored");
        }
    }

    void begin_pixels(const Element& e) {
        if (pixels_.found) fail("is damaged (it has its samples twice)");
        pixels_.found = true;
        if (e.length == undefined_length) return;
        pixels_.plain = e.length;
        // Before as much is unpacked. Samples of no declared size are allowed no memory.
        if (extent_.rows < 1 || extent_.columns < 1) return;
        check_plain_pixels(file_, e.length, extent_);
        bytes_.allow(e.length);
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
    std::vector<Change> changes_;
    std::size_t counted_changes_ = 0;
    struct Overlay {
        std::vector<Change> elements;
        bool has_data = false;
    };
    std::map<std::uint32_t, Overlay> overlays_;  // by group
    std::uint64_t syntax_at_ = 0, data_set_ = 0, stored_at_ = 0;
    std::uint16_t high_bit_ = 0;
    std::uint64_t zeros_end_ = 0;  // where the last run of zeros that was looked at ends
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

std::vector<std::byte> tidied_dicom(const std::filesystem::path& file) {
    Walk walk(file);
    walk.whole_file();
    return walk.tidied();
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

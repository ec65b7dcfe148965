// Walks through the elements of a DICOM file (PS3.5 chapter 7, PS3.10); see the header.
#include "io/helper/dicom_check.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <set>

namespace palpate::io {
namespace {

constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t item = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr std::uint32_t pixel_data = 0x7fe00010;
constexpr int deepest = 64;

struct Element {
    std::uint32_t tag = 0;
    std::uint32_t length = 0;
    std::string vr;
};

class Walk {
  public:
    explicit Walk(const std::filesystem::path& file)
        : file_(file), in_(file, std::ios::binary), size_(std::filesystem::file_size(file)) {}

    DicomExtent whole_file() {
        if (size_ < 140) fail("is too short for a DICOM file");
        std::uint64_t at = 132;
        std::string syntax;
        while (at + 8 <= size_ && number<std::uint16_t>(at) == 0x0002) {
            const Element e = element(at, true);
            if (e.tag == 0x00020002) extent_.sop_class = text(at, e);
            if (e.tag == 0x00020010) syntax = text(at, e);
            at = past_value(at, e);
        }
        if (extent_.sop_class.empty()) fail("is cut off in its first lines, or damaged there");
        // Deflated and big-endian files are rare and left to GDCM.
        if (syntax == "1.2.840.10008.1.2.1.99" || syntax == "1.2.840.10008.1.2.2") return extent_;
        walk(at, size_, syntax != "1.2.840.10008.1.2", 0);
        return extent_;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Failure(quoted(file_) + " " + what + "; copy or export it again");
    }

    template <class T>
    T number(std::uint64_t at) {
        std::array<char, sizeof(T)> bytes{};
        in_.clear();
        in_.seekg(static_cast<std::streamoff>(at));
        in_.read(bytes.data(), sizeof(T));
        if (!in_) fail("is cut off");
        T value;
        std::memcpy(&value, bytes.data(), sizeof value);
        return value;
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

    std::uint64_t past_value(std::uint64_t at, const Element& e) const {
        if (e.length > size_ - std::min(at, size_)) {
            fail("is cut off or damaged (an element reaches beyond its end)");
        }
        return at + e.length;
    }

    /// The elements from `at` up to `end`, or up to the end of an item; returns where it stopped.
    std::uint64_t walk(std::uint64_t at, std::uint64_t end, bool is_explicit, int depth) {
        if (depth > deepest) fail("is damaged (nested too deep)");
        while (at < end) {
            if (end - at < 8) fail("is cut off");
            const Element e = element(at, is_explicit);
            if (e.tag == item_end || e.tag == sequence_end) return at;
            if (e.tag == pixel_data && depth == 0 && e.length != undefined_length) {
                extent_.pixel_data = e.length;
            }
            if (e.length != undefined_length) {
                at = past_value(at, e);
            } else {
                // A sequence of unknown type is always implicit (PS3.5, 6.2.2).
                at = items(at, is_explicit && e.vr != "UN", e.tag == pixel_data, depth);
            }
        }
        return at;
    }

    /// The items of a sequence, or the fragments of compressed pixel data, without a length.
    std::uint64_t items(std::uint64_t at, bool is_explicit, bool fragments, int depth) {
        while (true) {
            if (size_ - std::min(at, size_) < 8) fail("is cut off (a sequence has no end)");
            const Element e = element(at, is_explicit);
            if (e.tag == sequence_end) return at;
            if (e.tag != item) fail("is damaged (a sequence has something else than items)");
            if (e.length != undefined_length) {
                at = past_value(at, e);
            } else if (fragments) {
                fail("is damaged (a fragment has no length)");
            } else {
                at = walk(at, size_, is_explicit, depth + 1);
            }
        }
    }

    const std::filesystem::path& file_;
    std::ifstream in_;
    std::uint64_t size_;
    DicomExtent extent_;
};

}  // namespace

DicomExtent check_dicom(const std::filesystem::path& file) {
    return Walk(file).whole_file();
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

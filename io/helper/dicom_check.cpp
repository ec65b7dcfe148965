// Walks through the elements of a DICOM file (PS3.5 chapter 7, PS3.10). See the header.
#include "io/helper/dicom_check.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "io/helper/dicom_elements.hpp"
#include "io/helper/dicom_pixels.hpp"
#include "io/inflate.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t item = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr std::uint32_t pixel_data = 0x7fe00010, float_pixels = 0x7fe00008,
                        double_pixels = 0x7fe00009;
constexpr int deepest = 64;
constexpr std::uint64_t most_beside_pixels = std::uint64_t{64} << 20;  // of a deflated file
constexpr int most_repeated = 10000;
const char* const implicit_syntax = "1.2.840.10008.1.2";
const char* const explicit_syntax = "1.2.840.10008.1.2.1";
const char* const big_endian_syntax = "1.2.840.10008.1.2.2";
/// GE's own: elements are implicit and little-endian, samples are big-endian.
const char* const ge_syntax = "1.2.840.113619.5.2";
const char* const deflated_syntax = "1.2.840.10008.1.2.1.99";
const char* const jpeg_2000_syntax = "1.2.840.10008.1.2.4.90";

/// JPEG 2000 with another coding of its blocks, which the library that unpacks it reads as well.
bool is_high_throughput(const std::string& syntax) {
    return syntax.starts_with("1.2.840.10008.1.2.4.20");
}

/// All that stands before a data set of this syntax, for libraries.
std::string start_of_file(std::string syntax) {
    if (syntax.size() % 2 == 1) syntax += '\0';
    const auto size = static_cast<char>(syntax.size());
    std::string start(128, '\0');
    start += "DICM";
    start += std::string("\2\0\0\0UL\4\0", 8) + static_cast<char>(size + 8) + std::string(3, '\0');
    start += std::string("\2\0\x10\0UI", 6) + size + '\0' + syntax;
    return start;
}

/// A number of bits from the bit `first` on, the lowest of each byte first (PS3.5, 8.1.1).
std::vector<std::byte> one_byte_each(std::span<const std::byte> bytes, std::uint64_t first,
                                     std::uint64_t count) {
    std::vector<std::byte> all(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t bit = first + i;
        all[i] = bytes[bit / 8] >> static_cast<int>(bit % 8) & std::byte{1};
    }
    return all;
}

class Walk : private DicomElements {
  public:
    explicit Walk(const std::filesystem::path& file) : DicomElements(file) {}

    DicomExtent whole_file() {
        try {
            const std::string syntax = meta_information();
            begin_data_set(syntax);
            const bool is_explicit = has_types(syntax);
            walk(data_set_, UINT64_MAX, is_explicit, 0);
            if (extent_.sop_class.empty()) note_no_class();
            if (extent_.rows > 0 && extent_.columns > 0) check_pixels();
            take_header(is_explicit);
        } catch (const DamagedStream& e) {
            fail(std::string("is damaged (") + e.what() + ")");
        }
        return extent_;
    }

    /// After whole_file().
    void read_frames(const std::vector<int>& wanted, const UseFrame& use) {
        if (!pixels_.plain) {
            const auto streams = streams_of(bytes_, pixels_, extent_).frames;
            const auto count = static_cast<std::uint64_t>(extent_.rows * extent_.columns);
            for (const int frame : wanted) {
                const auto bytes =
                    frame_of(file_, streams.at(static_cast<std::size_t>(frame)), extent_);
                use(frame, extent_.bits == 1 ? one_byte_each(bytes, 0, count) : bytes);
            }
            return;
        }
        const auto samples = static_cast<std::uint64_t>(extent_.rows * extent_.columns);
        const auto bits = samples * static_cast<std::uint64_t>(extent_.bits * extent_.components);
        for (const int frame : wanted) {
            const std::uint64_t first = static_cast<std::uint64_t>(frame) * bits;
            const auto bytes =
                bytes_.view(pixels_.at + first / 8, (first + bits + 7) / 8 - first / 8);
            if (extent_.bits == 1) {
                use(frame, one_byte_each(bytes, first % 8, bits));
            } else {
                use(frame, bytes);
            }
        }
    }

  private:
    /// Group 2, which should be explicit little endian in every file; returns the transfer syntax.
    /// Some files have no such group, and some not the 128 bytes and four letters before it
    /// (PS3.10).
    std::string meta_information() {
        if (!bytes_.reaches(140)) fail("is too short for a DICOM file");
        constexpr std::uint32_t letters = 0x4d434944;  // "DICM"
        std::uint64_t at = number<std::uint32_t>(128) == letters ? 132
                           : number<std::uint32_t>(0) == letters ? sizeof letters
                                                                 : 0;
        std::string syntax;
        while (bytes_.reaches(at + 8) && number<std::uint16_t>(at) == 0x0002) {
            const DicomElement e = element(at, true);
            if (e.tag == 0x00020002) extent_.sop_class = text(at, e);
            if (e.tag == 0x00020010) syntax = text(at, e);
            at = past_value(at, e);
        }
        data_set_ = at;
        lacks_types_ = false;  // counts for the data set
        if (!syntax.empty()) return syntax;
        extent_.notes.emplace_back(
            "it does not say how its elements are written (no transfer "
            "syntax): that was seen from the first of them");
        return is_upper(number<char>(at + 4)) && is_upper(number<char>(at + 5)) ? explicit_syntax
                                                                                : implicit_syntax;
    }

    /// Whether elements have types. Some writers name the syntax without types and write them. The
    /// first element tells it for a syntax that is not known.
    bool has_types(const std::string& syntax) {
        const bool is_told = syntax != implicit_syntax && syntax != ge_syntax && !is_unknown_;
        if (is_told || !bytes_.reaches(data_set_ + 8)) return true;
        const std::string first = {number<char>(data_set_ + 4), number<char>(data_set_ + 5)};
        if (!is_type(first)) return false;
        if (is_unknown_) return true;
        extent_.notes.emplace_back(
            "its transfer syntax says that elements have no types, and they have: they were read "
            "as "
            "they are");
        return true;
    }

    static bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

    void begin_data_set(const std::string& syntax) {
        if (syntax == big_endian_syntax) bytes_.set_swapped();
        is_unknown_ = !is_known_syntax(syntax) && syntax != ge_syntax;
        extent_.syntax = is_high_throughput(syntax) ? jpeg_2000_syntax : syntax;
        if (syntax != deflated_syntax) return;
        bytes_.deflated_from(data_set_, most_beside_pixels);
        extent_.compression = "deflate";
    }

    /// As in files of ACR-NEMA, before DICOM, and of programs that leave it out.
    void note_no_class() {
        if (extent_.rows < 1 || extent_.columns < 1 || !extent_.has_image) {
            fail("is cut off in its first lines, or damaged there");
        }
        extent_.notes.emplace_back(
            "it does not say of which class it is (SOPClassUID): it was taken as an image");
    }

    std::string text(std::uint64_t at, const DicomElement& e) {
        std::string value;
        for (std::uint64_t i = 0; i < std::min<std::uint32_t>(e.length, 64); ++i) {
            const char c = number<char>(at + i);
            if (c != '\0') value += c;
        }
        return trimmed(value);
    }

    std::uint64_t past_value(std::uint64_t at, const DicomElement& e) {
        const std::uint64_t end = at + e.length;
        if (!bytes_.reaches(end)) fail("is cut off or damaged (an element reaches beyond its end)");
        return end;
    }

    /// The elements that say how large the image is; one that comes twice may say two things.
    void take_size(std::uint64_t at, const DicomElement& e) {
        static const std::map<std::uint32_t, std::int64_t DicomExtent::*> sizes = {
            {0x00280002, &DicomExtent::components}, {0x00280008, &DicomExtent::frames},
            {0x00280010, &DicomExtent::rows},       {0x00280011, &DicomExtent::columns},
            {0x00280100, &DicomExtent::bits},       {0x00280101, &DicomExtent::stored_bits},
            {0x00280102, &DicomExtent::high_bit},   {0x00280103, &DicomExtent::representation}};
        const auto found = sizes.find(e.tag);
        if (found == sizes.end() || e.length == 0) return;
        std::int64_t& size = extent_.*found->second;
        if (!taken_.insert(e.tag).second) fail("is damaged (it gives the size of its image twice)");
        if (&size != &extent_.frames) {
            size = number<std::uint16_t>(at);
            return;
        }
        const std::string digits = text(at, e);
        extent_.frames = number_from<std::int64_t>(digits).value_or(-1);
        if (extent_.frames == 0) {
            extent_.frames = 1;
            extent_.notes.emplace_back("its NumberOfFrames is 0: 1 was taken");
        }
        if (extent_.frames < 1 || extent_.frames > 1 << 20) {
            fail("has '" + digits.substr(0, 20) + "' frames, which is not possible");
        }
    }

    /// The elements from `at` up to `end`, or up to the end of an item or of the file; returns
    /// where it stopped.
    std::uint64_t walk(std::uint64_t at, std::uint64_t end, bool is_explicit, int depth) {
        if (depth > deepest) fail("is damaged (nested too deep)");
        while (at < end && (depth > 0 || bytes_.reaches(at + 1))) {
            if (depth == 0 && (only_padding_from(at) || only_line_end_from(at))) return at;
            if (!bytes_.reaches(at + 8)) fail("is cut off");
            const std::uint64_t start = at;
            const DicomElement e = element(at, is_explicit);
            if (e.tag == item_end || e.tag == sequence_end) return at;
            if (depth == 0) {
                if (e.tag != 0 && e.tag == last_tag_ && ++repeated_ > most_repeated) {
                    fail("is damaged (it has elements again and again that an image has once)");
                }
                last_tag_ = e.tag;
                take_size(at, e);
            }
            if (depth == 0 && e.tag == 0x00080016 && extent_.sop_class.empty()) {
                extent_.sop_class = text(at, e);
            }
            if (depth == 0 && e.tag == 0x00280004) {
                extent_.is_subsampled = text(at, e).ends_with("_422");
            }
            const bool is_real = e.tag == float_pixels || e.tag == double_pixels;
            const bool pixels = (e.tag == pixel_data || is_real) && depth == 0;
            if (pixels) begin_pixels(start, at, e, is_real);
            if (e.length != undefined_length) {
                at = past_value(at, e);
            } else {
                // A sequence of unknown type is always implicit (PS3.5, 6.2.2).
                at = items(at, is_explicit && e.vr != "UN", pixels, depth);
            }
            if (depth == 0 && pixels_.found && e.tag < float_pixels) take_late(start, at);
        }
        return at;
    }

    /// Some programs add elements at the end of the file, behind the samples.
    void take_late(std::uint64_t start, std::uint64_t end) {
        const auto bytes = bytes_.view(start, end - start);
        late_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }

    /// Padding to the blocks of a medium, after the last element.
    bool only_padding_from(std::uint64_t at) {
        // Elements may be zeros, too: every byte is looked at once.
        if (at < padding_end_) return false;
        const auto first = number<std::uint8_t>(at);
        if (first != 0 && first != 0xff) return false;
        std::uint64_t& end = padding_end_;
        for (end = at; bytes_.reaches(end + 1); ++end) {
            if (number<std::uint8_t>(end) != first) return false;
        }
        extent_.notes.push_back("there are " + std::to_string(end - at) +
                                (first == 0 ? " zero bytes" : " bytes of 255") +
                                " after its last element: they were ignored");
        return true;
    }

    /// A line end after the last element, of programs that took the file for text.
    bool only_line_end_from(std::uint64_t at) {
        if (!pixels_.found || bytes_.reaches(at + 8)) return false;
        for (std::uint64_t i = at; bytes_.reaches(i + 1); ++i) {
            if (std::string("\r\n\x1a").find(number<char>(i)) == std::string::npos) return false;
        }
        extent_.notes.emplace_back("there is a line end after its last element: it was ignored");
        return true;
    }

    /// All that libraries see of the file, but for frames that they unpack: the data set up to its
    /// pixels, after a start of our own, because that of the file may be unusual.
    void take_header(bool is_explicit) {
        if (!pixels_.found) return;
        const auto bytes = bytes_.view(data_set_, pixels_.element - data_set_);
        extent_.header = start_of_file(!is_explicit       ? implicit_syntax
                                       : bytes_.swapped() ? big_endian_syntax
                                                          : explicit_syntax);
        const std::size_t start = extent_.header.size();
        extent_.header.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        for (const auto& [at, type] : given_types_) {
            if (at < data_set_ || at >= pixels_.element) continue;
            extent_.header.replace(start + at - data_set_, type.size(), type);
        }
        if (!late_.empty()) {
            extent_.header += late_;
            extent_.notes.emplace_back(
                "elements of its header stand behind its samples: they "
                "were used");
        }
        // GDCM looks a few bytes beyond an element without a type: an element that is not used
        // follows.
        constexpr std::size_t ahead = 64;
        if (lacks_types_) {
            extent_.header +=
                std::string("\xe0\x7f\1\0UN\0\0\x40\0\0\0", 12) + std::string(ahead, '\0');
        }
    }

    void begin_pixels(std::uint64_t element, std::uint64_t at, const DicomElement& e,
                      bool is_real) {
        if (pixels_.found) fail("is damaged (it has its samples twice)");
        pixels_.found = extent_.has_image = true;
        pixels_.element = element;
        pixels_.at = at;
        extent_.is_real = is_real;
        // Bytes have no order, but some writers call words so; other readers take them as words.
        const bool is_swapped_word = extent_.syntax == ge_syntax && extent_.bits > 8;
        if (is_swapped_word || (bytes_.swapped() && (e.vr != "OB" || extent_.bits > 8))) {
            extent_.swapped_bytes =
                static_cast<std::size_t>(std::max<std::int64_t>(2, extent_.bits / 8));
        }
        if (is_real) extent_.bits = e.tag == float_pixels ? 32 : 64;
        if (e.length == undefined_length) return;
        pixels_.plain = e.length;
        // Before as much is unpacked. Samples of no declared size are allowed no memory.
        if (extent_.rows < 1 || extent_.columns < 1) return;
        check_plain_size(file_, e.length, extent_);
        bytes_.allow(e.length);
    }

    /// The items of a sequence, or the fragments of compressed pixel data, without a length.
    std::uint64_t items(std::uint64_t at, bool is_explicit, bool fragments, int depth) {
        while (true) {
            if (fragments && !bytes_.reaches(at + 1)) {
                extent_.notes.emplace_back(
                    "it lacks the mark behind its samples, which are complete");
                return at;
            }
            if (!bytes_.reaches(at + 8)) fail("is cut off (a sequence has no end)");
            const DicomElement e = element(at, is_explicit);
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

    void check_pixels() {
        if (!pixels_.found) return;
        if (pixels_.plain) {
            if (is_unknown_) {
                extent_.notes.push_back("its transfer syntax '" + extent_.syntax +
                                        "' is not known: its samples were taken as little-endian "
                                        "and not compressed");
            }
            if (const auto note = check_plain_pixels(file_, bytes_, pixels_, extent_)) {
                extent_.notes.push_back(*note);
            }
            return;
        }
        check_compressed_pixels(file_, bytes_, pixels_, extent_);
    }

    DicomExtent extent_;
    DicomPixels pixels_;
    std::set<std::uint32_t> taken_;
    std::uint32_t last_tag_ = 0;
    int repeated_ = 0;
    std::uint64_t data_set_ = 0;
    std::string late_;               // elements behind the samples
    bool is_unknown_ = false;        // the transfer syntax
    std::uint64_t padding_end_ = 0;  // where the last run of one byte that was looked at ends
};

}  // namespace

int DicomExtent::shift() const {
    const bool makes_sense = stored_bits > 0 && high_bit >= stored_bits && high_bit < bits;
    return makes_sense && !is_real ? static_cast<int>(high_bit + 1 - stored_bits) : 0;
}

std::uint64_t DicomExtent::bytes() const {
    const std::int64_t values = is_subsampled && components == 3 ? 2 : components;  // of a pixel
    return (static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns) *
                static_cast<std::uint64_t>(frames) * static_cast<std::uint64_t>(values) *
                static_cast<std::uint64_t>(bits) +
            7) /
           8;
}

DicomExtent check_dicom(const std::filesystem::path& file) {
    return Walk(file).whole_file();
}

void read_frames(const std::filesystem::path& file, const std::vector<int>& frames,
                 const std::function<void(const DicomExtent&)>& begin, const UseFrame& use) {
    Walk walk(file);
    begin(walk.whole_file());
    walk.read_frames(frames, use);
}

bool has_no_image(const std::string& sop_class) {
    static const std::string storage = "1.2.840.10008.5.1.4.1.1.";
    // A DICOMDIR, a protocol, or a private class, as scanners write them beside their images.
    if (!sop_class.starts_with(storage)) return true;
    // Those with images. New classes are more often reports and records of all kinds.
    static const std::set<std::string> kinds = {"1",  "2",   "3",   "4",    "5",    "6",
                                                "7",  "12",  "13",  "14",   "20",   "30",
                                                "40", "128", "130", "66.4", "66.7", "77.1"};
    const std::string own = sop_class.substr(storage.size());
    if (own == "77.1.5.3") return true;  // stereometric relationships
    for (std::size_t end = own.size(); end != std::string::npos && end > 0;) {
        if (kinds.contains(own.substr(0, end))) return false;
        end = own.rfind('.', end - 1);
    }
    return true;
}

}  // namespace palpate::io

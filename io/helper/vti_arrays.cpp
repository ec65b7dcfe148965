// Checks the arrays of a VTI file. Format:
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html. VTK reads as many bytes as
// the type of an array takes, and ignores all others.
#include "io/helper/vti_arrays.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <pugixml.hpp>
#include <span>
#include <string_view>

#include "io/byte_order.hpp"
#include "io/helper/headers.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr double any_number = std::numeric_limits<double>::infinity();

/// Empty if there is no such attribute.
std::string attribute(const std::string& tag, const std::string& name) {
    pugi::xml_document element;
    element.load_string(("<" + tag + ">").c_str());  // it has no end, but its attributes
    return element.first_child().attribute(name.c_str()).value();
}

/// Refuses a number that its type cannot hold, and more than `most` numbers, of which VTK would
/// drop the last. What is no number stops VTK.
void check_numbers(const std::string& text, Stored stored, double most) {
    const auto [low, high] = with_stored(stored, [](auto zero) {
        using Limits = std::numeric_limits<decltype(zero)>;
        return std::pair(static_cast<double>(Limits::lowest()), static_cast<double>(Limits::max()));
    });
    const char *at = text.data(), *const end = at + text.size();
    double number = 0;
    for (double count = 1;; ++count) {
        at = std::find_if(at, end, [](char c) { return std::strchr(" \t\r\n", c) == nullptr; });
        const auto [next, error] = read_number(at, end, number);
        if (error != std::errc{}) return;
        if (count > most) {
            throw Failure(
                "an array has more numbers than its piece has samples; it is damaged: "
                "export it again");
        }
        if (std::isfinite(number) && (number < low || number > high)) {
            throw Failure("its data have the number " + text_of(number) +
                          ", which its sample type cannot hold; correct the type of its DataArray");
        }
        at = next;
    }
}

/// Samples at the points or in the cells of a piece.
double samples_of(const std::vector<double>& extent, bool in_cells) {
    double count = 1;
    for (std::size_t a = 0; a + 1 < extent.size(); a += 2) {
        const double steps = extent[a + 1] - extent[a];
        count *= in_cells ? std::max(1.0, steps) : steps + 1;
    }
    return count;
}

/// The numbers before the data of a binary array: its bytes, or if it is packed, how many blocks it
/// has, the bytes of a block, and those of the last one, if it is shorter.
class ArrayHead {
  public:
    explicit ArrayHead(const std::string& file_tag)
        : width_(attribute(file_tag, "header_type") == "UInt64" ? 8 : 4),
          swapped_((attribute(file_tag, "byte_order") == "BigEndian") !=
                   (std::endian::native == std::endian::big)),
          is_packed_(!attribute(file_tag, "compressor").empty()) {}

    bool is_packed() const { return is_packed_; }
    std::size_t width() const { return width_; }
    std::size_t size() const { return is_packed_ ? 3 * width_ : width_; }
    /// Bytes of the array, unpacked. `start`: its head.
    double bytes(std::span<const std::byte> start) const {
        if (!is_packed_) return number(start, 0);
        const double blocks = number(start, 0), each = number(start, 1), last = number(start, 2);
        return last > 0 ? (blocks - 1) * each + last : blocks * each;
    }

  private:
    double number(std::span<const std::byte> start, std::size_t i) const {
        const auto at = start.subspan(i * width_);
        return width_ == 8 ? static_cast<double>(number_in<std::uint64_t>(at, swapped_))
                           : number_in<std::uint32_t>(at, swapped_);
    }

    std::size_t width_;
    bool swapped_, is_packed_;
};

/// A binary array, by its tag.
struct VtiArray {
    std::string name;
    double bytes = any_number;  ///< that its samples take
    std::uint64_t offset = 0;   ///< of an array behind the others

    void check(const ArrayHead& head, std::span<const std::byte> start) const {
        if (bytes == any_number || start.size() < head.size()) return;  // VTK says it
        if (head.bytes(start) == bytes) return;
        throw Failure("its array '" + name.substr(0, 40) + "' has " + text_of(head.bytes(start)) +
                      " bytes, but its samples take " + text_of(bytes) +
                      "; correct the type of its DataArray, or the header_type of the file");
    }
};

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// As many bytes of a text in base64, blanks left out; fewer if it ends.
std::vector<std::byte> decoded(std::string_view text, std::size_t bytes) {
    static constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::byte> data;
    unsigned bits = 0, value = 0;
    for (const char c : text) {
        if (is_blank(c)) continue;
        const std::size_t digit = digits.find(c);
        if (digit == digits.npos || data.size() == bytes) break;
        value = value << 6 | static_cast<unsigned>(digit);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        data.push_back(static_cast<std::byte>(value >> bits));
    }
    return data;
}

/// Characters of so many bytes.
double encoded(double bytes) {
    return 4 * std::ceil(bytes / 3);
}

/// A head and data of an array that is not packed are encoded together or one behind the other: as
/// many characters. Otherwise its head has numbers of another width than header_type says, and VTK
/// takes a part of it for samples.
std::array<double, 2> lengths_of(const VtiArray& array, const ArrayHead& head) {
    const auto width = static_cast<double>(head.width());
    return {encoded(width + array.bytes), encoded(width) + encoded(array.bytes)};
}

[[noreturn]] void refuse_length(const VtiArray& array) {
    throw Failure("its array '" + array.name.substr(0, 40) +
                  "' does not end where its length says; correct the header_type of the file, or "
                  "export it again");
}

/// An array between its tags.
void check_inline(const VtiArray& array, const ArrayHead& head, const std::string& text) {
    array.check(head, decoded(text, head.size()));
    if (head.is_packed() || array.bytes == any_number) return;
    const auto count = static_cast<double>(text.size()) -
                       static_cast<double>(std::ranges::count_if(text, is_blank));
    if (std::ranges::count(lengths_of(array, head), count) == 0) refuse_length(array);
}

/// Raw arrays end where the last one does. Otherwise bytes were lost or added, by a transfer as
/// text for example, and VTK takes others for samples. `begin`: of the last array.
void check_raw_end(std::istream& in, const ArrayHead& head, std::uint64_t begin) {
    std::array<std::byte, 8> start{};
    in.seekg(static_cast<std::streamoff>(begin));
    in.read(reinterpret_cast<char*>(start.data()), static_cast<std::streamsize>(head.width()));
    const auto bytes = static_cast<std::uint64_t>(head.bytes(start));
    const auto back = std::min(bytes, std::uint64_t{64});
    in.seekg(static_cast<std::streamoff>(bytes - back), std::ios::cur);
    std::string text(static_cast<std::size_t>(back) + 256, ' ');
    in.read(text.data(), std::ssize(text));
    const std::string rest = text.substr(back);
    // Writers end the line before the tag. That end lies in the array where bytes were lost.
    const auto before = text.substr(0, back).find_last_not_of(" \t");
    const bool is_moved =
        rest[0] != '\n' && rest[0] != '\r' && before != std::string::npos && text[before] == '\n';
    if (!is_moved && trimmed(rest).starts_with("</AppendedData")) return;
    throw Failure(
        "its arrays do not end where its raw data do: bytes were lost or added, perhaps by a "
        "transfer as text; copy or export it again");
}

/// Arrays behind the tag AppendedData, which `in` has just left.
void check_appended(std::istream& in, std::vector<VtiArray> arrays, const ArrayHead& head,
                    bool is_raw) {
    in.ignore(std::numeric_limits<std::streamsize>::max(), '_');
    if (!in || arrays.empty()) return;
    const auto first = static_cast<std::uint64_t>(in.tellg());
    std::ranges::sort(arrays, {}, &VtiArray::offset);
    for (const VtiArray& array : arrays) {
        std::string text(64, '\0');  // more than a head in base64 has
        in.seekg(static_cast<std::streamoff>(first + array.offset));
        in.read(text.data(), std::ssize(text));
        text.resize(static_cast<std::size_t>(in.gcount()));
        in.clear();
        array.check(head, is_raw ? std::as_bytes(std::span(text)) : decoded(text, head.size()));
        if (is_raw || head.is_packed() || array.bytes == any_number) continue;
        const auto ends = [&](double length) {
            const std::uint64_t end = array.offset + static_cast<std::uint64_t>(length);
            const auto begins_there = [&](const VtiArray& other) { return other.offset == end; };
            in.seekg(static_cast<std::streamoff>(first + end));
            const int c = in.get();
            in.clear();
            return c == '<' || is_blank(static_cast<char>(c)) ||
                   std::ranges::any_of(arrays, begins_there);
        };
        if (std::ranges::none_of(lengths_of(array, head), ends)) refuse_length(array);
    }
    if (is_raw && !head.is_packed()) check_raw_end(in, head, first + arrays.back().offset);
}

/// The tags of a file, one after the other, and the arrays between them.
class ArrayTags {
  public:
    /// The tag AppendedData, or none.
    std::string check(std::istream& in) {
        std::string text, tag;
        while (!tag.starts_with("AppendedData") && std::getline(in, text, '<')) {
            if (tag.starts_with("DataArray") && !tag.ends_with('/')) check_text(tag, text);
            if (!std::getline(in, tag, '>')) return "";
            take(tag);
        }
        return tag;
    }
    const std::vector<VtiArray>& appended() const { return appended_; }
    const ArrayHead& head() const { return head_; }

  private:
    void take(const std::string& tag) {
        if (tag.starts_with("VTKFile")) head_ = ArrayHead(tag);
        if (tag.starts_with("Piece")) extent_ = vti_numbers(tag, "Extent", 6);
        const bool at_points = tag.starts_with("PointData"), in_cells = tag.starts_with("CellData");
        if (at_points || in_cells) {
            samples_ = extent_.empty() ? any_number : samples_of(extent_, in_cells);
            is_of_samples_ = true;
        }
        if (tag.starts_with("/PointData") || tag.starts_with("/CellData")) {
            samples_ = any_number;
            is_of_samples_ = false;
        }
        if (!tag.starts_with("DataArray")) return;
        if (is_of_samples_ && attribute(tag, "Name").empty()) {
            throw Failure(
                "has an array without a name, which VTK does not read; give its DataArray a Name");
        }
        if (const auto offset = number_from<std::uint64_t>(attribute(tag, "offset"))) {
            appended_.push_back(array_of(tag));
            appended_.back().offset = *offset;
        }
    }

    VtiArray array_of(const std::string& tag) const {
        const auto type = stored_named(lower(attribute(tag, "type")));
        if (!type) return {attribute(tag, "Name")};
        return {attribute(tag, "Name"),
                numbers_in_array(tag) * static_cast<double>(size_of(*type))};
    }

    double numbers_in_array(const std::string& tag) const {
        const auto components = vti_numbers(tag, "NumberOfComponents", 1);
        return samples_ * (components.empty() ? 1 : components[0]);
    }

    void check_text(const std::string& tag, const std::string& text) const {
        if (attribute(tag, "format") == "binary") {
            check_inline(array_of(tag), head_, text);
        } else if (attribute(tag, "offset").empty()) {
            const auto type = stored_named(lower(attribute(tag, "type")));
            check_numbers(text, type.value_or(Stored::float64), numbers_in_array(tag));
        }
    }

    ArrayHead head_{""};
    std::vector<VtiArray> appended_;
    std::vector<double> extent_;
    double samples_ = any_number;  ///< that an array has
    bool is_of_samples_ = false;
};

}  // namespace

std::vector<double> vti_numbers(const std::string& tag, const std::string& name,
                                std::size_t count) {
    const auto numbers = numbers_in(attribute(tag, name), name);
    if (numbers.empty() || numbers.size() == count) return numbers;
    throw Failure("its " + name + " has " + std::to_string(numbers.size()) + " numbers where " +
                  std::to_string(count) + " belong; correct it");
}

void check_vti_arrays(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    ArrayTags tags;
    const std::string tag = tags.check(in);
    if (!tag.starts_with("AppendedData")) return;
    check_appended(in, tags.appended(), tags.head(), attribute(tag, "encoding") == "raw");
}

}  // namespace palpate::io

// Reads PLY. Format: Greg Turk, "The PLY Polygon File Format". VTK's reader loses triangles where
// elements come before the vertices or faces have further lists, and crashes on some files.
#include "io/helper/ply_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "io/byte_order.hpp"
#include "io/helper/decode.hpp"
#include "io/stored.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

struct Property {
    std::string name;
    Stored type = Stored::float32;
    std::optional<Stored> count;  ///< of a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

enum class Encoding { text, little, big };

struct PlyHeader {
    Encoding encoding = Encoding::text;
    std::vector<Element> elements;
};

[[noreturn]] void fail(const std::string& what) {
    throw Failure("is damaged or not what its name says (" + what + "); export it again");
}

Stored type_named(const std::string& name) {
    static const std::map<std::string, Stored> types = {
        {"char", Stored::int8},      {"int8", Stored::int8},       {"uchar", Stored::uint8},
        {"uint8", Stored::uint8},    {"short", Stored::int16},     {"int16", Stored::int16},
        {"ushort", Stored::uint16},  {"uint16", Stored::uint16},   {"int", Stored::int32},
        {"int32", Stored::int32},    {"uint", Stored::uint32},     {"uint32", Stored::uint32},
        {"float", Stored::float32},  {"float32", Stored::float32}, {"double", Stored::float64},
        {"float64", Stored::float64}};
    const auto found = types.find(name);
    if (found == types.end()) fail("a property of the type '" + name.substr(0, 40) + "'");
    return found->second;
}

/// Leaves `in` behind the header's last line. All lines end as the first one does.
PlyHeader header_in(std::istream& in) {
    PlyHeader header;
    std::string line;
    char end = 0;
    while (line.size() < 100 && in.get(end) && end != '\n' && end != '\r') line += end;
    if (end == '\r' && in.peek() == '\n') in.get(end);
    if (trimmed(line) != "ply") fail("it does not begin with ply");
    for (int lines = 0; std::getline(in, line, end); ++lines) {
        if (lines > 10000 || line.size() > 100000) fail("its header has no end");
        std::istringstream words(line);
        std::string word, type, name, count;
        words >> word;
        if (word == "end_header") return header;
        if (word == "format") {
            words >> type;
            header.encoding =
                type == "ascii"                  ? Encoding::text
                : type == "binary_little_endian" ? Encoding::little
                : type == "binary_big_endian"
                    ? Encoding::big
                    : (fail("the format '" + type.substr(0, 40) + "'"), Encoding::text);
        } else if (word == "element") {
            words >> name >> count;
            const auto number = number_from<std::uint64_t>(count);
            if (!number) fail("an element without a count");
            header.elements.push_back({name, *number, {}});
        } else if (word == "property") {
            Property property;
            words >> type;
            if (type == "list") {
                words >> count >> type;
                property.count = type_named(count);
            }
            property.type = type_named(type);
            words >> property.name;
            if (header.elements.empty()) fail("a property of no element");
            header.elements.back().properties.push_back(property);
        }
    }
    fail("its header has no end");
}

/// The numbers after the header, one after the other.
class Numbers {
  public:
    Numbers(std::istream& in, Encoding encoding)
        : encoding_(encoding), bytes_(std::istreambuf_iterator<char>(in), {}) {}

    std::size_t left() const { return bytes_.size() - at_; }

    double next(Stored type) { return encoding_ == Encoding::text ? word() : binary(type); }

  private:
    double word() {
        constexpr const char* blank = " \t\r\n";
        at_ = std::min(bytes_.find_first_not_of(blank, at_), bytes_.size());
        const std::size_t end = std::min(bytes_.find_first_of(blank, at_), bytes_.size());
        const std::string text = bytes_.substr(at_, end - at_);
        if (text.empty()) fail("it is cut off");
        at_ = end;
        const auto number = number_from<double>(text);
        if (!number) fail("'" + text.substr(0, 40) + "' is not a number");
        return *number;
    }

    double binary(Stored type) {
        if (left() < size_of(type)) fail("it is cut off");
        const auto raw = std::as_bytes(std::span(bytes_)).subspan(at_);
        at_ += size_of(type);
        const bool swapped =
            (encoding_ == Encoding::big) != (std::endian::native == std::endian::big);
        return with_stored(type, [&](auto zero) {
            return static_cast<double>(number_in<decltype(zero)>(raw, swapped));
        });
    }

    Encoding encoding_;
    std::string bytes_;
    std::size_t at_ = 0;
};

std::size_t count_from(double number, const Numbers& numbers) {
    if (!(number >= 0 && number <= static_cast<double>(numbers.left())) ||
        number != std::floor(number)) {
        fail("a list of " + text_of(number) + " entries");
    }
    return static_cast<std::size_t>(number);
}

/// A strip's triangles; -1 begins a new strip.
void add_strip(const std::vector<std::int64_t>& strip, PolygonMesh& mesh) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
        if (strip[i] < 0) {
            begin = i + 1;
        } else if (i >= begin + 2) {
            const bool turned = (i - begin) % 2 == 1;
            mesh.faces.push_back(
                {strip[i - 2], strip[turned ? i : i - 1], strip[turned ? i - 1 : i]});
        }
    }
}

/// One vertex, face or other element.
void read_element(const Element& element, Numbers& numbers, PolygonMesh& mesh) {
    std::array<double, 3> vertex{NAN, NAN, NAN};
    for (const Property& property : element.properties) {
        if (!property.count) {
            const double value = numbers.next(property.type);
            if (property.name == "x") vertex[0] = value;
            if (property.name == "y") vertex[1] = value;
            if (property.name == "z") vertex[2] = value;
            continue;
        }
        std::vector<std::int64_t> list(count_from(numbers.next(*property.count), numbers));
        for (std::int64_t& entry : list) {
            const double value = numbers.next(property.type);
            entry = std::abs(value) < 1e15 ? static_cast<std::int64_t>(value) : -1;
        }
        if (property.name != "vertex_indices" && property.name != "vertex_index") continue;
        if (element.name == "tristrips") add_strip(list, mesh);
        if (element.name == "face") mesh.faces.push_back(std::move(list));
    }
    if (element.name == "vertex") mesh.vertices.push_back(vertex);
}

}  // namespace

PolygonMesh ply_mesh(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    const PlyHeader header = header_in(in);
    Numbers numbers(in, header.encoding);
    PolygonMesh mesh;
    for (const Element& element : header.elements) {
        if (element.properties.empty()) continue;
        for (std::uint64_t i = 0; i < element.count; ++i) read_element(element, numbers, mesh);
    }
    return mesh;
}

}  // namespace palpate::io

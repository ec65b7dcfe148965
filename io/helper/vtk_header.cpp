// Reads headers of VTK's older format ("legacy", .vtk), which has images (structured points) beside
// meshes. Format: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html. Samples are
// text or big-endian. VTK's own reader takes files that are cut off without a word.
#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <sstream>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t longest_vtk_header = 1 << 20;  // with fields before the samples

/// The words of a header, in lower case: VTK does not look at their case.
class VtkWords {
  public:
    explicit VtkWords(const std::filesystem::path& file) {
        const auto start = start_of(file, longest_vtk_header);
        in_.str(std::string(reinterpret_cast<const char*>(start.data()), start.size()));
    }
    std::string word() {
        std::string word;
        if (!(in_ >> word)) throw Failure("it ends within its header; copy or download it again");
        return lower(word);
    }
    /// What is left of the line.
    std::string rest() {
        std::string line;
        std::getline(in_, line);
        return lower(trimmed(line));
    }
    /// Passes over the samples of an array that is not used.
    void skip(std::int64_t count, Stored stored, bool is_text) {
        if (!is_text) in_.ignore(count * static_cast<std::int64_t>(size_of(stored)));
        for (std::int64_t i = 0; is_text && i < count; ++i) (void)word();
    }
    /// Of the next byte.
    std::uint64_t offset() {
        if (!in_) throw Failure("it ends within its header; copy or download it again");
        return static_cast<std::uint64_t>(in_.tellg());
    }

  private:
    std::istringstream in_;
};

Stored stored_as_vtk(const std::string& type) {
    static const std::map<std::string, Stored> types = {
        {"unsigned_char", Stored::uint8}, {"char", Stored::int8},
        {"signed_char", Stored::int8},    {"unsigned_short", Stored::uint16},
        {"short", Stored::int16},         {"unsigned_int", Stored::uint32},
        {"int", Stored::int32},           {"unsigned_long", Stored::uint64},
        {"long", Stored::int64},          {"vtktypeuint64", Stored::uint64},
        {"vtktypeint64", Stored::int64},  {"float", Stored::float32},
        {"double", Stored::float64}};
    const auto found = types.find(type);
    if (found != types.end()) return found->second;
    throw Failure("its sample type '" + type + "' cannot be read; save it as short or float");
}

using VtkFields = std::map<std::string, std::string>;

/// An array of a FIELD: a name, numbers for each sample, samples, and their type.
struct VtkArray {
    std::string components;
    std::int64_t samples = 0;
    Stored stored = Stored::uint8;
};

/// VTK describes the array before it in lines that end with an empty one.
void skip_metadata(VtkWords& words) {
    (void)words.rest();
    while (!words.rest().empty()) continue;
}

VtkArray array_of_field(VtkWords& words) {
    if (words.word() == "metadata") {  // or a name
        skip_metadata(words);
        (void)words.word();
    }
    const std::string components = words.word();
    const std::int64_t samples = whole_number_in(words.word(), "FIELD", 0);
    VtkArray array{components, samples, stored_as_vtk(words.word())};
    (void)words.rest();
    return array;
}

/// The file may have numbers of its own before those of the grid (a time, a cycle).
void skip_field(VtkWords& words, bool is_text) {
    (void)words.word();  // a name
    const std::int64_t arrays = whole_number_in(words.rest(), "FIELD", 0);
    for (std::int64_t i = 0; i < arrays; ++i) {
        const VtkArray array = array_of_field(words);
        const std::int64_t each = whole_number_in(array.components, "FIELD", 0);
        if (each > 0 && array.samples > std::int64_t{longest_vtk_header} / each) {
            throw Failure("it has a FIELD before its samples that is too long; save it as .vti");
        }
        words.skip(each * array.samples, array.stored, is_text);
    }
}

/// The fields of the grid; stops behind the word that says whether the samples belong to points or
/// to cells, which is `kind`.
VtkFields vtk_fields(VtkWords& words, bool is_text, std::string& kind) {
    VtkFields fields;
    for (kind = words.word(); kind != "point_data" && kind != "cell_data"; kind = words.word()) {
        if (kind == "field" || kind == "metadata") {
            kind == "field" ? skip_field(words, is_text) : skip_metadata(words);
            continue;
        }
        const std::string name = kind == "aspect_ratio" ? "spacing" : kind;
        if (name != "dimensions" && name != "spacing" && name != "origin") {
            throw Failure("it has '" + name.substr(0, 40) +
                          "' before its samples, which is not read; save it as .vti");
        }
        fields[name] = words.rest();
    }
    return fields;
}

Vec3 three_of(const VtkFields& fields, const std::string& name, double otherwise) {
    const auto found = fields.find(name);
    if (found == fields.end()) return Vec3::Constant(otherwise);
    const auto numbers = numbers_in(found->second, name);
    if (numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
    throw Failure("its header field '" + name + "' has not three numbers; correct the header");
}

/// Cells lie between the points that the dimensions count, with their samples in the middle.
void take_vtk_grid(const VtkFields& fields, bool in_cells, VolumeHeader& header) {
    const auto found = fields.find("dimensions");
    header.sizes = sizes_in(found == fields.end() ? "" : found->second, "dimensions");
    if (header.sizes.size() != 3) {
        throw Failure("its header field 'dimensions' has not three numbers; correct the header");
    }
    Geometry& g = header.geometry;
    g.oriented = false;
    g.measured = fields.contains("spacing");
    if (!g.measured) header.notes.emplace_back("its header gives no spacing: 1 mm was taken");
    g.spacing = three_of(fields, "spacing", 1);
    g.origin = three_of(fields, "origin", 0);
    if (in_cells) {
        header.notes.emplace_back(
            "its samples belong to cells: they were put at the cells' centres");
    }
    for (int a = 0; a < 3; ++a) {
        std::int64_t& size = header.sizes[static_cast<std::size_t>(a)];
        if (size == 1 && g.spacing[a] == 0) g.spacing[a] = 1;
        check_spacing(g.spacing[a], "header field 'spacing'");
        if (in_cells && size > 1) {
            --size;
            g.origin[a] += 0.5 * g.spacing[a];
        }
        check_coordinate(g.origin[a], "header field 'origin'");
        g.size[a] = static_cast<int>(std::min<std::int64_t>(size, std::numeric_limits<int>::max()));
    }
}

void check_vtk_count(std::int64_t told, const VolumeHeader& header) {
    double grid = 1;
    for (const std::int64_t size : header.sizes) grid *= static_cast<double>(size);
    if (static_cast<double>(told) == grid) return;
    throw Failure("it has " + std::to_string(told) + " samples, its grid is " +
                  text_of(header.sizes) + "; correct its header");
}

/// The first array: SCALARS with their table of colours, COLOR_SCALARS, which is how VTK writes
/// bytes, or the first one of a FIELD.
void take_vtk_array(VtkWords& words, VolumeHeader& header) {
    const std::string kind = words.word();
    std::string components = "1";
    if (kind == "scalars") {
        (void)words.word();  // a name
        std::istringstream rest(words.rest());
        std::string type;
        rest >> type >> components;
        if (words.word() != "lookup_table") {
            throw Failure("its SCALARS have no LOOKUP_TABLE; it is damaged: export it again");
        }
        (void)words.rest();
        header.stored = stored_as_vtk(type);
    } else if (kind == "color_scalars") {
        (void)words.word();
        components = words.rest();
        header.stored = Stored::uint8;
        if (header.places.front().encoding == DataPlace::Encoding::text) {
            throw Failure(
                "its bytes are written as fractions in text (COLOR_SCALARS); save it as binary");
        }
    } else if (kind == "field") {
        (void)words.rest();
        const VtkArray array = array_of_field(words);
        components = array.components;
        header.stored = array.stored;
        check_vtk_count(array.samples, header);
    } else {
        throw Failure("its first array is '" + kind.substr(0, 40) +
                      "' and no SCALARS (vectors, colours); save one value per sample");
    }
    if (components != "1") {
        throw Failure("it has " + components.substr(0, 20) +
                      " values a sample (colours or vectors); give a volume with one");
    }
}

}  // namespace

VolumeHeader vtk_header(const Request& request) {
    VtkWords words(request.path);
    if (!words.rest().starts_with("# vtk datafile")) {
        throw Failure("is no file of VTK (it does not begin with # vtk DataFile); check its name");
    }
    (void)words.rest();  // a title
    VolumeHeader header;
    header.format = "VTK";
    DataPlace& place = header.places.front();
    place.file = request.path;
    const std::string encoding = words.word();
    if (encoding == "ascii") place.encoding = DataPlace::Encoding::text;
    if (encoding != "ascii" && encoding != "binary") {
        throw Failure("its third line is neither ASCII nor BINARY; correct its header");
    }
    if (words.word() != "dataset" || words.word() != "structured_points") {
        throw Failure(
            "has a mesh or another grid than an image (STRUCTURED_POINTS); resample it to an "
            "image, and save that as .vti");
    }
    std::string kind;
    const VtkFields fields = vtk_fields(words, encoding == "ascii", kind);
    const auto told = whole_number_in(words.rest(), kind, 0);
    take_vtk_grid(fields, kind == "cell_data", header);
    check_vtk_count(told, header);
    take_vtk_array(words, header);
    place.offset = words.offset();
    place.swapped = std::endian::native == std::endian::little;
    place.has_footer = true;
    checked_bytes(header.sizes, size_of(header.stored), std::filesystem::file_size(request.path),
                  request);
    header.together = static_cast<std::int64_t>(header.samples());
    return header;
}

}  // namespace palpate::io

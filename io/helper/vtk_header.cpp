// Reads headers of VTK's older format ("legacy", .vtk), which has images (structured points) beside
// meshes. Format: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html. Samples are
// text or big-endian. VTK's own reader takes files that are cut off without a word.
#include <algorithm>
#include <bit>
#include <fstream>
#include <iomanip>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t longest_vtk_header = 1 << 20;  // of fields before the samples
constexpr int longest_vtk_word = 1 << 16;

/// The words of a file, in lower case: VTK does not look at their case.
class VtkWords {
  public:
    explicit VtkWords(const std::filesystem::path& file) : in_(file, std::ios::binary) {}

    /// False at the end.
    bool next(std::string& word) {
        word.clear();
        in_ >> std::setw(longest_vtk_word) >> word;
        word = lower(word);
        return !word.empty();
    }
    std::string word() {
        std::string word;
        if (!next(word)) throw Failure("it ends within its header; copy or download it again");
        return word;
    }
    /// What is left of the line.
    std::string rest() {
        std::string line;
        for (char c = 0; line.size() < longest_vtk_word && in_.get(c) && c != '\n';) line += c;
        return lower(trimmed(line));
    }
    /// Passes over the samples of an array that is not used.
    void skip(std::int64_t count, Stored stored, bool is_text) {
        const auto bytes = static_cast<std::streamoff>(size_of(stored));
        if (!is_text) in_.seekg(count * bytes, std::ios::cur);
        for (std::int64_t i = 0; is_text && i < count; ++i) (void)word();
    }
    /// Of the next byte.
    std::uint64_t offset() {
        if (!in_) throw Failure("it ends within its header; copy or download it again");
        return static_cast<std::uint64_t>(in_.tellg());
    }

  private:
    std::ifstream in_;
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
    while (!words.rest().empty()) {
    }
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

/// Numbers of points.
std::vector<std::int64_t> vtk_dimensions(const VtkFields& fields) {
    const auto found = fields.find("dimensions");
    auto sizes = sizes_in(found == fields.end() ? "" : found->second, "dimensions");
    if (sizes.size() == 3) return sizes;
    throw Failure("its header field 'dimensions' has not three numbers; correct the header");
}

/// Cells lie between the points that the dimensions count, with their samples in the middle.
void take_vtk_grid(const VtkFields& fields, bool in_cells, VolumeHeader& header) {
    header.sizes = vtk_dimensions(fields);
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

/// An array with numbers for each point or each cell.
struct VtkSamples {
    std::string kind;  ///< the word that it begins with
    std::int64_t components = 1, count = 0;
    Stored stored = Stored::uint8;
    bool in_cells = false;
    std::uint64_t offset = 0;  ///< of its first byte

    /// Whether it has one number for each point, or each cell, of a grid with so many points.
    bool fits(const std::vector<std::int64_t>& points) const {
        double grid = 1;
        for (const std::int64_t size : points) {
            grid *= static_cast<double>(in_cells && size > 1 ? size - 1 : size);
        }
        return components == 1 && static_cast<double>(count) == grid;
    }
};

/// Where a file is among its arrays.
struct VtkSection {
    bool in_cells = false;
    std::int64_t count = 0;   ///< points or cells, as it says
    std::int64_t fields = 0;  ///< arrays that are left of a FIELD
};

std::int64_t components_in(const std::string& text) {
    const std::int64_t components = text.empty() ? 1 : whole_number_in(text, "components", 1);
    if (components <= 1000) return components;
    throw Failure("it has " + text.substr(0, 20) + " values a sample; give a volume with one");
}

/// An array that is not of a FIELD, by its first word: SCALARS with their table of colours,
/// COLOR_SCALARS, which is how VTK writes bytes, or one with several numbers for each sample.
VtkSamples samples_named(const std::string& kind, VtkWords& words, bool is_text) {
    static const std::map<std::string, std::int64_t> several = {
        {"vectors", 3}, {"normals", 3}, {"tensors", 9}, {"texture_coordinates", 0}};
    VtkSamples samples;
    samples.kind = kind;
    const auto found = several.find(kind);
    if (kind == "scalars") {
        (void)words.word();  // a name
        std::istringstream rest(words.rest());
        std::string type, components;
        rest >> type >> components;
        if (words.word() != "lookup_table") {
            throw Failure("its SCALARS have no LOOKUP_TABLE; it is damaged: export it again");
        }
        (void)words.rest();
        samples.components = components_in(components);
        samples.stored = stored_as_vtk(type);
    } else if (kind == "color_scalars") {
        (void)words.word();
        samples.components = components_in(words.rest());
        if (is_text) {
            throw Failure(
                "its bytes are written as fractions in text (COLOR_SCALARS); save it as binary");
        }
    } else if (found != several.end()) {
        (void)words.word();
        samples.components = found->second > 0 ? found->second : components_in(words.word());
        samples.stored = stored_as_vtk(words.rest());
    } else {
        throw Failure("it has an array '" + kind.substr(0, 40) +
                      "', which is not read; save it as .vti");
    }
    return samples;
}

/// The next array; the words end before its first byte. Nothing at the end.
std::optional<VtkSamples> next_samples(VtkWords& words, VtkSection& section, bool is_text) {
    VtkSamples samples;
    for (std::string kind; section.fields == 0;) {
        if (!words.next(kind)) return std::nullopt;
        if (kind == "point_data" || kind == "cell_data") {
            section = {kind == "cell_data", whole_number_in(words.rest(), kind, 0)};
        } else if (kind == "metadata") {
            skip_metadata(words);
        } else if (kind == "field") {
            (void)words.word();
            section.fields = whole_number_in(words.rest(), kind, 0);
        } else if (kind == "lookup_table") {
            (void)words.word();
            words.skip(4 * whole_number_in(words.rest(), kind, 0), Stored::uint8, is_text);
        } else {
            samples = samples_named(kind, words, is_text);
            samples.count = section.count;
            break;
        }
    }
    if (samples.kind.empty()) {
        --section.fields;
        const VtkArray array = array_of_field(words);
        samples = {"field", components_in(array.components), array.samples, array.stored};
    }
    samples.in_cells = section.in_cells;
    samples.offset = words.offset();
    return samples;
}

/// The first array of points with one value for each, or else of cells, which ParaView writes
/// before those of points. An array of another length than the grid's (a time) is passed over.
/// `section`: the first one. `points`: the numbers of points along the axes.
VtkSamples chosen_samples(VtkWords& words, VtkSection section, bool is_text,
                          const std::vector<std::int64_t>& points,
                          std::vector<std::string>& notes) {
    std::optional<VtkSamples> first, of_cells;
    std::string unread;
    try {
        while (const auto samples = next_samples(words, section, is_text)) {
            const bool is_new = !first;
            if (is_new) first = samples;
            if (samples->fits(points) && !samples->in_cells) {
                if (!is_new) {
                    notes.emplace_back(
                        "it has several arrays: the first one of points with one value per sample "
                        "was taken");
                }
                return *samples;
            }
            if (samples->fits(points) && !of_cells) of_cells = samples;
            words.skip(samples->count * samples->components, samples->stored, is_text);
        }
    } catch (const Failure& e) {  // of what is behind an array
        if (!first) throw;
        unread = e.what();
    }
    if (of_cells) {
        if (!unread.empty()) {
            notes.push_back("only samples of its cells were found, as what follows them " +
                            ("cannot be read (" + unread + ")"));
        }
        return *of_cells;
    }
    if (!first) throw Failure("it has no samples; export it again");
    if (first->components == 1) return *first;  // its count is refused
    throw Failure("it has " + std::to_string(first->components) +
                  " values a sample (colours or vectors); give a volume with one");
}

}  // namespace

VolumeHeader vtk_header(const Request& request) {
    if (is_gzip(request.path)) throw Failure("is packed; unpack it and give what is in it");
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
    const bool is_text = encoding == "ascii";
    std::string kind;
    const VtkFields fields = vtk_fields(words, is_text, kind);
    const VtkSection section{kind == "cell_data", whole_number_in(words.rest(), kind, 0)};
    const VtkSamples samples =
        chosen_samples(words, section, is_text, vtk_dimensions(fields), header.notes);
    take_vtk_grid(fields, samples.in_cells, header);
    check_vtk_count(samples.count, header);
    header.stored = samples.stored;
    place.offset = samples.offset;
    place.swapped = std::endian::native == std::endian::little;
    place.footer = DataPlace::Footer::words;
    checked_bytes(header.sizes, size_of(header.stored), std::filesystem::file_size(request.path),
                  request);
    header.together = static_cast<std::int64_t>(header.samples());
    return header;
}

}  // namespace palpate::io

// Reads NRRD headers. Format: https://teem.sourceforge.net/nrrd/format.html, "NRRD0001" to
// "NRRD0005". Where the format leaves a choice, ITK's is taken (docs/io.md).
#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::uint64_t longest_header = 1 << 20;

HeaderFields read_fields(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string line;
    std::getline(in, line);
    if (line.rfind("NRRD000", 0) != 0 || line.size() > 20) {
        throw Failure("is not a NRRD file (it does not begin with NRRD000); check its name");
    }
    HeaderFields fields;
    while (std::getline(in, line)) {
        const std::string text = trimmed(line);
        if (text.empty()) break;
        if (in.tellg() > static_cast<std::streamoff>(longest_header)) {
            throw Failure("its header has no end; the file is damaged");
        }
        const auto colon = text.find(':');
        if (text[0] == '#' || colon == std::string::npos) continue;
        if (text.substr(colon, 2) == ":=") {
            fields.keys[text.substr(0, colon)] = text.substr(colon + 2);
            continue;
        }
        std::string name = lower(trimmed(text.substr(0, colon)));
        if (name == "datafile") name = "data file";
        if (name == "axismins") name = "axis mins";
        if (name == "lineskip") name = "line skip";
        if (name == "byteskip") name = "byte skip";
        fields.values[name] = trimmed(text.substr(colon + 1));
    }
    if (in) fields.data_offset = static_cast<std::uint64_t>(in.tellg());
    if (!in && !fields.has("data file")) {
        throw Failure("it ends within its header; copy or download it again");
    }
    return fields;
}

Stored stored_from(const std::string& type) {
    static const std::map<std::string, Stored> types = {{"signed char", Stored::int8},
                                                        {"int8", Stored::int8},
                                                        {"int8_t", Stored::int8},
                                                        {"uchar", Stored::uint8},
                                                        {"unsigned char", Stored::uint8},
                                                        {"uint8", Stored::uint8},
                                                        {"uint8_t", Stored::uint8},
                                                        {"short", Stored::int16},
                                                        {"short int", Stored::int16},
                                                        {"signed short", Stored::int16},
                                                        {"signed short int", Stored::int16},
                                                        {"int16", Stored::int16},
                                                        {"int16_t", Stored::int16},
                                                        {"ushort", Stored::uint16},
                                                        {"unsigned short", Stored::uint16},
                                                        {"unsigned short int", Stored::uint16},
                                                        {"uint16", Stored::uint16},
                                                        {"uint16_t", Stored::uint16},
                                                        {"int", Stored::int32},
                                                        {"signed int", Stored::int32},
                                                        {"int32", Stored::int32},
                                                        {"int32_t", Stored::int32},
                                                        {"uint", Stored::uint32},
                                                        {"unsigned int", Stored::uint32},
                                                        {"uint32", Stored::uint32},
                                                        {"uint32_t", Stored::uint32},
                                                        {"longlong", Stored::int64},
                                                        {"long long", Stored::int64},
                                                        {"long long int", Stored::int64},
                                                        {"signed long long", Stored::int64},
                                                        {"signed long long int", Stored::int64},
                                                        {"int64", Stored::int64},
                                                        {"int64_t", Stored::int64},
                                                        {"ulonglong", Stored::uint64},
                                                        {"unsigned long long", Stored::uint64},
                                                        {"unsigned long long int", Stored::uint64},
                                                        {"uint64", Stored::uint64},
                                                        {"uint64_t", Stored::uint64},
                                                        {"float", Stored::float32},
                                                        {"double", Stored::float64}};
    const auto found = types.find(lower(type));
    if (found == types.end()) {
        throw Failure("its sample type '" + type + "' cannot be read; save it as int16 or float");
    }
    return found->second;
}

DataPlace place_of(const HeaderFields& fields, const std::filesystem::path& path) {
    DataPlace place;
    place.file = path;
    place.offset = fields.data_offset;
    if (fields.has("data file")) {
        const std::string name = fields.value("data file");
        if (name.rfind("LIST", 0) == 0 || name.find('%') != std::string::npos) {
            throw Failure(
                "its samples are spread over several files, which is not read; save it as one "
                "(unu save -f nrrd)");
        }
        place.file = path.parent_path() / name;
        place.offset = 0;
    }
    const std::string encoding = lower(fields.needed("encoding"));
    if (encoding == "gzip" || encoding == "gz") {
        place.encoding = DataPlace::Encoding::compressed;
    } else if (encoding == "text" || encoding == "txt" || encoding == "ascii") {
        place.encoding = DataPlace::Encoding::text;
    } else if (encoding != "raw") {
        throw Failure("its encoding '" + encoding +
                      "' is not read; save it with gzip or raw (unu save -e gzip)");
    }
    return place;
}

/// "line skip" and "byte skip"; a byte skip of -1 means that the samples are the file's end.
void apply_skips(const HeaderFields& fields, std::uint64_t bytes, DataPlace& place) {
    const auto skip_of = [&](const std::string& name) {
        return fields.has(name) ? whole_number_in(fields.value(name), name, -1) : 0;
    };
    const std::int64_t lines = skip_of("line skip");
    const std::int64_t skip = skip_of("byte skip");
    if (lines > 0) {
        std::ifstream in(place.file, std::ios::binary);
        in.seekg(static_cast<std::streamoff>(place.offset));
        std::string line;
        for (std::int64_t i = 0; i < lines && std::getline(in, line); ++i) {
        }
        if (in) place.offset = static_cast<std::uint64_t>(in.tellg());
    }
    if (skip > 0) place.skip = static_cast<std::uint64_t>(skip);
    if (skip == -1 && place.encoding == DataPlace::Encoding::raw) {
        std::error_code error;
        const std::uint64_t size = std::filesystem::file_size(place.file, error);
        if (!error && size >= bytes) place.offset = size - bytes;
    }
}

/// Samples of more than one byte must say their order, but for text.
bool is_swapped(const HeaderFields& fields, Stored stored, const DataPlace& place) {
    if (size_of(stored) == 1 || place.encoding == DataPlace::Encoding::text) return false;
    const std::string endian = lower(fields.needed("endian"));
    if (endian != "little" && endian != "big") {
        throw Failure("its header field 'endian' is '" + endian +
                      "'; correct the header, it is little or big");
    }
    return (endian == "little") != (std::endian::native == std::endian::little);
}

/// Fields that have one entry for each axis; an entry that is missing or left open is nothing.
struct Axis {
    std::int64_t size = 1;
    std::string kind = "???";
    std::optional<double> spacing, minimum, maximum;
    bool samples_at_ends = false;  ///< its minimum and maximum are samples' places, not cells' ends
    std::optional<Vec3> direction;
    std::string unit;

    /// False for an axis of values (colours, vectors, lists), not of places or times.
    bool is_domain() const {
        return kind == "domain" || kind == "space" || kind == "time" || kind == "???" ||
               kind == "none";
    }
};

void check_count(std::size_t count, std::size_t axes, const std::string& field) {
    if (count == axes) return;
    throw Failure("its header field '" + field + "' has " + std::to_string(count) +
                  " entries for " + std::to_string(axes) + " axes; correct the header");
}

std::vector<std::string> words_of(const HeaderFields& fields, const std::string& field,
                                  std::size_t axes) {
    std::vector<std::string> words;
    std::istringstream text(lower(fields.value(field)));
    for (std::string word; text >> word;) words.push_back(word);
    if (fields.has(field)) check_count(words.size(), axes, field);
    words.resize(axes, "???");
    return words;
}

std::vector<std::optional<double>> numbers_of(const HeaderFields& fields, const std::string& field,
                                              std::size_t axes) {
    const auto numbers = numbers_in(fields.value(field), field);
    if (fields.has(field)) check_count(numbers.size(), axes, field);
    std::vector<std::optional<double>> found(axes);
    for (std::size_t a = 0; a < numbers.size(); ++a) {
        if (!std::isnan(numbers[a])) found[a] = numbers[a];
    }
    return found;
}

/// What stands in "..." one after the other.
std::vector<std::string> quoted_words(const std::string& text) {
    std::vector<std::string> words;
    std::size_t at = 0;
    while (true) {
        const auto open = text.find('"', at);
        const auto close = open == std::string::npos ? open : text.find('"', open + 1);
        if (close == std::string::npos) return words;
        words.push_back(lower(trimmed(text.substr(open + 1, close - open - 1))));
        at = close + 1;
    }
}

/// The space that directions and origin are given in.
struct Space {
    std::size_t dimension = 0;   ///< 0: the header gives none
    Vec3 to_lps = Vec3::Ones();  ///< factors to left, posterior, superior
};

Space space_of(const HeaderFields& fields) {
    static const std::map<std::string, Space> spaces = {
        {"right-anterior-superior", {3, {-1, -1, 1}}},
        {"ras", {3, {-1, -1, 1}}},
        {"left-anterior-superior", {3, {1, -1, 1}}},
        {"las", {3, {1, -1, 1}}},
        {"left-posterior-superior", {3, {1, 1, 1}}},
        {"lps", {3, {1, 1, 1}}},
        {"right-anterior-superior-time", {4, {-1, -1, 1}}},
        {"rast", {4, {-1, -1, 1}}},
        {"left-anterior-superior-time", {4, {1, -1, 1}}},
        {"last", {4, {1, -1, 1}}},
        {"left-posterior-superior-time", {4, {1, 1, 1}}},
        {"lpst", {4, {1, 1, 1}}},
        {"scanner-xyz", {3, {1, 1, 1}}},
        {"scanner-xyz-time", {4, {1, 1, 1}}},
        {"3d-right-handed", {3, {1, 1, 1}}},
        {"3d-left-handed", {3, {1, 1, 1}}},
        {"3d-right-handed-time", {4, {1, 1, 1}}},
        {"3d-left-handed-time", {4, {1, 1, 1}}}};
    if (fields.has("space")) {
        const auto found = spaces.find(lower(fields.value("space")));
        if (found != spaces.end()) return found->second;
        throw Failure("its header field 'space' is '" + fields.value("space") +
                      "', which is not known; correct the header");
    }
    Space space;
    if (fields.has("space dimension")) {
        space.dimension = static_cast<std::size_t>(
            whole_number_in(fields.value("space dimension"), "space dimension", 1));
    }
    return space;
}

/// "(1,0,0)" at `at` and behind it: the numbers in the next brackets.
std::vector<double> next_vector(const std::string& text, std::size_t& at,
                                const std::string& field) {
    const auto close = text.find(')', at);
    if (text[at] != '(' || close == std::string::npos) {
        throw Failure("its header field '" + field + "' is damaged; correct the header");
    }
    std::string inside = text.substr(at + 1, close - at - 1);
    std::replace(inside.begin(), inside.end(), ',', ' ');
    at = close + 1;
    return numbers_in(inside, field);
}

Vec3 vector_in(const std::vector<double>& numbers, const Space& space, const std::string& field) {
    if (numbers.size() != space.dimension) {
        throw Failure("its header field '" + field +
                      "' and its space do not agree; correct the "
                      "header");
    }
    Vec3 v = Vec3::Zero();
    for (std::size_t i = 0; i < std::min<std::size_t>(3, numbers.size()); ++i) {
        v[static_cast<Eigen::Index>(i)] = numbers[i];
    }
    return v.cwiseProduct(space.to_lps);
}

void read_directions(const HeaderFields& fields, const Space& space, std::vector<Axis>& axes) {
    const std::string field = "space directions", text = fields.value(field);
    std::size_t at = 0, count = 0;
    while ((at = text.find_first_not_of(" \t", at)) != std::string::npos) {
        Axis ignored;
        Axis& axis = count < axes.size() ? axes[count] : ignored;
        ++count;
        if (text.compare(at, 4, "none") == 0) {
            at += 4;
            continue;
        }
        const std::vector<double> numbers = next_vector(text, at, field);
        double square = 0;
        for (const double n : numbers) square += n * n;
        check_spacing(std::sqrt(square), "header field '" + field + "'");
        axis.direction = vector_in(numbers, space, field);
    }
    if (fields.has(field)) check_count(count, axes.size(), field);
}

std::vector<Axis> axes_of(const HeaderFields& fields, const std::vector<std::int64_t>& sizes,
                          const Space& space) {
    std::vector<Axis> axes(sizes.size());
    const auto kinds = words_of(fields, "kinds", sizes.size());
    const auto centers = words_of(fields, "centers", sizes.size());
    const auto spacings = numbers_of(fields, "spacings", sizes.size());
    const auto minima = numbers_of(fields, "axis mins", sizes.size());
    const auto maxima = numbers_of(fields, "axis maxs", sizes.size());
    const auto units = quoted_words(fields.value("units"));
    for (std::size_t a = 0; a < axes.size(); ++a) {
        axes[a] = {sizes[a],     kinds[a],
                   spacings[a],  minima[a],
                   maxima[a],    centers[a] == "node",
                   std::nullopt, a < units.size() ? units[a] : ""};
    }
    read_directions(fields, space, axes);
    return axes;
}

/// Finds the axis that counts volumes, if there is one, and returns the axes of space.
std::vector<Axis> spatial_axes(const std::vector<Axis>& axes, VolumeHeader& header) {
    std::vector<Axis> spatial;
    std::int64_t before = 1;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const Axis& axis = axes[a];
        if (axis.is_domain()) {
            if (axis.kind == "time" && a + 1 != axes.size()) {
                throw Failure(
                    "its time axis is not the last one; put it last (unu permute) or mark it as a "
                    "list");
            }
            spatial.push_back(axis);
        } else if (axis.size > 1) {
            if (axis.kind != "list" || axes.size() < 4) {
                throw Failure("it has " + std::to_string(axis.size) +
                              " values a sample (colours or vectors); give a volume with one");
            }
            if (header.steps > 1) {
                throw Failure("it has two axes of lists; save one volume of it");
            }
            header.steps = axis.size;
            header.together = before;
            header.times = frame_times(axis.spacing.value_or(0), axis.minimum.value_or(0),
                                       axis.unit, header.notes);
        }
        before *= axis.size;
    }
    return spatial;
}

/// Of 3D Slicer's segmentations: "Segment0_LabelValue:=1", "Segment0_Name:=liver",
/// "Segment0_Color:=0.5 0.2 0.1". Those that say no value, or nonsense, are passed over.
std::vector<LabelName> labels_of(const HeaderFields& fields) {
    constexpr int most = 4096;
    std::vector<LabelName> labels;
    for (int i = 0; i < most; ++i) {
        const auto text = [&](const char* what) {
            const auto found = fields.keys.find("Segment" + std::to_string(i) + "_" + what);
            return found == fields.keys.end() ? std::string() : found->second;
        };
        if (text("ID").empty() && text("LabelValue").empty()) break;
        LabelName label;
        std::istringstream value(text("LabelValue"));
        if (!(value >> label.value)) continue;
        label.name = text("Name");
        std::istringstream colour(text("Color"));
        std::array<double, 3> rgb{};
        if (colour >> rgb[0] >> rgb[1] >> rgb[2]) {
            for (std::size_t c = 0; c < 3; ++c) label.colour[c] = std::clamp(rgb[c], 0.0, 1.0);
        }
        labels.push_back(label);
    }
    return labels;
}

/// A space has as many dimensions as there are axes, or lacks time.
void check_dimensions(const Space& space, const std::vector<Axis>& spatial) {
    if (spatial.empty()) throw Failure("it has no axis of space; give a volume");
    const bool timeless = space.dimension == 3 && spatial.size() == 4 && !spatial[3].direction;
    if (space.dimension == 0 || space.dimension == spatial.size() || timeless) return;
    throw Failure("its header gives a space of " + std::to_string(space.dimension) +
                  " dimensions for " + std::to_string(spatial.size()) +
                  " axes; correct the header");
}

/// Axes beyond the third count volumes.
void take_steps(std::vector<Axis>& spatial, VolumeHeader& header) {
    if (spatial.size() <= 3) {
        if (header.steps == 1) header.together = static_cast<std::int64_t>(header.samples());
        return;
    }
    if (header.steps > 1) {
        throw Failure("it has more than 4 axes (" + text_of(header.sizes) +
                      "); save one volume of it");
    }
    for (std::size_t a = 3; a < spatial.size(); ++a) header.steps *= spatial[a].size;
    header.together = static_cast<std::int64_t>(header.samples()) / header.steps;
    if (spatial.size() == 4) {
        const Axis& time = spatial[3];
        header.times = frame_times(time.spacing.value_or(0), time.minimum.value_or(0), time.unit,
                                   header.notes);
    }
    spatial.resize(3);
}

/// The origin of a grid outside of any space: from the minima of its axes, if it has any. Not
/// finite, and so refused later, if it has some only.
Vec3 origin_of(const std::vector<Axis>& spatial) {
    Vec3 origin = Vec3::Zero();
    if (!spatial.front().minimum) return origin;
    for (std::size_t a = 0; a < spatial.size(); ++a) {
        const Axis& axis = spatial[a];
        if (!axis.spacing && !axis.maximum) return Vec3::Zero();
        const double minimum = axis.minimum.value_or(std::nan(""));
        const double cells = static_cast<double>(axis.samples_at_ends ? axis.size - 1 : axis.size);
        const double spacing = axis.spacing ? *axis.spacing : (*axis.maximum - minimum) / cells;
        origin[static_cast<Eigen::Index>(a)] = minimum + (axis.samples_at_ends ? 0 : spacing / 2);
    }
    return origin;
}

Geometry geometry_of(const HeaderFields& fields, const Space& space,
                     const std::vector<Axis>& spatial) {
    Geometry g;
    g.size = Index3::Ones();
    for (std::size_t a = 0; a < spatial.size(); ++a) {
        const Axis& axis = spatial[a];
        const auto i = static_cast<Eigen::Index>(a);
        g.size[i] = static_cast<int>(axis.size);
        if (axis.spacing && space.dimension > 0) {
            throw Failure(
                "its header gives both spacings and a space for the same axis; correct the header");
        }
        if (fields.has("spacings") && space.dimension == 0) {
            g.spacing[i] = axis.spacing.value_or(std::nan(""));
            check_spacing(g.spacing[i], "header field 'spacings'");
        }
        if (axis.direction) {
            g.spacing[i] = axis.direction->norm();
            g.direction.col(i) = *axis.direction / g.spacing[i];
        }
    }
    if (space.dimension == 0) {
        g.origin = origin_of(spatial);
    } else if (fields.has("space origin")) {
        std::size_t at = 0;
        const Vec3 origin = vector_in(next_vector(fields.value("space origin"), at, "space origin"),
                                      space, "space origin");
        if (!std::isnan(origin[0])) g.origin = origin;
    }
    return g;
}

void note_units(const HeaderFields& fields, VolumeHeader& header) {
    if (!fields.has("spacings") && !fields.has("space directions")) {
        header.notes.push_back("its header gives no spacing: 1 mm was taken");
    }
    const std::string units = lower(fields.value("space units"));
    if (!units.empty() && units.find("\"mm\"") == std::string::npos &&
        units.find("millimet") == std::string::npos) {
        header.notes.push_back("its lengths are in " + units + ", they were taken as mm");
    }
}

}  // namespace

VolumeHeader nrrd_header(const Request& request) {
    const HeaderFields fields = read_fields(request.path);
    VolumeHeader header;
    header.stored = stored_from(fields.needed("type"));
    header.sizes = sizes_in(fields.needed("sizes"), "sizes");
    const auto dimension = numbers_in(fields.needed("dimension"), "dimension");
    if (dimension.size() != 1 || dimension[0] != static_cast<double>(header.sizes.size()) ||
        header.sizes.empty()) {
        throw Failure("its header's dimension and sizes do not agree; correct the header");
    }
    header.place = place_of(fields, request.path);
    std::error_code error;
    const auto file_bytes = std::filesystem::file_size(header.place.file, error);
    const std::uint64_t bytes =
        checked_bytes(header.sizes, size_of(header.stored), error ? 0 : file_bytes, request);
    apply_skips(fields, bytes, header.place);
    header.place.swapped = is_swapped(fields, header.stored, header.place);
    const Space space = space_of(fields);
    note_units(fields, header);
    std::vector<Axis> spatial = spatial_axes(axes_of(fields, header.sizes, space), header);
    check_dimensions(space, spatial);
    take_steps(spatial, header);
    header.geometry = geometry_of(fields, space, spatial);
    header.values.labels = labels_of(fields);
    return header;
}

}  // namespace palpate::io

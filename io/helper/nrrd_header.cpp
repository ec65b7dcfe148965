// Reads NRRD headers. Format: https://teem.sourceforge.net/nrrd/format.html, "NRRD0001" to
// "NRRD0005". If the format leaves a choice, ITK's is taken (docs/io.md).
#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "io/helper/headers.hpp"
#include "io/helper/nrrd_axes.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr std::uint64_t longest_header = 1 << 20;

/// Fields have second names, most of them without the blank.
std::string field_named(const std::string& name) {
    static const std::map<std::string, std::string> names = {
        {"datafile", "data file"},      {"axismins", "axis mins"}, {"axismaxs", "axis maxs"},
        {"lineskip", "line skip"},      {"byteskip", "byte skip"}, {"centers", "centerings"},
        {"oldmin", "old min"},          {"oldmax", "old max"},     {"blocksize", "block size"},
        {"sampleunits", "sample units"}};
    const auto found = names.find(name);
    return found == names.end() ? name : found->second;
}

/// Fields that describe the samples but are not used.
void note_ignored(const HeaderFields& fields, std::vector<std::string>& notes) {
    static const std::set<std::string> known = {
        // of the file
        "content", "number", "type", "dimension", "sizes", "encoding", "endian", "data file",
        "block size", "line skip", "byte skip",
        // of samples
        "min", "max", "old min", "old max", "sample units",
        // of each axis
        "kinds", "centerings", "labels", "units", "spacings", "thicknesses", "axis mins",
        "axis maxs",
        // of the space
        "space", "space dimension", "space units", "space origin", "space directions",
        "measurement frame"};
    for (const auto& [name, value] : fields.values) {
        if (!known.contains(name)) {
            notes.push_back("its header field '" + name.substr(0, 40) +
                            "' is not known and was ignored");
        }
    }
    if (fields.has("old min") || fields.has("old max")) {
        notes.emplace_back(
            "its header's old min and old max say that its values were quantized: "
            "they were ignored, the samples are as they are stored");
    }
}

HeaderFields read_fields(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string line;
    std::getline(in, line);
    if (!line.starts_with("NRRD00") || line.size() > 20) {
        throw Failure("is not a NRRD file (it does not begin with NRRD00); check its name");
    }
    HeaderFields fields;
    // A line of blanks does not end it.
    while (std::getline(in, line) && !line.empty() && line != "\r") {
        const std::string text = trimmed(line);
        if (in.tellg() > static_cast<std::streamoff>(longest_header)) {
            throw Failure("its header has no end; the file is damaged");
        }
        const auto colon = text.find(':');
        if (text.starts_with('#') || colon == std::string::npos) continue;
        if (text.substr(colon, 2) == ":=") {
            fields.keys[text.substr(0, colon)] = text.substr(colon + 2);
            continue;
        }
        const std::string name = field_named(lower(trimmed(text.substr(0, colon))));
        const std::string value = trimmed(text.substr(colon + 1));
        fields.add(name, value, true);
        if (name == "data file" && is_list(value)) break;
    }
    if (in) fields.data_offset = static_cast<std::uint64_t>(in.tellg());
    if (!in && !fields.has("data file")) {
        throw Failure("it ends within its header; copy or download it again");
    }
    return fields;
}

Stored stored_from(const std::string& type) {
    static const std::map<Stored, std::set<std::string>> names = {
        {Stored::int8, {"signed char", "int8", "int8_t"}},
        {Stored::uint8, {"uchar", "unsigned char", "uint8", "uint8_t"}},
        {Stored::int16,
         {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
        {Stored::uint16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
        {Stored::int32, {"int", "signed int", "int32", "int32_t"}},
        {Stored::uint32, {"uint", "unsigned int", "uint32", "uint32_t"}},
        {Stored::int64,
         {"longlong", "long long", "long long int", "signed long long", "signed long long int",
          "int64", "int64_t"}},
        {Stored::uint64,
         {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}},
        {Stored::float32, {"float"}},
        {Stored::float64, {"double"}}};
    const auto found = std::ranges::find_if(
        names, [name = lower(type)](const auto& one) { return one.second.contains(name); });
    if (found == names.end()) {
        throw Failure("its sample type '" + type + "' cannot be read; save it as int16 or float");
    }
    return found->first;
}

std::vector<DataPlace> places_of(const HeaderFields& fields, const std::filesystem::path& path,
                                 std::vector<std::string>& notes) {
    DataPlace place;
    place.offset = fields.has("data file") ? 0 : fields.data_offset;
    const std::string encoding = lower(fields.needed("encoding"));
    if (encoding == "gzip" || encoding == "gz") {
        place.encoding = DataPlace::Encoding::compressed;
    } else if (encoding == "text" || encoding == "txt" || encoding == "ascii") {
        place.encoding = DataPlace::Encoding::text;
    } else if (encoding != "raw") {
        throw Failure("its encoding '" + encoding +
                      "' is not read; save it with gzip or raw (unu save -e gzip)");
    }
    if (!fields.has("data file")) return places_in({path}, place);
    return places_in(data_files(fields.value("data file"), fields, path, notes), place);
}

/// "line skip" and "byte skip"; a byte skip of -1 means that the samples are the file's end.
void apply_skips(const HeaderFields& fields, std::uint64_t bytes, DataPlace& place) {
    const auto skip_of = [&](const std::string& name, double least) {
        return fields.has(name) ? whole_number_in(fields.value(name), name, least) : 0;
    };
    const std::int64_t lines = skip_of("line skip", 0);
    const std::int64_t skip = skip_of("byte skip", -1);
    std::error_code error;
    // Reading says it of what is not there, or is no file: to open a pipe would wait for its
    // writer.
    if (lines > 0 && std::filesystem::is_regular_file(place.file, error)) {
        std::ifstream in(place.file, std::ios::binary);
        in.seekg(static_cast<std::streamoff>(place.offset));
        constexpr auto whole_line = std::numeric_limits<std::streamsize>::max();
        for (std::int64_t i = 0; i < lines && in.ignore(whole_line, '\n'); ++i) {
        }
        if (!in.good()) {
            throw Failure("its line skip of " + std::to_string(lines) +
                          " goes beyond its data; correct the header");
        }
        place.offset = static_cast<std::uint64_t>(in.tellg());
    }
    if (skip > 0) place.skip = static_cast<std::uint64_t>(skip);
    if (skip == -1 && place.encoding == DataPlace::Encoding::compressed) {
        place.is_at_end = true;
    } else if (skip == -1) {
        put_at_end(place, bytes, "byte skip");
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

/// Labels of 3D Slicer's segmentations: "Segment0_LabelValue:=1", "Segment0_Name:=liver",
/// "Segment0_Color:=0.5 0.2 0.1". Labels with nonsense for a value are ignored.
/// Overlapping segments are in several layers, which are the file's frames: "Segment0_Layer:=1".
/// Versions before 4.11 name neither: each segment has a layer of its own, with the value 1.
std::vector<LabelName> labels_of(const HeaderFields& fields, int frame) {
    constexpr int most = 4096;
    std::vector<LabelName> labels;
    for (int i = 0; i < most; ++i) {
        const auto text = [&](const char* what) {
            const auto found = fields.keys.find("Segment" + std::to_string(i) + "_" + what);
            return found == fields.keys.end() ? std::string() : found->second;
        };
        if (text("ID").empty() && text("LabelValue").empty()) break;
        const std::string told = text("LabelValue");
        const int layer = told.empty() ? i : frame;  // if it is not given
        if (number_from<int>(trimmed(text("Layer"))).value_or(layer) != frame) continue;
        LabelName label;
        std::istringstream value(told.empty() ? "1" : told);
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

}  // namespace

VolumeHeader nrrd_header(const Request& request) {
    const HeaderFields fields = read_fields(request.path);
    VolumeHeader header;
    header.format = "NRRD";
    header.stored = stored_from(fields.needed("type"));
    header.sizes = sizes_in(fields.needed("sizes"), "sizes");
    const auto dimension = numbers_in(fields.needed("dimension"), "dimension");
    if (dimension.size() != 1 || dimension[0] != static_cast<double>(header.sizes.size()) ||
        header.sizes.empty()) {
        throw Failure("its header's dimension and sizes do not agree; correct the header");
    }
    header.places = places_of(fields, request.path, header.notes);
    checked_bytes(header.sizes, size_of(header.stored), file_bytes(header), request);
    for (DataPlace& place : header.places) {
        apply_skips(fields, header.bytes_each(), place);
        place.swapped = is_swapped(fields, header.stored, place);
    }
    take_axes(fields, header);
    note_ignored(fields, header.notes);
    header.values.labels = labels_of(fields, request.time_step);
    return header;
}

}  // namespace palpate::io

// Reads MetaImage headers: lines "Key = Value" or "Key: Value" up to ElementDataFile.
#include <algorithm>
#include <bit>
#include <fstream>
#include <initializer_list>
#include <map>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t longest_header = 1 << 24;

bool is_true(const std::string& value) {
    const std::string v = lower(value);
    return !v.empty() && (v[0] == 't' || v[0] == '1' || v[0] == 'y');
}

HeaderFields read_fields(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    HeaderFields fields;
    std::string line;
    // Some programs write several fields for each frame of a recording.
    for (std::size_t bytes = 0; bytes < longest_header && std::getline(in, line);) {
        bytes += line.size() + 1;
        const auto equals = line.find_first_of("=:");
        if (equals == std::string::npos) {
            if (trimmed(line).empty()) continue;
            break;
        }
        const std::string name = lower(trimmed(line.substr(0, equals)));
        fields.add(name, trimmed(line.substr(equals + 1)), false);
        if (name == "elementdatafile") {
            if (in) fields.data_offset = static_cast<std::uint64_t>(in.tellg());
            return fields;
        }
    }
    throw Failure(
        "is not a MetaImage (its header has no line 'ElementDataFile = ...'); check its name or "
        "copy it again");
}

Stored stored_from(const std::string& type) {
    static const std::map<std::string, Stored> types = {
        {"MET_CHAR", Stored::int8},       {"MET_UCHAR", Stored::uint8},
        {"MET_SHORT", Stored::int16},     {"MET_USHORT", Stored::uint16},
        {"MET_INT", Stored::int32},       {"MET_UINT", Stored::uint32},
        {"MET_LONG", Stored::int32},      {"MET_ULONG", Stored::uint32},
        {"MET_LONG_LONG", Stored::int64}, {"MET_ULONG_LONG", Stored::uint64},
        {"MET_FLOAT", Stored::float32},   {"MET_DOUBLE", Stored::float64}};
    const auto found = types.find(type);
    if (found == types.end()) {
        throw Failure("its sample type '" + type +
                      "' cannot be read; save it as MET_SHORT or MET_FLOAT");
    }
    return found->second;
}

/// `slices`: the size of the last axis, which several files share.
std::vector<DataPlace> places_of(const HeaderFields& fields, const std::filesystem::path& path,
                                 std::int64_t slices, std::vector<std::string>& notes) {
    DataPlace place;
    const std::string name = fields.needed("elementdatafile");
    const bool is_local = lower(name) == "local";
    if (is_local) place.offset = fields.data_offset;
    if (fields.has("headersize")) {
        // -1: the samples are the end of the file; then any size that suffices is right.
        const auto skip = whole_number_in(fields.value("headersize"), "HeaderSize", -1);
        if (skip > 0 && static_cast<std::uint64_t>(skip) < place.offset) {
            throw Failure("its HeaderSize ends within the header; correct the header");
        }
        if (skip > 0) place.offset = static_cast<std::uint64_t>(skip);  // from the file's beginning
    }
    if (is_true(fields.value("compresseddata"))) {
        place.encoding = DataPlace::Encoding::compressed;
        if (fields.has("compresseddatasize")) {
            const auto size =
                whole_number_in(fields.value("compresseddatasize"), "CompressedDataSize", 0);
            if (size > 0) place.length = static_cast<std::uint64_t>(size);
        }
    } else if (!fields.value("binarydata").empty() && !is_true(fields.value("binarydata"))) {
        place.encoding = DataPlace::Encoding::text;
    }
    const std::string element = fields.value("elementbyteordermsb"),
                      data = fields.value("binarydatabyteordermsb");
    if (!element.empty() && !data.empty() && is_true(element) != is_true(data)) {
        throw Failure(
            "its ElementByteOrderMSB and BinaryDataByteOrderMSB say different things; correct the "
            "header");
    }
    const bool is_big = is_true(element) || is_true(data);
    place.swapped = is_big != (std::endian::native == std::endian::big);
    return places_in(is_local ? std::vector{path} : data_files(name, fields, path, notes, slices),
                     place);
}

/// The first of these fields that is there, with `count` numbers; empty if none is. A note says it
/// if another one of them says something else.
std::vector<double> first_of(VolumeHeader& header, const HeaderFields& fields,
                             std::initializer_list<const char*> names, std::size_t count) {
    std::vector<double> taken;
    std::string first;
    for (const char* name : names) {
        if (!fields.has(name)) continue;
        const auto numbers = numbers_in(fields.value(name), name);
        if (numbers.size() != count) {
            throw Failure("its header field '" + std::string(name) + "' has " +
                          std::to_string(numbers.size()) + " numbers where " +
                          std::to_string(count) + " belong; correct the header");
        }
        if (first.empty()) {
            taken = numbers;
            first = name;
        } else if (numbers != taken) {
            header.notes.push_back("its header fields '" + first + "' and '" + name +
                                   "' differ: the first one was taken");
        }
    }
    return taken;
}

void read_geometry(const HeaderFields& fields, VolumeHeader& header) {
    const std::size_t axes = header.sizes.size();
    const auto spacing = first_of(header, fields, {"elementspacing", "elementsize"}, axes);
    const auto origin = first_of(header, fields, {"origin", "offset", "position"}, axes);
    const auto turn =
        first_of(header, fields, {"transformmatrix", "rotation", "orientation"}, axes * axes);
    Geometry& g = header.geometry;
    g.size = Index3::Ones();
    for (std::size_t a = 0; a < std::min<std::size_t>(3, axes); ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        g.size[i] = static_cast<int>(header.sizes[a]);
        if (!spacing.empty()) check_spacing(spacing[a], "header field 'elementspacing'");
        if (!spacing.empty()) g.spacing[i] = spacing[a];
        if (!origin.empty()) g.origin[i] = origin[a];
        for (std::size_t b = 0; !turn.empty() && b < std::min<std::size_t>(3, axes); ++b) {
            g.direction(static_cast<Eigen::Index>(b), i) = turn[a * axes + b];
        }
    }
    const std::string sides = fields.value("anatomicalorientation");
    g.oriented = sides.empty() ? g.direction != Mat3::Identity() : !sides.starts_with('?');
    g.measured = !spacing.empty();
    if (spacing.empty()) header.notes.push_back("its header gives no spacing: 1 mm was taken");
    const std::string unit = fields.value("distanceunits");
    const double length = unit == "?" ? 1 : length_unit(unit, header.notes);
    g.spacing *= length;
    g.origin *= length;
    const std::string slope = fields.value("elementtointensityfunctionslope"),
                      offset = fields.value("elementtointensityfunctionoffset");
    if ((!slope.empty() &&
         numbers_in(slope, "ElementToIntensityFunctionSlope") != std::vector{1.0}) ||
        (!offset.empty() &&
         numbers_in(offset, "ElementToIntensityFunctionOffset") != std::vector{0.0})) {
        header.notes.emplace_back(
            "its header maps samples to intensities (ElementToIntensityFunction): that was "
            "ignored, the samples are as they are stored");
    }
    if (spacing.size() == 4 && header.steps > 1) {
        header.times = frame_times(spacing[3], 0, "", header.notes);
    }
}

}  // namespace

VolumeHeader meta_image_header(const Request& request) {
    const HeaderFields fields = read_fields(request.path);
    VolumeHeader header;
    header.format = "MetaImage";
    header.stored = stored_from(fields.needed("elementtype"));
    header.sizes = sizes_in(fields.needed("dimsize"), "DimSize");
    const auto dimensions = numbers_in(fields.needed("ndims"), "NDims");
    if (dimensions.size() != 1 || header.sizes.empty() ||
        dimensions[0] != static_cast<double>(header.sizes.size())) {
        throw Failure("its header's NDims and DimSize do not agree; correct the header");
    }
    const std::string channels = fields.value("elementnumberofchannels");
    if (!channels.empty() && numbers_in(channels, "ElementNumberOfChannels") != std::vector{1.0}) {
        throw Failure("it has " + channels +
                      " values a sample (colours or vectors); give a volume with one");
    }
    header.places = places_of(fields, request.path, header.sizes.back(), header.notes);
    checked_bytes(header.sizes, size_of(header.stored), file_bytes(header), request);
    const bool at_end = fields.has("headersize") &&
                        whole_number_in(fields.value("headersize"), "HeaderSize", -1) == -1;
    for (DataPlace& place : header.places) {
        if (at_end) put_at_end(place, header.bytes_each(), "HeaderSize");
    }
    for (std::size_t a = 3; a < header.sizes.size(); ++a) header.steps *= header.sizes[a];
    header.together = static_cast<std::int64_t>(header.samples()) / header.steps;
    read_geometry(fields, header);
    return header;
}

}  // namespace palpate::io

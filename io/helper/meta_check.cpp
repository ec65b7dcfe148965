// MetaImage: our own reading of the header ("Key = Value" lines up to ElementDataFile).
#include <fstream>
#include <map>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

struct Fields {
    std::map<std::string, std::string> values;  ///< names in lower case
    std::uint64_t data_offset = 0;

    std::string value(const std::string& name) const {
        const auto found = values.find(name);
        return found == values.end() ? "" : found->second;
    }
    bool is_true(const std::string& name) const {
        const std::string v = lower(value(name));
        return !v.empty() && (v[0] == 't' || v[0] == '1' || v[0] == 'y');
    }
    std::string needed(const std::string& name) const {
        if (value(name).empty()) {
            throw Failure("its header has no field '" + name +
                          "'; it is no MetaImage or its header is damaged");
        }
        return value(name);
    }
};

Fields read_fields(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    Fields fields;
    std::string line;
    for (int lines = 0; lines < 1000 && std::getline(in, line); ++lines) {
        const auto equals = line.find('=');
        if (line.size() > 100000) break;
        if (equals == std::string::npos) {
            if (trimmed(line).empty()) continue;
            break;
        }
        const std::string name = lower(trimmed(line.substr(0, equals)));
        fields.values[name] = trimmed(line.substr(equals + 1));
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
        {"MET_LONG_LONG", Stored::int64}, {"MET_ULONG_LONG", Stored::uint64},
        {"MET_FLOAT", Stored::float32},   {"MET_DOUBLE", Stored::float64}};
    const auto found = types.find(type);
    if (found == types.end()) {
        throw Failure("its sample type '" + type +
                      "' cannot be read; save it as MET_SHORT or MET_FLOAT");
    }
    return found->second;
}

DataPlace place_of(const Fields& fields, const std::filesystem::path& path) {
    DataPlace place;
    const std::string name = fields.needed("elementdatafile");
    if (lower(name) == "local") {
        place.file = path;
        place.offset = fields.data_offset;
    } else if (name.rfind("LIST", 0) == 0 || name.find('%') != std::string::npos) {
        throw Failure(
            "its samples are spread over several files, which is not read; save it as "
            "one file (.mha)");
    } else {
        place.file = path.parent_path() / name;
    }
    if (!fields.value("headersize").empty()) {
        const auto skip = numbers_in(fields.value("headersize"), "HeaderSize");
        if (skip.size() != 1 || !(skip[0] >= -1 && skip[0] < 1e15)) {
            throw Failure("its header field 'HeaderSize' makes no sense; correct the header");
        }
        // -1: the samples are the end of the file; then any size that suffices is right.
        if (skip[0] > 0) place.offset += static_cast<std::uint64_t>(skip[0]);
    }
    if (fields.is_true("compresseddata")) {
        place.encoding = DataPlace::Encoding::compressed;
        const std::string size = fields.value("compresseddatasize");
        if (!size.empty()) {
            const auto numbers = numbers_in(size, "CompressedDataSize");
            if (numbers.size() != 1 || !(numbers[0] >= 0 && numbers[0] < 1e15)) {
                throw Failure("its CompressedDataSize makes no sense; correct the header");
            }
            if (numbers[0] > 0) place.length = static_cast<std::uint64_t>(numbers[0]);
        }
    } else if (!fields.value("binarydata").empty() && !fields.is_true("binarydata")) {
        place.encoding = DataPlace::Encoding::text;
    }
    return place;
}

void check_geometry(const Fields& fields, HeaderFacts& facts) {
    bool given = false;
    for (const char* name : {"elementspacing", "elementsize"}) {
        const auto spacings = numbers_in(fields.value(name), name);
        for (std::size_t a = 0; a < spacings.size() && a < 3; ++a) check_spacing(spacings[a], name);
        given |= !spacings.empty();
        if (spacings.size() == 4 && facts.sizes.size() == 4 && facts.sizes[3] > 1) {
            facts.times = frame_times(spacings[3], 0, "", facts.notes);
        }
    }
    if (!given) facts.notes.push_back("its header gives no spacing: 1 mm was taken");
}

}  // namespace

HeaderFacts check_meta_image(const Request& request) {
    const Fields fields = read_fields(request.path);
    HeaderFacts facts;
    facts.stored = stored_from(fields.needed("elementtype"));
    facts.sizes = sizes_in(fields.needed("dimsize"), "DimSize");
    const auto dimensions = numbers_in(fields.needed("ndims"), "NDims");
    if (dimensions.size() != 1 || facts.sizes.empty() ||
        dimensions[0] != static_cast<double>(facts.sizes.size())) {
        throw Failure("its header's NDims and DimSize do not agree; correct the header");
    }
    const std::string channels = fields.value("elementnumberofchannels");
    if (!channels.empty() && numbers_in(channels, "ElementNumberOfChannels") != std::vector{1.0}) {
        throw Failure("it has " + channels +
                      " values a sample (colours or vectors); give a volume with one");
    }
    DataPlace place = place_of(fields, request.path);
    std::error_code error;
    const auto file_bytes = std::filesystem::file_size(place.file, error);
    const std::uint64_t bytes =
        checked_bytes(facts.sizes, size_of(facts.stored), error ? 0 : file_bytes, request);
    const std::string skip = fields.value("headersize");
    if (!skip.empty() && numbers_in(skip, "HeaderSize")[0] == -1 && !error &&
        file_bytes >= bytes + place.offset) {
        place.offset = file_bytes - bytes;
    }
    check_geometry(fields, facts);
    check_data(place, bytes, bytes / size_of(facts.stored), facts.notes);
    return facts;
}

}  // namespace palpate::io

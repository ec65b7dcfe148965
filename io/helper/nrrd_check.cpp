// NRRD: our own reading of the header. Format: teem's "NRRD0001" to "NRRD0005".
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::uint64_t longest_header = 1 << 20;

struct Fields {
    std::map<std::string, std::string> values;
    std::uint64_t data_offset = 0;  ///< after the blank line

    bool has(const std::string& name) const { return values.count(name) > 0; }
    std::string value(const std::string& name) const {
        const auto found = values.find(name);
        return found == values.end() ? "" : found->second;
    }
    std::string needed(const std::string& name) const {
        if (!has(name)) {
            throw Failure("its header has no field '" + name + "'; the header is damaged");
        }
        return value(name);
    }
};

Fields read_fields(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string line;
    std::getline(in, line);
    if (line.rfind("NRRD000", 0) != 0 || line.size() > 20) {
        throw Failure("is not a NRRD file (it does not begin with NRRD000); check its name");
    }
    Fields fields;
    while (std::getline(in, line)) {
        const std::string text = trimmed(line);
        if (text.empty()) break;
        if (in.tellg() > static_cast<std::streamoff>(longest_header)) {
            throw Failure("its header has no end; the file is damaged");
        }
        const auto colon = text.find(':');
        if (text[0] == '#' || colon == std::string::npos || text.substr(colon, 2) == ":=") continue;
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

DataPlace place_of(const Fields& fields, const std::filesystem::path& path) {
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
void apply_skips(const Fields& fields, std::uint64_t bytes, DataPlace& place) {
    const auto skip_of = [&](const std::string& name) {
        const auto numbers = numbers_in(fields.has(name) ? fields.value(name) : "0", name);
        if (numbers.size() != 1 || !(numbers[0] >= -1 && numbers[0] < 1e15)) {
            throw Failure("its header field '" + name + "' makes no sense; correct the header");
        }
        return static_cast<std::int64_t>(numbers[0]);
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

/// The lengths of "space directions"; 0 for an axis that is not spatial ("none").
std::vector<double> direction_lengths(const std::string& text) {
    std::vector<double> lengths;
    std::size_t at = 0;
    while ((at = text.find_first_not_of(" \t", at)) != std::string::npos) {
        if (text.compare(at, 4, "none") == 0) {
            lengths.push_back(0);
            at += 4;
            continue;
        }
        const auto close = text.find(')', at);
        if (text[at] != '(' || close == std::string::npos) {
            throw Failure("its header field 'space directions' is damaged; correct the header");
        }
        std::string inside = text.substr(at + 1, close - at - 1);
        std::replace(inside.begin(), inside.end(), ',', ' ');
        double square = 0;
        for (const double n : numbers_in(inside, "space directions")) square += n * n;
        check_spacing(std::sqrt(square), "space directions");
        lengths.push_back(std::sqrt(square));
        at = close + 1;
    }
    return lengths;
}

bool is_list(const std::string& kind) {
    return kind == "list" || kind == "time";
}

/// A number of a field that has one for each axis; 0 if it has none.
double number_of_axis(const Fields& fields, const std::string& name, std::size_t axis) {
    const auto numbers = numbers_in(fields.value(name), name);
    return axis < numbers.size() ? numbers[axis] : 0;
}

/// The `axis`th of the quoted words of a field.
std::string quoted_word(const std::string& text, std::size_t axis) {
    std::size_t at = 0;
    for (std::size_t i = 0;; ++i) {
        const auto open = text.find('"', at);
        const auto close = open == std::string::npos ? open : text.find('"', open + 1);
        if (close == std::string::npos) return "";
        if (i == axis) return lower(trimmed(text.substr(open + 1, close - open - 1)));
        at = close + 1;
    }
}

FrameTimes times_of(const Fields& fields, std::size_t axis, std::vector<std::string>& notes) {
    return frame_times(number_of_axis(fields, "spacings", axis),
                       number_of_axis(fields, "axis mins", axis),
                       quoted_word(fields.value("units"), axis), notes);
}

void check_geometry(const Fields& fields, HeaderFacts& facts) {
    const std::size_t axes = facts.sizes.size();
    std::vector<std::string> kinds;
    std::istringstream words(lower(fields.value("kinds")));
    for (std::string kind; words >> kind;) kinds.push_back(kind);
    if (axes > 3) {
        for (std::size_t a = 0; a < std::min(axes, kinds.size()); ++a) {
            if (is_list(kinds[a])) facts.list_axis = a;
        }
    }
    const std::size_t list = facts.list_axis.value_or(axes - (axes > 3 ? 1 : 0));
    const bool has_directions = fields.has("space directions");
    if (has_directions) direction_lengths(fields.value("space directions"));
    if (fields.has("spacings")) {
        const auto spacings = numbers_in(fields.value("spacings"), "spacings");
        for (std::size_t a = 0; a < spacings.size(); ++a) {
            const bool spatial = a != list && (a >= kinds.size() || kinds[a] == "domain" ||
                                               kinds[a] == "space" || kinds[a] == "???");
            const bool left_open = has_directions && std::isnan(spacings[a]);
            if (spatial && !left_open) check_spacing(spacings[a], "spacings");
        }
    } else if (!has_directions) {
        facts.notes.push_back("its header gives no spacing: 1 mm was taken");
    }
    if (axes == 4) facts.times = times_of(fields, list, facts.notes);
    const std::string units = lower(fields.value("space units"));
    if (!units.empty() && units.find("\"mm\"") == std::string::npos &&
        units.find("millimet") == std::string::npos) {
        facts.notes.push_back("its lengths are in " + units + ", they were taken as mm");
    }
}

}  // namespace

HeaderFacts check_nrrd(const Request& request) {
    const Fields fields = read_fields(request.path);
    HeaderFacts facts;
    facts.stored = stored_from(fields.needed("type"));
    facts.sizes = sizes_in(fields.needed("sizes"), "sizes");
    const auto dimension = numbers_in(fields.needed("dimension"), "dimension");
    if (dimension.size() != 1 || dimension[0] != static_cast<double>(facts.sizes.size()) ||
        facts.sizes.empty()) {
        throw Failure("its header's dimension and sizes do not agree; correct the header");
    }
    DataPlace place = place_of(fields, request.path);
    std::error_code error;
    const auto file_bytes = std::filesystem::file_size(place.file, error);
    const std::uint64_t bytes =
        checked_bytes(facts.sizes, size_of(facts.stored), error ? 0 : file_bytes, request);
    apply_skips(fields, bytes, place);
    check_geometry(fields, facts);
    check_data(place, bytes, bytes / size_of(facts.stored), facts.notes);
    return facts;
}

}  // namespace palpate::io

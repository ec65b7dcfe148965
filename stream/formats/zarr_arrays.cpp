// Metadata of Zarr 2 and 3 arrays. Formats: https://zarr-specs.readthedocs.io/en/latest, v2/v2.0
// and v3/core, with the codecs of v3.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "io/system/number.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/zarr_metadata.hpp"

namespace palpate::stream {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse_type(const std::string& type) {
    throw BadMetadata("its samples are of type '" + type +
                      "', which is not read; store it as integers, float32 or float64");
}

/// "<u2", "|i1", ">f4"
void take_dtype(const Json& json, SampleBytes& bytes) {
    if (!json.is_string()) refuse_type("(several fields)");
    const std::string type = json.get<std::string>();
    if (type.size() != 3) refuse_type(type);
    const std::string kind = type[1] == 'u' || type[1] == 'b' ? "uint"
                             : type[1] == 'i'                 ? "int"
                             : type[1] == 'f'                 ? "float"
                                                              : "";
    const auto stored = io::stored_named(kind + std::to_string(8 * (type[2] - '0')));
    if (!stored || (type[1] == 'b' && *stored != io::Stored::uint8)) refuse_type(type);
    bytes.stored = *stored;
    bytes.swapped =
        (type[0] == '>') == (std::endian::native == std::endian::little) && bytes.size() > 1;
}

/// The numbers that an integer type can have: from the first to below the second.
std::pair<double, double> whole_numbers_of(io::Stored stored) {
    const int bits = static_cast<int>(8 * io::size_of(stored));
    if (io::name_of(stored).starts_with('u')) return {0, std::ldexp(1, bits)};
    return {-std::ldexp(1, bits - 1), std::ldexp(1, bits - 1)};
}

/// "NaN", "Infinity", or the bits of a float in hexadecimal digits.
std::optional<double> float_of(const std::string& text, io::Stored stored) {
    if (text == "NaN" || text == "Infinity" || text == "-Infinity") return std::nan("");
    std::uint64_t bits = 0;
    const char* const end = text.data() + text.size();
    if (text.size() != 2 + 2 * io::size_of(stored) || !text.starts_with("0x") ||
        std::from_chars(text.data() + 2, end, bits, 16).ptr != end) {
        return std::nullopt;
    }
    if (stored == io::Stored::float64) return std::bit_cast<double>(bits);
    if (stored == io::Stored::float16) return io::Half{static_cast<std::uint16_t>(bits)};
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
}

/// Refuses what the type does not have. In Zarr 2, a negative number of an unsigned type is the
/// signed one of as many bits, and whole numbers may be text, as zarr-python has it.
double fill_of(const Json& json, const SampleBytes& bytes, bool is_zarr2) {
    const io::Stored stored = bytes.stored;
    const bool is_float = io::is_real(stored);
    std::optional<double> fill;
    if (json.is_null()) fill = 0;
    if (json.is_boolean()) fill = json.get<bool>() ? 1 : 0;
    if (json.is_number()) fill = json.get<double>();
    if (json.is_number_unsigned()) {  // 2^64 - 1 becomes 2^64
        fill = std::min(*fill, std::nextafter(std::ldexp(1.0, 64), 0.0));
    }
    if (json.is_string() && is_float) fill = float_of(json.get<std::string>(), stored);
    if (json.is_string() && is_zarr2 && !is_float) {
        fill = io::number_from<double>(json.get<std::string>());
    }
    if (fill && !is_float) {
        const auto [low, high] = whole_numbers_of(stored);
        if (is_zarr2 && low == 0 && *fill < 0 && *fill >= -high / 2) *fill += high;
        if (*fill < low || *fill >= high || *fill != std::floor(*fill)) fill.reset();
    }
    if (!fill) {
        throw BadMetadata("its fill_value " + io::one_line(json.dump().substr(0, 40)) +
                          " is no number of its type " + io::name_of(stored) +
                          "; its metadata are damaged");
    }
    return fitting_fill(*fill, bytes);
}

char separator_of(const std::string& text) {
    if (text != "." && text != "/") {
        throw BadMetadata("the separator of its chunks is '" + text + "'; it is '.' or '/'");
    }
    return text[0];
}

[[noreturn]] void refuse_codec(const std::string& name) {
    throw BadMetadata("its codec '" + name +
                      "' is not read; store it with zstd, gzip, lz4 or blosc");
}

}  // namespace

ChunkedArray zarr2_array(const Json& zarray, const std::string& folder) {
    if (zarray.at("zarr_format") != 2) throw BadMetadata("its .zarray is not of Zarr 2");
    ChunkedArray array;
    array.folder = folder;
    array.shape = sizes_of(zarray.at("shape"), "shape");
    array.chunk = sizes_of(zarray.at("chunks"), "chunks");
    take_dtype(zarray.at("dtype"), array.bytes);
    array.bytes.fill = fill_of(member(zarray, "fill_value"), array.bytes, true);
    array.separator = separator_of(text_member(zarray, "dimension_separator", "."));
    const std::string order = text_member(zarray, "order", "C");
    if (order != "C" && order != "F")
        throw BadMetadata("its order is '" + order + "'; it is C or F");
    array.stored_axes = axes_in_order(array);
    if (order == "F") std::ranges::reverse(array.stored_axes);
    const Json& filters = member(zarray, "filters");
    if (filters.is_array() && !filters.empty()) {
        throw BadMetadata("its filter '" +
                          io::one_line(filters[0].at("id").get<std::string>().substr(0, 40)) +
                          "' is not read; store it without filters");
    }
    const Json& compressor = member(zarray, "compressor");
    if (!compressor.is_null()) {
        const std::string name = compressor.at("id").get<std::string>();
        const auto codec = codec_named(name);
        if (!codec) refuse_codec(name);
        array.codecs = {*codec};
    }
    check_array(array);
    return array;
}

namespace {

/// `each`: bytes of a number; the order of one has no name.
bool is_little(const Json& codec, std::size_t each) {
    const Json& configuration = member(codec, "configuration");
    if (each == 1 && !configuration.contains("endian")) return true;
    const std::string endian = text_member(configuration, "endian", "(not given)");
    if (endian != "little" && endian != "big") {
        throw BadMetadata("its byte order is '" + endian + "'; it is little or big");
    }
    return endian == "little";
}

void transpose(const Json& codec, ChunkedArray& array) {
    const Json& order = codec.at("configuration").at("order");
    const std::vector<int> in_order = axes_in_order(array);
    std::vector<std::int64_t> axes(in_order.begin(), in_order.end());
    if (order == "F") std::ranges::reverse(axes);
    if (order != "C" && order != "F") axes = sizes_of(order, "order");
    if (!std::ranges::is_permutation(axes, in_order)) {
        throw BadMetadata("the order of its axes is no permutation of them");
    }
    std::vector<int> stored;
    for (const std::int64_t axis : axes) {
        stored.push_back(array.stored_axes[static_cast<std::size_t>(axis)]);
    }
    array.stored_axes = stored;
}

/// A codec without configuration may be given by its name alone (Zarr 3.1).
std::string name_of(const Json& json) {
    return (json.is_string() ? json : json.at("name")).get<std::string>();
}

/// Takes the codecs of an array, or those within its shards.
void take_codecs(const Json& codecs, ChunkedArray& array);

void take_index_codecs(const Json& codecs, Shards& shards) {
    for (const Json& codec : codecs) {
        const std::string name = name_of(codec);
        if (name == "crc32c") {
            shards.index_codecs.insert(shards.index_codecs.begin(), Codec::crc32c);
        } else if (name == "bytes") {
            shards.is_index_big_endian = !is_little(codec, sizeof(std::uint64_t));
        } else {
            throw BadMetadata("the index of its shards is packed with '" + name +
                              "', which is not read; write it with bytes and crc32c");
        }
    }
}

void take_shards(const Json& configuration, ChunkedArray& array) {
    if (array.shards) throw BadMetadata("it has shards within shards; store it with one kind");
    Shards shards;
    shards.chunks.resize(array.axes());
    shards.axes = array.stored_axes;  // which a transposition before it may have turned
    const auto inner = sizes_of(configuration.at("chunk_shape"), "chunk_shape");
    if (array.chunk.size() != array.axes() || inner.size() != array.axes()) {
        throw BadMetadata("its shards or their chunks have another number of axes than the array");
    }
    for (std::size_t i = 0; i < inner.size(); ++i) {
        const auto a = static_cast<std::size_t>(array.stored_axes[i]);
        const std::int64_t shard = array.chunk[a];
        if (inner[i] < 1 || shard % inner[i] != 0) {
            throw BadMetadata("its shards are no whole number of chunks");
        }
        array.chunk[a] = inner[i];
        shards.chunks[a] = shard / inner[i];
    }
    const std::string place = text_member(configuration, "index_location", "end");
    if (place != "start" && place != "end") {
        throw BadMetadata("the index of its shards lies at '" + place + "'; it is start or end");
    }
    shards.index_at_start = place == "start";
    take_index_codecs(configuration.at("index_codecs"), shards);
    array.shards = std::move(shards);
    take_codecs(configuration.at("codecs"), array);
}

void take_codecs(const Json& codecs, ChunkedArray& array) {
    bool as_bytes = false;
    if (!codecs.is_array() || codecs.size() > 16)
        throw BadMetadata("its list of codecs is not sensible");
    for (const Json& codec : codecs) {
        const std::string name = name_of(codec);
        if (name == "transpose" && !as_bytes) {
            transpose(codec, array);
        } else if (name == "bytes" && !as_bytes) {
            array.bytes.swapped = is_little(codec, array.bytes.size()) !=
                                      (std::endian::native == std::endian::little) &&
                                  array.bytes.size() > 1;
            as_bytes = true;
        } else if (name == "sharding_indexed" && !as_bytes) {
            if (&codec != &codecs.back()) {
                throw BadMetadata("its shards are packed once more as a whole (codec '" +
                                  name_of(codecs.back()) +
                                  "'), so that no part can be read alone; store it with codecs "
                                  "within the shards");
            }
            take_shards(codec.at("configuration"), array);
            as_bytes = true;
        } else if (const auto known = codec_named(name); known && as_bytes) {
            array.codecs.insert(array.codecs.begin(), *known);
        } else {
            refuse_codec(name);
        }
    }
    if (!as_bytes) throw BadMetadata("its codecs have no 'bytes'; its metadata are damaged");
}

void take_key_encoding(const Json& encoding, ChunkedArray& array) {
    const std::string name = name_of(encoding);
    const Json& configuration = member(encoding, "configuration");
    if (name == "default") {
        array.separator = separator_of(text_member(configuration, "separator", "/"));
        array.prefix = std::string("c") + array.separator;
    } else if (name == "v2") {
        array.separator = separator_of(text_member(configuration, "separator", "."));
    } else {
        throw BadMetadata("the names of its chunks follow '" + name + "', which is not known");
    }
}

}  // namespace

void check_members(const Json& zarr) {
    constexpr std::array known = {"zarr_format",
                                  "node_type",
                                  "shape",
                                  "data_type",
                                  "chunk_grid",
                                  "fill_value",
                                  "codecs",
                                  "attributes",
                                  "chunk_key_encoding",
                                  "storage_transformers",
                                  "dimension_names",
                                  "consolidated_metadata"};
    for (const auto& [name, value] : zarr.items()) {
        if (std::ranges::find(known, name) != known.end()) continue;
        if (member(value, "must_understand") == false) continue;
        throw BadMetadata(
            "its member '" + io::one_line(name.substr(0, 40)) +
            "' of Zarr 3 is not known, and has to be understood; store it without it");
    }
}

ChunkedArray zarr3_array(const Json& zarr, const std::string& folder) {
    if (zarr.at("zarr_format") != 3 || zarr.at("node_type") != "array") {
        throw BadMetadata("its zarr.json is not that of a Zarr 3 array");
    }
    check_members(zarr);
    ChunkedArray array;
    array.folder = folder;
    array.shape = sizes_of(zarr.at("shape"), "shape");
    const Json& grid = zarr.at("chunk_grid");
    if (name_of(grid) != "regular") {
        throw BadMetadata("its chunks have different sizes, which is not read; store it with one");
    }
    array.chunk = sizes_of(grid.at("configuration").at("chunk_shape"), "chunk_shape");
    const std::string name = name_of(zarr.at("data_type"));
    const auto stored = io::stored_named(name == "bool" ? "uint8" : name);
    if (!stored) refuse_type(name);
    array.bytes.stored = *stored;
    array.bytes.fill = fill_of(member(zarr, "fill_value"), array.bytes, false);
    array.stored_axes = axes_in_order(array);
    take_key_encoding(zarr.at("chunk_key_encoding"), array);
    for (const Json& transformer : member(zarr, "storage_transformers")) {
        refuse_codec(name_of(transformer));
    }
    take_codecs(zarr.at("codecs"), array);
    check_array(array);
    return array;
}

}  // namespace palpate::stream

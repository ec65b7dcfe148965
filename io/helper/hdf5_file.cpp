// HDF5 files by libhdf5. See the header.
#include "io/helper/hdf5_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include "io/helper/decode.hpp"
#include "io/helper/far_file.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t longest_text = 4096;
constexpr std::size_t most_numbers = 4096;

std::string named(const std::string& path) {
    return "its dataset '" + path.substr(0, 120) + "'";
}

std::optional<Stored> stored_of(hid_t type) {
    const bool is_float = H5Tget_class(type) == H5T_FLOAT;
    if (!is_float && H5Tget_class(type) != H5T_INTEGER) return std::nullopt;
    const std::size_t size = H5Tget_size(type);
    if (H5Tget_precision(type) != 8 * size) return std::nullopt;  // 12 bits in 16
    if (is_float) {
        std::size_t sign = 0, exponent = 0, exponent_bits = 0, fraction = 0, fraction_bits = 0;
        H5Tget_fields(type, &sign, &exponent, &exponent_bits, &fraction, &fraction_bits);
        const std::size_t usual = size == 2 ? 5 : size == 4 ? 8 : 11;  // bfloat16 has 8 of 16
        if (exponent_bits != usual) return std::nullopt;
    }
    const std::string kind = is_float ? "float" : H5Tget_sign(type) == H5T_SGN_2 ? "int" : "uint";
    return stored_named(kind + std::to_string(8 * size));
}

/// By the numbers of https://github.com/HDFGroup/hdf5_plugins; in the order of decoding.
std::vector<std::string> codecs_of(hid_t properties, std::size_t sample_size) {
    constexpr int lz4_filter = 32004, blosc_filter = 32001, zstd_filter = 32015;
    std::vector<std::string> codecs;
    for (int i = 0; i < H5Pget_nfilters(properties); ++i) {
        unsigned flags = 0, values[16] = {}, config = 0;
        std::size_t count = std::size(values);
        char name[64] = {};
        const H5Z_filter_t filter = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags,
                                                   &count, values, sizeof name, name, &config);
        if (filter == H5Z_FILTER_SHUFFLE && (count == 0 || values[0] != sample_size)) {
            throw Failure("its filter shuffle has another size than its samples; write it again");
        }
        const char* const codec = filter == H5Z_FILTER_DEFLATE      ? "gzip"
                                  : filter == H5Z_FILTER_SHUFFLE    ? "shuffle"
                                  : filter == H5Z_FILTER_FLETCHER32 ? "fletcher32"
                                  : filter == lz4_filter            ? "hdf5_lz4"
                                  : filter == blosc_filter          ? "blosc"
                                  : filter == zstd_filter           ? "zstd"
                                                                    : nullptr;
        if (!codec) {
            throw Failure("its filter " + std::to_string(filter) + " (" + std::string(name) +
                          ") is not read; write it with gzip");
        }
        codecs.insert(codecs.begin(), codec);
    }
    return codecs;
}

double fill_of(hid_t properties) {
    H5D_fill_value_t kind = H5D_FILL_VALUE_UNDEFINED;
    double fill = 0;
    if (H5Pfill_value_defined(properties, &kind) < 0 || kind == H5D_FILL_VALUE_UNDEFINED ||
        H5Pget_fill_value(properties, H5T_NATIVE_DOUBLE, &fill) < 0 || !std::isfinite(fill)) {
        return 0;
    }
    return fill;
}

/// Refuses arrays that grow along one axis other than the first, in files of HDF5's newer format:
/// for these, libhdf5 1.10 tells the places of other chunks.
void check_index(hid_t data, hid_t space, const std::string& path) {
    H5D_chunk_index_t index = H5D_CHUNK_IDX_BTREE;
    hsize_t most[3] = {};
    if (H5Dget_chunk_index_type(data, &index) < 0 ||
        H5Sget_simple_extent_dims(space, nullptr, most) != 3) {
        throw Failure("is damaged; copy it again");
    }
    if (index != H5D_CHUNK_IDX_EARRAY || most[0] == H5S_UNLIMITED) return;
    throw Failure(named(path) +
                  " can grow along an axis other than the first, in HDF5's newer format, which is "
                  "not read; copy it with h5repack, or write it with libver='earliest'");
}

bool is_hdf5(const std::filesystem::path& path) {
    if (!is_far()) return H5Fis_hdf5(path.c_str()) > 0;
    constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
    std::array<std::byte, signature.size()> begin{};
    return read_far(0, begin) && std::memcmp(begin.data(), signature.data(), begin.size()) == 0;
}

hid_t opened(const std::filesystem::path& path) {
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    if (is_far() && !use_far_driver(access)) return -1;
    return H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path)
    : file_((H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), H5PLset_loading_state(0), opened(path)),
            H5Fclose) {
    if (!file_.is_open()) {
        throw Failure(
            is_hdf5(path)
                ? "is damaged, cut off, or still open in the program that writes it; copy "
                  "it again"
                : "is no HDF5 file; check its name");
    }
    const Hdf5Handle creation(H5Fget_create_plist(file_), H5Pclose);
    hsize_t user_block = 0;
    if (H5Pget_userblock(creation, &user_block) < 0 || user_block != 0) {
        throw Failure("its HDF5 begins after other bytes (a user block), which is not read");
    }
    H5O_info_t info;
    if (H5Oget_info2(file_, &info, H5O_INFO_BASIC) < 0) throw Failure("is damaged; copy it again");
    number_ = info.fileno;
}

bool Hdf5File::has(const std::string& path) const {
    for (std::size_t end = 0; end != std::string::npos;) {
        end = path.find('/', end + 1);
        if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    }
    return H5Oexists_by_name(file_, path.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> Hdf5File::names() const {
    std::vector<std::string> names;
    const auto take = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
        static_cast<std::vector<std::string>*>(to)->emplace_back(name);
        return 0;
    };
    if (H5Literate(file_, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, take, &names) < 0) {
        throw Failure("is damaged; copy it again");
    }
    return names;
}

int Hdf5File::count(const std::function<std::string(int)>& name) const {
    constexpr int most = 1 << 20;
    int known = 0;
    while (known < most && has(name(known))) ++known;
    return known;
}

std::string Hdf5File::text(const std::string& object, const char* attribute) const {
    if (H5Aexists_by_name(file_, object.c_str(), attribute, H5P_DEFAULT) <= 0) return "";
    const Hdf5Handle one(
        H5Aopen_by_name(file_, object.c_str(), attribute, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    const Hdf5Handle type(H5Aget_type(one), H5Tclose), space(H5Aget_space(one), H5Sclose);
    const hssize_t letters = H5Sget_simple_extent_npoints(space);
    std::string text;
    double number = 0;
    char* word = nullptr;
    if (H5Tget_class(type) != H5T_STRING) {
        if (letters != 1 || H5Aread(one, H5T_NATIVE_DOUBLE, &number) < 0) return "";
        append_number(text, number);
        return text;
    }
    if (H5Tis_variable_str(type) > 0) {
        if (letters != 1 || H5Aread(one, type, static_cast<void*>(&word)) < 0 || !word) return "";
        text.assign(word, strnlen(word, longest_text));
        H5free_memory(word);
        return trimmed(text);
    }
    if (letters < 1 || static_cast<std::size_t>(letters) > longest_text ||
        H5Tget_size(type) > longest_text) {
        return "";
    }
    text.resize(static_cast<std::size_t>(letters) * H5Tget_size(type));
    if (H5Aread(one, type, text.data()) < 0) throw Failure("is damaged; copy it again");
    text.resize(std::min(text.find('\0'), text.size()));
    return trimmed(text);
}

std::optional<double> Hdf5File::number(const std::string& object, const char* attribute) const {
    const auto number = number_from<double>(text(object, attribute));
    return number && std::isfinite(*number) ? number : std::nullopt;
}

std::vector<double> Hdf5File::numbers(const std::string& dataset) const {
    const Hdf5Handle data = open_dataset(dataset);
    const Hdf5Handle space(H5Dget_space(data), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count < 0 || static_cast<std::size_t>(count) > most_numbers) {
        throw Failure(named(dataset) + " is too long");
    }
    std::vector<double> numbers(static_cast<std::size_t>(count));
    if (count > 0 &&
        H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) < 0) {
        throw Failure(named(dataset) + " cannot be read: the file is damaged; copy it again");
    }
    return numbers;
}

Hdf5Handle Hdf5File::open_dataset(const std::string& path) const {
    Hdf5Handle data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.is_open()) {
        throw Failure(named(path) + " cannot be read: the file is damaged; copy it again");
    }
    H5O_info_t info;
    if (H5Oget_info2(data, &info, H5O_INFO_BASIC) < 0 || info.fileno != number_) {
        throw Failure(named(path) + " lies in another file; give that one, or join them");
    }
    return data;
}

ImageArray Hdf5File::array(const std::string& path) const {
    const Hdf5Handle data = open_dataset(path);
    const Hdf5Handle type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose),
        properties(H5Dget_create_plist(data), H5Pclose);
    hsize_t shape[3], chunk[3];
    if (H5Sget_simple_extent_ndims(space) != 3 ||
        H5Sget_simple_extent_dims(space, shape, nullptr) != 3) {
        throw Failure(named(path) + " has not three axes; it is no volume");
    }
    const auto stored = stored_of(type);
    if (!stored) {
        throw Failure(named(path) +
                      " has samples that are no usual integers or floats; store them as "
                      "integers, float32 or float64");
    }
    ImageArray array;
    array.id = path;
    array.stored = *stored;
    array.swapped = size_of(*stored) > 1 && (H5Tget_order(type) == H5T_ORDER_BE) ==
                                                (std::endian::native == std::endian::little);
    array.fill = fill_of(properties);
    std::copy_n(shape, 3, chunk);
    if (H5Pget_layout(properties) == H5D_CHUNKED) {
        unsigned options = 0;
        if (H5Pget_chunk(properties, 3, chunk) != 3 ||
            H5Pget_chunk_opts(properties, &options) < 0 || options != 0) {
            throw Failure(named(path) + " has chunks of a kind that is not read");
        }
        check_index(data, space, path);
        array.codecs = codecs_of(properties, size_of(*stored));
    } else if (H5Pget_layout(properties) != H5D_CONTIGUOUS ||
               H5Pget_external_count(properties) != 0) {
        throw Failure(named(path) +
                      " is neither in chunks nor in one piece of the file; store it in chunks");
    }
    for (std::size_t a = 0; a < 3; ++a) {
        constexpr hsize_t longest = hsize_t{1} << 40;
        array.shape[a] = static_cast<std::int64_t>(std::min(shape[a], longest));
        array.chunk[a] = static_cast<std::int64_t>(std::min(chunk[a], longest));
    }
    return array;
}

void Hdf5File::places(const std::string& path, const std::array<std::int64_t, 3>& first,
                      const std::array<std::int64_t, 3>& count,
                      std::span<ChunkPlace> places) const {
    const Hdf5Handle data = open_dataset(path);
    const Hdf5Handle properties(H5Dget_create_plist(data), H5Pclose);
    if (H5Pget_layout(properties) != H5D_CHUNKED) {
        const haddr_t offset = H5Dget_offset(data);
        if (offset != HADDR_UNDEF) places[0] = {offset, H5Dget_storage_size(data), 0};
        return;
    }
    const int filters = H5Pget_nfilters(properties);
    hsize_t chunk[3];
    if (H5Pget_chunk(properties, 3, chunk) != 3) throw Failure("is damaged; copy it again");
    std::size_t at = 0;
    for (std::int64_t z = 0; z < count[0]; ++z) {
        for (std::int64_t y = 0; y < count[1]; ++y) {
            for (std::int64_t x = 0; x < count[2]; ++x, ++at) {
                const hsize_t corner[3] = {static_cast<hsize_t>(first[0] + z) * chunk[0],
                                           static_cast<hsize_t>(first[1] + y) * chunk[1],
                                           static_cast<hsize_t>(first[2] + x) * chunk[2]};
                unsigned mask = 0;
                haddr_t offset = HADDR_UNDEF;
                hsize_t length = 0;
                if (H5Dget_chunk_info_by_coord(data, corner, &mask, &offset, &length) < 0) {
                    throw Failure("its list of chunks is damaged; copy it again");
                }
                if (offset == HADDR_UNDEF) continue;
                places[at] = {offset, length, 0};
                // Filters are numbered in the order of packing.
                for (int i = 0; i < filters; ++i) {
                    if ((mask >> i & 1U) != 0) places[at].skipped |= 1U << (filters - 1 - i);
                }
            }
        }
    }
}

}  // namespace palpate::io

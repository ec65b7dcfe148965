// A multiscale OME-Zarr image that grows chunk by chunk. See the header.
#include "palpate/stream/growing_image.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "io/file_grid.hpp"
#include "io/process/helper_process.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/stores.hpp"
#include "stream/formats/zarr_metadata.hpp"
#include "stream/objects/held_folder.hpp"
#include "stream/writer/pyramid.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
constexpr int gzip_level = 5, zstd_level = 3, blosc_level = 5;

/// z, y, x: the slowest first.
template <class Vector>
Json slowest_first(const Vector& v) {
    return {v[2], v[1], v[0]};
}

/// Name and configuration, as both versions of Zarr have them but for few members; null for none.
Json codec_of(const ConvertOptions& options, std::size_t each) {
    const bool three = options.zarr_version == 3;
    Json how;
    switch (options.compression) {
        case Compression::none:
            return nullptr;
        case Compression::gzip:
            return {{"name", "gzip"}, {"configuration", {{"level", gzip_level}}}};
        case Compression::zstd:
            how = {{"level", zstd_level}};
            if (three) how["checksum"] = true;
            return {{"name", "zstd"}, {"configuration", how}};
        case Compression::blosc:
            break;
    }
    how = {{"cname", "zstd"}, {"clevel", blosc_level}, {"blocksize", 0}};
    how["shuffle"] = three ? Json(each > 1 ? "shuffle" : "noshuffle") : Json(each > 1 ? 1 : 0);
    if (three) how["typesize"] = each;
    return {{"name", "blosc"}, {"configuration", how}};
}

/// gzip has a checksum of its own, and zstd can have one. Zarr 2 has none for the others.
bool needs_checksum(const ConvertOptions& options) {
    return options.zarr_version == 3 &&
           (options.compression == Compression::none || options.compression == Compression::blosc);
}

bool is_zero(std::span<const std::byte> bytes) {
    return std::ranges::all_of(bytes, [](std::byte b) { return b == std::byte{0}; });
}

Json array2(const Geometry& grid, SampleType type, const ConvertOptions& options) {
    const char* const dtype = type == SampleType::uint8    ? "|u1"
                              : type == SampleType::int16  ? "<i2"
                              : type == SampleType::uint16 ? "<u2"
                                                           : "<f4";
    const Json codec = codec_of(options, size_of(type));
    Json compressor;
    if (!codec.is_null()) {
        compressor = codec["configuration"];
        compressor["id"] = codec["name"];
    }
    return {{"zarr_format", 2},
            {"shape", slowest_first(grid.size)},
            {"chunks", Json(std::vector<int>(3, options.chunk))},
            {"dtype", dtype},
            {"compressor", compressor},
            {"fill_value", 0},
            {"order", "C"},
            {"filters", nullptr},
            {"dimension_separator", "/"}};
}

Json array3(const Geometry& grid, SampleType type, const ConvertOptions& options) {
    const Json codec = codec_of(options, size_of(type));
    Json codecs = {{{"name", "bytes"}, {"configuration", {{"endian", "little"}}}}};
    if (!codec.is_null()) codecs.push_back(codec);
    if (needs_checksum(options)) codecs.push_back({{"name", "crc32c"}});
    return {{"zarr_format", 3},
            {"node_type", "array"},
            {"shape", slowest_first(grid.size)},
            {"data_type", name_of(type)},
            {"chunk_grid",
             {{"name", "regular"},
              {"configuration", {{"chunk_shape", Json(std::vector<int>(3, options.chunk))}}}}},
            {"chunk_key_encoding", {{"name", "default"}, {"configuration", {{"separator", "/"}}}}},
            {"fill_value", 0},
            {"codecs", codecs},
            {"dimension_names", {"z", "y", "x"}},
            {"attributes", Json::object()}};
}

Json image_of(const std::vector<CoarserGrid>& levels) {
    Json axes = Json::array(), datasets = Json::array();
    for (const char* name : {"z", "y", "x"}) {
        axes.push_back({{"name", name}, {"type", "space"}, {"unit", "millimeter"}});
    }
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const Geometry& grid = levels[i].geometry;
        datasets.push_back(
            {{"path", std::to_string(i)},
             {"coordinateTransformations",
              {{{"type", "scale"}, {"scale", slowest_first(grid.spacing)}},
               {{"type", "translation"}, {"translation", slowest_first(grid.origin)}}}}});
    }
    return {{"axes", axes}, {"datasets", datasets}, {"type", "mean"}, {"name", "image"}};
}

}  // namespace

void check_format(const ConvertOptions& options) {
    if (options.zarr_version != 2 && options.zarr_version != 3) {
        throw std::invalid_argument("Zarr version " + std::to_string(options.zarr_version) +
                                    " cannot be written; there are 2 and 3");
    }
    if (options.chunk < 8 || options.chunk > 512) {
        throw std::invalid_argument("chunks have 8 to 512 samples along each axis");
    }
}

struct GrowingImage::Parts {
    Parts(fs::path path, SampleType of, std::vector<CoarserGrid> grids, const ConvertOptions& how,
          std::string ending)
        : folder(std::move(path)),
          type(of),
          levels(std::move(grids)),
          options(how),
          temporary(std::move(ending)) {
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const Geometry& grid = levels[i].geometry;
            arrays.push_back(options.zarr_version == 2
                                 ? zarr2_array(array2(grid, type, options), std::to_string(i))
                                 : zarr3_array(array3(grid, type, options), std::to_string(i)));
        }
    }

    const CoarserGrid& grid(int level) const { return levels.at(static_cast<std::size_t>(level)); }

    /// The image as it is read, opened when it is needed first.
    const Store& read() const {
        std::call_once(opening, [&] {
            store = open_zarr(folder_objects(folder.path()), folder.path().string(), {});
            if (!store) fail_without(folder.path());
        });
        return *store;
    }

    void put_json(const fs::path& name, const Json& json) const {
        const std::string text = json.dump(1);
        folder.put(name, std::as_bytes(std::span(text)), temporary);
    }

    std::string name_of(int level, const Index3& chunk) const {
        const std::array<std::int64_t, 3> index = {chunk[2], chunk[1], chunk[0]};
        return key_of(arrays[static_cast<std::size_t>(level)], index);
    }

    Bytes packed(const Bytes& samples) const {
        switch (options.compression) {
            case Compression::none:
                return checked(samples);
            case Compression::gzip:
                return packed_gzip(samples, gzip_level);
            case Compression::zstd:
                return packed_zstd(samples, zstd_level);
            case Compression::blosc:
                break;
        }
        return checked(packed_blosc(samples, size_of(type), blosc_level));
    }

    Bytes checked(Bytes bytes) const {
        if (!needs_checksum(options)) return bytes;
        const std::uint32_t sum = crc32c_of(bytes);
        for (int shift = 0; shift < 32; shift += 8) {
            bytes.push_back(static_cast<std::byte>(sum >> shift & 0xff));
        }
        return bytes;
    }

    /// A chunk with what lies outside the grid.
    SampleBox whole(const Index3& chunk) const {
        const Index3 low = chunk * options.chunk;
        return {low, low + Index3::Constant(options.chunk - 1)};
    }

    std::optional<Bytes> stored(int level, const Index3& chunk) const {
        const io::Descriptor file = folder.open(name_of(level, chunk));
        struct stat about {};
        if (file.number() < 0 || ::fstat(file.number(), &about) != 0) return std::nullopt;
        const ChunkedArray& array = arrays[static_cast<std::size_t>(level)];
        const auto size = static_cast<std::size_t>(about.st_size);
        if (size > packed_at_most(array.bytes_in_chunk())) return std::nullopt;
        Bytes bytes(size);
        if (io::read_at(file.number(), bytes.data(), size, 0) != about.st_size) return std::nullopt;
        try {
            return decoded(array.codecs, std::move(bytes), array.bytes_in_chunk());
        } catch (const DamagedChunk&) {
            return std::nullopt;
        }
    }

    mutable HeldFolder folder;
    SampleType type;
    std::vector<CoarserGrid> levels;
    ConvertOptions options;
    std::string temporary;
    std::vector<ChunkedArray> arrays;
    mutable std::once_flag opening;
    mutable std::shared_ptr<const Store> store;
};

GrowingImage::GrowingImage(fs::path folder, SampleType type, std::vector<CoarserGrid> levels,
                           const ConvertOptions& options, std::string temporary) {
    check_format(options);
    for (const CoarserGrid& level : levels) {
        const std::string why = io::why_not_stored(level.geometry);
        if (!why.empty()) throw std::invalid_argument(why);
    }
    parts_ = std::make_unique<const Parts>(std::move(folder), type, std::move(levels), options,
                                           std::move(temporary));
}

GrowingImage::GrowingImage(fs::path folder, SampleType type, const Geometry& finest,
                           const ConvertOptions& options, std::string temporary)
    : GrowingImage(std::move(folder), type, pyramid_of(finest, options.chunk), options,
                   std::move(temporary)) {}

GrowingImage::~GrowingImage() = default;

int GrowingImage::levels() const {
    return static_cast<int>(parts_->levels.size());
}

const Geometry& GrowingImage::geometry(int level) const {
    return parts_->grid(level).geometry;
}

Index3 GrowingImage::chunks(int level) const {
    const int chunk = parts_->options.chunk;
    return (geometry(level).size.array() + (chunk - 1)) / chunk;
}

SampleBox GrowingImage::box(int level, const Index3& chunk) const {
    const auto [low, high] = parts_->whole(chunk);
    return {low, high.cwiseMin(geometry(level).size - Index3::Ones())};
}

void GrowingImage::write_metadata(const std::optional<Range>& range) const {
    Json image = image_of(parts_->levels), ours = Json::object();
    const Geometry& finest = parts_->levels.front().geometry;
    if (finest.oriented || finest.direction != Mat3::Identity()) {
        // OME-Zarr has no directions before version 0.6.
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row)
                ours["direction"].push_back(finest.direction(row, column));
        }
    }
    if (ours.contains("direction") && !finest.oriented) ours["oriented"] = false;
    if (!finest.measured) ours["measured"] = false;
    if (range) ours["range"] = {range->minimum, range->maximum};
    if (!range) parts_->folder.make();
    const bool two = parts_->options.zarr_version == 2;
    for (std::size_t i = 0; i < parts_->levels.size(); ++i) {
        const Geometry& grid = parts_->levels[i].geometry;
        const fs::path level = std::to_string(i);
        parts_->put_json(level / (two ? ".zarray" : "zarr.json"),
                         two ? array2(grid, parts_->type, parts_->options)
                             : array3(grid, parts_->type, parts_->options));
    }
    if (two) {
        image["version"] = "0.4";
        parts_->put_json(".zgroup", {{"zarr_format", 2}});
        parts_->put_json(".zattrs", {{"multiscales", {image}}, {"palpate", ours}});
    } else {
        parts_->put_json(
            "zarr.json",
            {{"zarr_format", 3},
             {"node_type", "group"},
             {"attributes",
              {{"ome", {{"version", "0.5"}, {"multiscales", {image}}}}, {"palpate", ours}}}});
    }
}

std::uint64_t GrowingImage::stored_chunks() const {
    std::uint64_t count = 0;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(parts_->folder.path(), error), end;
         entry != end && !error; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        const bool is_chunk = name.find_first_not_of("0123456789") == std::string::npos;
        count += is_chunk && entry->is_regular_file(error) ? 1 : 0;
    }
    return count;
}

bool GrowingImage::write(int level, const Index3& chunk, std::span<const std::byte> samples,
                         bool zeros) const {
    const SampleBox part = box(level, chunk);
    if (part.empty() || samples.size() != bytes_of(part, parts_->type)) {
        throw std::invalid_argument("these are not the samples of this chunk");
    }
    if (!zeros && is_zero(samples)) return false;
    const SampleBox whole = parts_->whole(chunk);
    Bytes all(bytes_of(whole, parts_->type));
    copy_box(part, samples.data(), whole, all.data(), size_of(parts_->type));
    const fs::path name = parts_->name_of(level, chunk);
    parts_->folder.put(name, parts_->packed(all), parts_->temporary);
    const auto back = parts_->stored(level, chunk);
    if (!back || *back != all) {
        throw io::OutputError((parts_->folder.path() / name).string() +
                              ": reads back as something else; check the disk");
    }
    return true;
}

std::optional<Bytes> GrowingImage::written(int level, const Index3& chunk) const {
    const auto all = parts_->stored(level, chunk);
    // After a power cut, a file without its bytes may remain, and zeros are not stored otherwise.
    if (!all || is_zero(*all)) return std::nullopt;
    const SampleBox part = box(level, chunk);
    Bytes samples(bytes_of(part, parts_->type));
    copy_box(parts_->whole(chunk), all->data(), part, samples.data(), size_of(parts_->type));
    return samples;
}

Bytes GrowingImage::means(int level, const Index3& chunk, const std::stop_token& stop) const {
    if (level < 1) throw std::invalid_argument("the finest level is not made of means");
    const Index3& factor = parts_->grid(level).factor;
    const SampleBox part = box(level, chunk);
    const SampleBox wanted = finer_box(part, factor, geometry(level - 1));
    Bytes below(bytes_of(wanted, parts_->type)), samples(bytes_of(part, parts_->type));
    parts_->read().read(level - 1, wanted, below, stop);
    take_means(parts_->type, below, wanted, factor, part, samples);
    return samples;
}

}  // namespace palpate::stream

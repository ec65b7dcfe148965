// Writes the files of a multiscale OME-Zarr image. See the header.
#include "stream/writer/zarr_writer.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <stdexcept>

#include "io/process/helper_process.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/zarr_metadata.hpp"

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

Json compressor2(Compression compression, std::size_t each) {
    switch (compression) {
        case Compression::none:
            return nullptr;
        case Compression::gzip:
            return {{"id", "gzip"}, {"level", gzip_level}};
        case Compression::zstd:
            return {{"id", "zstd"}, {"level", zstd_level}};
        case Compression::blosc:
            break;
    }
    return {{"id", "blosc"},
            {"cname", "zstd"},
            {"clevel", blosc_level},
            {"shuffle", each > 1 ? 1 : 0},
            {"blocksize", 0}};
}

Json codecs3(Compression compression, std::size_t each) {
    Json codecs = {{{"name", "bytes"}, {"configuration", {{"endian", "little"}}}}};
    Json how;
    if (compression == Compression::gzip) {
        how = {{"name", "gzip"}, {"configuration", {{"level", gzip_level}}}};
    } else if (compression == Compression::zstd) {
        how = {{"name", "zstd"}, {"configuration", {{"level", zstd_level}, {"checksum", true}}}};
    } else if (compression == Compression::blosc) {
        how = {{"name", "blosc"},
               {"configuration",
                {{"cname", "zstd"},
                 {"clevel", blosc_level},
                 {"shuffle", each > 1 ? "shuffle" : "noshuffle"},
                 {"typesize", each},
                 {"blocksize", 0}}}};
    }
    if (!how.is_null()) codecs.push_back(how);
    return codecs;
}

Json array2(const Geometry& grid, SampleType type, const ConvertOptions& options) {
    const char* const dtype = type == SampleType::uint8    ? "|u1"
                              : type == SampleType::int16  ? "<i2"
                              : type == SampleType::uint16 ? "<u2"
                                                           : "<f4";
    return {{"zarr_format", 2},
            {"shape", slowest_first(grid.size)},
            {"chunks", Json(std::vector<int>(3, options.chunk))},
            {"dtype", dtype},
            {"compressor", compressor2(options.compression, size_of(type))},
            {"fill_value", 0},
            {"order", "C"},
            {"filters", nullptr},
            {"dimension_separator", "/"}};
}

Json array3(const Geometry& grid, SampleType type, const ConvertOptions& options) {
    return {{"zarr_format", 3},
            {"node_type", "array"},
            {"shape", slowest_first(grid.size)},
            {"data_type", name_of(type)},
            {"chunk_grid",
             {{"name", "regular"},
              {"configuration", {{"chunk_shape", Json(std::vector<int>(3, options.chunk))}}}}},
            {"chunk_key_encoding", {{"name", "default"}, {"configuration", {{"separator", "/"}}}}},
            {"fill_value", 0},
            {"codecs", codecs3(options.compression, size_of(type))},
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

ZarrWriter::ZarrWriter(fs::path folder, SampleType type, std::vector<CoarserGrid> levels,
                       const ConvertOptions& options, std::string temporary)
    : folder_(std::make_shared<HeldFolder>(std::move(folder))),
      type_(type),
      levels_(std::move(levels)),
      options_(options),
      temporary_(std::move(temporary)) {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const Geometry& grid = levels_[i].geometry;
        arrays_.push_back(options_.zarr_version == 2
                              ? zarr2_array(array2(grid, type, options_), std::to_string(i))
                              : zarr3_array(array3(grid, type, options_), std::to_string(i)));
    }
}

void ZarrWriter::write_metadata(const std::optional<Range>& range) const {
    Json image = image_of(levels_), ours = Json::object();
    const Geometry& finest = levels_.front().geometry;
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
    if (!range) folder_->make();
    const bool two = options_.zarr_version == 2;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const Geometry& grid = levels_[i].geometry;
        const fs::path level = std::to_string(i);
        put_json(level / (two ? ".zarray" : "zarr.json"),
                 two ? array2(grid, type_, options_) : array3(grid, type_, options_));
    }
    if (two) {
        image["version"] = "0.4";
        put_json(".zgroup", {{"zarr_format", 2}});
        put_json(".zattrs", {{"multiscales", {image}}, {"palpate", ours}});
    } else {
        put_json("zarr.json",
                 {{"zarr_format", 3},
                  {"node_type", "group"},
                  {"attributes",
                   {{"ome", {{"version", "0.5"}, {"multiscales", {image}}}}, {"palpate", ours}}}});
    }
}

void ZarrWriter::put_json(const fs::path& name, const Json& json) const {
    const std::string text = json.dump(1);
    folder_->put(name, std::as_bytes(std::span(text)), temporary_);
}

std::uint64_t ZarrWriter::stored_chunks() const {
    std::uint64_t count = 0;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder_->path(), error), end;
         entry != end && !error; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        const bool is_chunk = name.find_first_not_of("0123456789") == std::string::npos;
        count += is_chunk && entry->is_regular_file(error) ? 1 : 0;
    }
    return count;
}

Index3 ZarrWriter::chunks_of(int level) const {
    const Index3& size = levels_[static_cast<std::size_t>(level)].geometry.size;
    return (size.array() + (options_.chunk - 1)) / options_.chunk;
}

std::string ZarrWriter::name_of(int level, const Index3& chunk) const {
    const std::array<std::int64_t, 3> index = {chunk[2], chunk[1], chunk[0]};
    return key_of(arrays_[static_cast<std::size_t>(level)], index);
}

Bytes ZarrWriter::packed(const Bytes& samples) const {
    switch (options_.compression) {
        case Compression::none:
            break;
        case Compression::gzip:
            return packed_gzip(samples, gzip_level);
        case Compression::zstd:
            return packed_zstd(samples, zstd_level);
        case Compression::blosc:
            return packed_blosc(samples, size_of(type_), blosc_level);
    }
    return samples;
}

SampleBox ZarrWriter::whole(const Index3& chunk) const {
    const Index3 low = chunk * options_.chunk;
    return {low, low + Index3::Constant(options_.chunk - 1)};
}

SampleBox ZarrWriter::box_of(int level, const Index3& chunk) const {
    const Index3& size = levels_.at(static_cast<std::size_t>(level)).geometry.size;
    const auto [low, high] = whole(chunk);
    return {low, high.cwiseMin(size - Index3::Ones())};
}

bool ZarrWriter::write_chunk(int level, const Index3& chunk,
                             std::span<const std::byte> samples) const {
    if (std::ranges::all_of(samples, [](std::byte b) { return b == std::byte{0}; })) return false;
    Bytes all(bytes_of(whole(chunk), type_));
    copy_box(box_of(level, chunk), samples.data(), whole(chunk), all.data(), size_of(type_));
    const fs::path name = name_of(level, chunk);
    folder_->put(name, packed(all), temporary_);
    const auto back = stored(level, chunk);
    if (!back || *back != all) {
        throw io::OutputError((folder_->path() / name).string() +
                              ": reads back as something else; check the disk");
    }
    return true;
}

std::optional<Bytes> ZarrWriter::written_chunk(int level, const Index3& chunk) const {
    const auto all = stored(level, chunk);
    if (!all) return std::nullopt;
    const SampleBox box = box_of(level, chunk);
    Bytes samples(bytes_of(box, type_));
    copy_box(whole(chunk), all->data(), box, samples.data(), size_of(type_));
    return samples;
}

std::optional<Bytes> ZarrWriter::stored(int level, const Index3& chunk) const {
    const io::Descriptor file = folder_->open(name_of(level, chunk));
    struct stat about {};
    if (file.number() < 0 || ::fstat(file.number(), &about) != 0) return std::nullopt;
    const ChunkedArray& array = arrays_[static_cast<std::size_t>(level)];
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

}  // namespace palpate::stream

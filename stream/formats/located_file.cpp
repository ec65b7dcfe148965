// Files of chunks that the helper process locates: HDF5 and tiled TIFF. See the header.
#include "stream/formats/located_file.hpp"

#include <algorithm>

#include "io/process/located_chunks.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/chunk_table.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/stores.hpp"

namespace palpate::stream {
namespace {

/// Of HDF5 and TIFF: with these they say where everything else lies.
constexpr std::uint64_t bytes_of_head = 64;

ChunkedArray located_array(const io::ImageArray& level, const std::shared_ptr<LocatedFile>& file) {
    ChunkedArray array;
    array.folder = file->file.path().filename().string();
    array.bytes.stored = level.stored;
    array.bytes.swapped = level.swapped;
    array.bytes.values = level.values;
    array.bytes.fill = fitting_fill(level.fill, array.bytes);
    for (std::size_t a = 0; a < 3; ++a) {
        array.shape.push_back(level.shape[a]);
        array.chunk.push_back(level.chunk[a]);
        array.stored_axes.push_back(static_cast<int>(a));
    }
    for (const std::string& name : level.codecs) {
        const auto codec = codec_in_file(name);
        if (!codec) throw BadMetadata("its compression '" + name + "' is not known");
        array.codecs.push_back(*codec);
    }
    check_array(array);
    std::array<std::int64_t, 3> chunks{};
    for (std::size_t a = 0; a < 3; ++a) {
        chunks[a] = (array.shape[a] - 1) / array.chunk[a] + 1;
    }
    array.table = std::make_shared<ChunkTable>(file, level.id, chunks);
    return array;
}

std::shared_ptr<const Store> store_in(std::shared_ptr<const Objects> folder, io::ChunkFile in,
                                      const StoreOptions& options, const std::stop_token& stop) {
    const auto file = std::make_shared<LocatedFile>(std::move(in));
    const io::ChunkedImage image = file->file.describe(options.channel, options.time, stop);
    return about(file->file.path().string(), [&] {
        return chunked_store(std::move(folder), located_volume(image, file, options),
                             options.unpacking);
    });
}

}  // namespace

ChunkedVolume located_volume(const io::ChunkedImage& found,
                             const std::shared_ptr<LocatedFile>& file,
                             const StoreOptions& options) {
    ChunkedVolume volume;
    volume.info.address = file->file.path().string();
    volume.info.format = found.format;
    volume.info.channels = found.channels;
    volume.info.times = found.times;
    volume.info.frame_interval = found.frame_interval;
    volume.info.notes = found.notes;
    check_choice(volume.info, options);
    if (found.levels.empty()) throw BadMetadata("has no samples of that channel and time");
    Image image;
    image.axes = usual_axes(3);
    for (ImageAxis& axis : image.axes) axis.unit = found.unit;
    image.measured = found.measured;
    if (found.range && (*found.range)[0] <= (*found.range)[1]) {
        image.range = Range{(*found.range)[0], (*found.range)[1]};
    }
    for (const io::ImageArray& level : found.levels) {
        volume.arrays.push_back(located_array(level, file));
        image.levels.push_back({level.id,
                                {level.scale.begin(), level.scale.end()},
                                {level.translation.begin(), level.translation.end()}});
    }
    return volume_of(image, std::move(volume), options);
}

std::shared_ptr<const Store> open_located(const std::stop_token& stop, const std::string& path,
                                          const StoreOptions& options) {
    io::ChunkFile file{path};
    auto folder = folder_objects(file.path().parent_path());
    return store_in(std::move(folder), std::move(file), options, stop);
}

std::shared_ptr<const Store> open_located(const std::stop_token& stop,
                                          std::shared_ptr<const Objects> folder,
                                          const std::string& name, const StoreOptions& options) {
    const std::string address = folder->name_of(name);
    const auto size = folder->size_of(name);
    if (!size) {
        throw io::InputError(address + ": is not there, or the server does not tell its size");
    }
    // The first bytes are read each time: a file that was written anew is another one (the cache).
    (void)folder->get({.key = name, .range = ByteRange{0, std::min(*size, bytes_of_head)}}, stop);
    const auto read = [folder, name](std::uint64_t offset, std::uint64_t length,
                                     const std::stop_token& until) {
        auto part =
            folder->get({.key = name, .range = ByteRange{offset, length}, .lasting = true}, until);
        if (!part || part->size() != length) {
            throw io::InputError(folder->name_of(name) + ": is gone, or shorter than it was");
        }
        return *std::move(part);
    };
    return store_in(folder, io::ChunkFile(address, *size, read), options, stop);
}

}  // namespace palpate::stream

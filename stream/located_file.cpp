// Files of chunks that the helper process locates: HDF5 and tiled TIFF; see the header.
#include "stream/located_file.hpp"

#include "io/located_chunks.hpp"
#include "stream/chunk_table.hpp"
#include "stream/metadata_files.hpp"
#include "stream/stores.hpp"

namespace palpate::stream {
namespace {

ChunkedArray located_array(const io::ImageArray& level, const std::filesystem::path& file) {
    ChunkedArray array;
    array.folder = file.filename().string();
    array.bytes.stored = level.stored;
    array.bytes.swapped = level.swapped;
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

}  // namespace

ChunkedVolume located_volume(const io::ChunkedImage& found, const std::filesystem::path& file,
                             const StoreOptions& options) {
    ChunkedVolume volume;
    volume.info.address = file.string();
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

std::shared_ptr<const Store> open_located(const std::string& path, const StoreOptions& options) {
    const std::filesystem::path file(path);
    const io::ChunkedImage image = io::describe_image(file, options.channel, options.time);
    return about(path, [&] {
        return chunked_store(folder_objects(file.parent_path()),
                             located_volume(image, file, options));
    });
}

}  // namespace palpate::stream

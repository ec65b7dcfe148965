// Files of chunks that the helper process locates: HDF5 and tiled TIFF. See the header.
#include "stream/formats/located_file.hpp"

#include <algorithm>

#include "io/process/located_chunks.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/stores.hpp"

namespace palpate::stream {
namespace {

/// The first bytes of HDF5 and TIFF, which say where everything else lies.
constexpr std::uint64_t bytes_of_head = 64;
/// Chunks along each axis whose places are looked up together.
constexpr std::int64_t page_side = 16;
/// Its chunks are parts of one file: without it, they are not missing ones with the fill value.
constexpr const char* gone = ": is gone since it was opened; put it back, or open it again";

ChunkedArray located_array(const io::ImageArray& level, const std::shared_ptr<LocatedFile>& file) {
    ChunkedArray array;
    array.folder = file->key;
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
    array.shards = Shards{.chunks = std::vector<std::int64_t>(3, page_side),
                          .axes = array.stored_axes,
                          .index_codecs = {},
                          .file = file,
                          .id = level.id};
    check_array(array);
    return array;
}

/// The one file of a store, in its folder. Once opened, it must stay there and as it is: places
/// from an old file would give wrong samples of a new one.
class SteadyFile : public Objects {
  public:
    SteadyFile(std::shared_ptr<const Objects> folder, const std::string& name, std::uint64_t size,
               const std::stop_token& stop)
        : folder_(std::move(folder)) {
        // Read each time: a file that was written anew is another one (the cache).
        (void)folder_->get({.key = name,
                            .range = ByteRange{0, std::min(size, bytes_of_head)},
                            .identity = &identity_},
                           stop);
    }

    std::string name_of(const std::string& key) const override { return folder_->name_of(key); }
    std::optional<std::uint64_t> size_of(const std::string& key) const override {
        return folder_->size_of(key);
    }
    Traffic traffic() const override { return folder_->traffic(); }
    std::string note() const override { return folder_->note(); }

    std::optional<Bytes> get(const Wanted& wanted, std::stop_token stop) const override {
        std::string identity;
        Wanted same = wanted;
        same.identity = &identity;
        // Several servers behind one address may not agree on the identity.
        for (int attempt = 0; attempt < 3; ++attempt) {
            auto bytes = folder_->get(same, stop);
            if (!bytes) throw io::InputError(name_of(wanted.key) + gone);
            if (identity == identity_) return bytes;
            same.again = true;
        }
        throw io::InputError(name_of(wanted.key) +
                             ": was written anew since it was opened; open it again");
    }

  private:
    std::shared_ptr<const Objects> folder_;
    std::string identity_;
};

/// As much again as chunks may take while they are unpacked, up to 1 GiB.
std::uint64_t memory_of_helper(const StoreOptions& options) {
    return std::min(UnpackingRoom(options.unpacking).most(), std::uint64_t{1} << 30);
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

std::shared_ptr<const Store> open_located(const std::stop_token& stop,
                                          std::shared_ptr<const Objects> folder,
                                          const std::string& name, const StoreOptions& options) {
    const std::string address = folder->name_of(name);
    const auto size = folder->size_of(name);
    if (!size) {
        throw io::InputError(address + ": does not exist, or the server does not give its size");
    }
    folder = std::make_shared<SteadyFile>(std::move(folder), name, *size, stop);
    io::ChunkFile::Read read;  // none: the helper reads it here
    if (io::is_web_address(address)) {
        read = [folder, name](std::uint64_t offset, std::uint64_t length,
                              const std::stop_token& until) {
            auto part = folder->get(
                {.key = name, .range = ByteRange{offset, length}, .lasting = true}, until);
            if (part->size() != length) {
                throw io::InputError(folder->name_of(name) + ": is shorter than it was");
            }
            return *std::move(part);
        };
    }
    const auto file = std::make_shared<LocatedFile>(
        io::ChunkFile(address, *size, std::move(read), memory_of_helper(options)), name);
    const io::ChunkedImage image = file->file.describe(options.channel, options.time, stop);
    return about(address, [&] {
        return chunked_store(std::move(folder), located_volume(image, file, options),
                             options.unpacking);
    });
}

}  // namespace palpate::stream

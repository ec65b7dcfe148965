// A multiscale OME-Zarr image that grows chunk by chunk. See the header.
#include "palpate/stream/growing_image.hpp"

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "stream/box_bytes.hpp"
#include "stream/formats/stores.hpp"
#include "stream/writer/zarr_writer.hpp"

namespace palpate::stream {

struct GrowingImage::Parts {
    std::filesystem::path folder;
    SampleType type;
    ZarrWriter writer;
    mutable std::once_flag opening = {};
    mutable std::shared_ptr<const Store> store = nullptr;

    /// The image as it is read, opened when it is needed first.
    const Store& read() const {
        std::call_once(opening, [&] {
            store = open_zarr(folder_objects(folder), folder.string(), {});
            if (!store) fail_without(folder);
        });
        return *store;
    }
    const CoarserGrid& grid(int level) const {
        return writer.levels().at(static_cast<std::size_t>(level));
    }
};

GrowingImage::GrowingImage(std::filesystem::path folder, SampleType type, const Geometry& finest,
                           const ConvertOptions& options, std::string temporary) {
    check_format(options);
    ZarrWriter writer(folder, type, pyramid_of(finest, options.chunk), options,
                      std::move(temporary));
    parts_.reset(new Parts{std::move(folder), type, std::move(writer)});
}

GrowingImage::~GrowingImage() = default;

int GrowingImage::levels() const {
    return static_cast<int>(parts_->writer.levels().size());
}

const Geometry& GrowingImage::geometry(int level) const {
    return parts_->grid(level).geometry;
}

Index3 GrowingImage::chunks(int level) const {
    return parts_->writer.chunks_of(level);
}

SampleBox GrowingImage::box(int level, const Index3& chunk) const {
    return parts_->writer.box_of(level, chunk);
}

void GrowingImage::write_metadata(const std::optional<Range>& range) const {
    parts_->writer.write_metadata(range);
}

std::uint64_t GrowingImage::stored_chunks() const {
    return parts_->writer.stored_chunks();
}

bool GrowingImage::write(int level, const Index3& chunk, std::span<const std::byte> samples) const {
    const SampleBox part = box(level, chunk);
    if (part.empty() || samples.size() != bytes_of(part, parts_->type)) {
        throw std::invalid_argument("these are not the samples of this chunk");
    }
    return parts_->writer.write_chunk(level, chunk, samples);
}

std::optional<Bytes> GrowingImage::written(int level, const Index3& chunk) const {
    return parts_->writer.written_chunk(level, chunk);
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

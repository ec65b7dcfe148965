// Reads NRRD, MetaImage and NIfTI: their headers say all that it takes, so no library is needed.
#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {
namespace {

/// Picks the samples of one volume out of those of all, converts them and puts them into `to`.
class StepTaker {
  public:
    StepTaker(const VolumeHeader& header, int step, SampleType type, std::span<std::byte> to)
        : stored_(header.stored),
          values_(header.value_map),
          type_(type),
          together_(header.together),
          steps_(header.steps),
          step_(step),
          to_(to) {}

    void operator()(std::span<const std::byte> bytes) {
        const std::size_t sample = size_of(stored_);
        const std::int64_t first = seen_;
        seen_ += static_cast<std::int64_t>(bytes.size() / sample);
        for (std::int64_t at = first; at < seen_;) {
            const std::int64_t run = at / together_;
            const std::int64_t end = std::min(seen_, (run + 1) * together_);
            if (run % steps_ == step_) {
                const auto count = static_cast<std::size_t>(end - at);
                const auto offset = static_cast<std::size_t>(at - first) * sample;
                convert(stored_, bytes.data() + offset, type_, to_.data() + taken_, count, values_);
                taken_ += count * size_of(type_);
            }
            at = end;
        }
    }

  private:
    Stored stored_;
    ValueMap values_;
    SampleType type_;
    std::int64_t together_, steps_, step_;
    std::span<std::byte> to_;
    std::size_t taken_ = 0;  ///< bytes put into `to`
    std::int64_t seen_ = 0;  ///< samples of all volumes
};

Result read_with(VolumeHeader header, const Request& request) {
    say_doing(request.path.filename().string());
    Result result;
    result.geometry = header.geometry;
    result.type = kept_as(header.stored, header.value_map);
    result.values = header.values;
    note_conversion(header.stored, header.value_map, header.notes);
    take_step(request, header.steps, header.times, result);
    const auto samples = shared_samples(static_cast<std::size_t>(sample_count(result.geometry)) *
                                        size_of(result.type));
    StepTaker take(header, request.time_step, result.type, samples);
    stream_samples(header, std::ref(take));
    result.notes.insert(result.notes.begin(), header.notes.begin(), header.notes.end());
    finish(result, request, samples);
    return result;
}

PlainLayout samples_of(VolumeHeader header, const Request& request) {
    if (header.place.encoding != DataPlace::Encoding::raw) {
        throw OnlyWhole(
            "its samples are compressed or text, so they cannot be read piece by piece; save it "
            "uncompressed, or convert it to OME-Zarr");
    }
    if (header.steps > 1 &&
        header.together * header.steps != static_cast<std::int64_t>(header.samples())) {
        throw OnlyWhole(
            "the samples of its volumes are mixed, so they cannot be read piece by piece; save one "
            "volume of it");
    }
    check_raw_length(header);
    PlainLayout plain;
    plain.stored = header.stored;
    plain.value_map = header.value_map;
    plain.place = header.place;
    plain.place.offset += header.place.skip;
    plain.about.geometry = header.geometry;
    plain.about.time_steps = static_cast<int>(header.steps);
    plain.about.times = header.times;
    plain.about.values = header.values;
    plain.about.notes = header.notes;
    put_in(request.grid, plain.about.geometry);
    check_geometry(plain.about.geometry);
    plain.about.geometry = orthonormal(plain.about.geometry);
    return plain;
}

}  // namespace

PlainLayout nrrd_samples(const Request& request) {
    PlainLayout plain = samples_of(nrrd_header(request), request);
    plain.about.format = "NRRD";
    return plain;
}

PlainLayout meta_image_samples(const Request& request) {
    PlainLayout plain = samples_of(meta_image_header(request), request);
    plain.about.format = "MetaImage";
    return plain;
}

PlainLayout nifti_samples(const Request& request) {
    PlainLayout plain = samples_of(nifti_header(request), request);
    plain.about.format = "NIfTI";
    return plain;
}

Result read_nrrd(const Request& request) {
    Result result = read_with(nrrd_header(request), request);
    result.format = "NRRD";
    return result;
}

Result read_meta_image(const Request& request) {
    Result result = read_with(meta_image_header(request), request);
    result.format = "MetaImage";
    return result;
}

Result read_nifti(const Request& request) {
    Result result = read_with(nifti_header(request), request);
    result.format = "NIfTI";
    return result;
}

}  // namespace palpate::io

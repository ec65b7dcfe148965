// Reads NRRD, MetaImage, NIfTI, MGH, MRC and VTK's older format: their headers say all that it
// takes, so that no library is needed.
#include <functional>
#include <string_view>

#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"
#include "io/web_page.hpp"

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

/// Throws Failure for a file that is something else than its name says, by its first bytes or, if
/// it is packed, by those of what is in it.
void check_kind(const std::filesystem::path& file) {
    struct Kind {
        std::string_view begin, what;
    };
    constexpr Kind kinds[] = {
        {"\x1f\x8b", "is packed twice; unpack it once"},
        {"BZh", "is packed with bzip2; unpack it and give what is in it"},
        {"\xfd"
         "7zXZ",
         "is packed with xz; unpack it and give what is in it"},
        {"\x28\xb5\x2f\xfd", "is packed with zstd; unpack it and give what is in it"},
        {"PK\3\4", "is packed with zip; unpack it and give what is in it"}};
    const auto start = start_of(file, web_page_start);
    const std::string text(reinterpret_cast<const char*>(start.data()), start.size());
    for (const auto& [begin, what] : kinds) {
        if (text.starts_with(begin)) throw Failure(std::string(what));
    }
    if (is_web_page(text)) throw Failure(web_page_message);
}

VolumeHeader header_of(const Request& request) {
    try {
        return header_reader(request.path)(request);
    } catch (const Failure&) {
        check_kind(request.path);
        throw;
    }
}

}  // namespace

Result read_by_header(const Request& request) {
    say_doing(request.path.filename().string());
    VolumeHeader header = header_of(request);
    Result result;
    result.format = header.format;
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

VolumeHeader locate_by_header(const Request& request) {
    VolumeHeader header = header_of(request);
    if (header.places.size() > 1) {
        throw OnlyWhole(
            "its samples are spread over several files, so they cannot be read piece by piece; "
            "convert it to OME-Zarr");
    }
    DataPlace& place = header.places.front();
    if (place.encoding != DataPlace::Encoding::raw) {
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
    place.offset += place.skip;
    settle_geometry(request.grid, header.geometry, header.notes);
    header.geometry = orthonormal(header.geometry);
    return header;
}

}  // namespace palpate::io

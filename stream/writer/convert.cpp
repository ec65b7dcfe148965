// Writes a level of a store as multiscale OME-Zarr. See the header.
#include "palpate/stream/convert.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>

#include "io/file_grid.hpp"
#include "io/path_json.hpp"
#include "io/system/growing_folder.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "palpate/stream/growing_image.hpp"
#include "stream/at_once.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/content.hpp"
#include "stream/formats/edited_store.hpp"
#include "stream/loader/blocks.hpp"
#include "stream/objects/objects.hpp"
#include "stream/while_telling.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

/// The content covers the source and everything that says how it is read (raw layout, spacing,
/// series, filters).
nlohmann::json source_of(const Store& from, int level, const std::stop_token& stop) {
    nlohmann::json source = {{"content", content_of(from, level, stop)}};
    // Of what is not read whole, files that were written anew show what its samples may not.
    if (from.info().format == "memory") return source;
    source["files"] = files_at(from.info().address, stop);
    if (const auto* edits = dynamic_cast<const EditedStore*>(&from)) {
        source["original"] = files_at(edits->note().of.address, stop);
    }
    return source;
}

/// All that decides what is written: a run is continued by one of the same job only.
nlohmann::json job_of(const Store& from, int level, const ConvertOptions& options,
                      nlohmann::json source) {
    nlohmann::json job = {{"version", 2},  // of what is computed and how it is written
                          {"source", io::json_of_path(io::address_to_keep(from.info().address))},
                          {"level", level},
                          {"zarr", options.zarr_version},
                          {"chunk", options.chunk},
                          {"compression", static_cast<int>(options.compression)}};
    job.update(source);
    return job;
}

/// Least and greatest sample that several threads have seen.
class SeenRange {
  public:
    void take(SampleType type, std::span<const std::byte> samples) {
        with_type(type, [&](auto zero) {
            using T = decltype(zero);
            T low = std::numeric_limits<T>::max(), high = std::numeric_limits<T>::lowest();
            for (std::size_t at = 0; at < samples.size(); at += sizeof(T)) {
                T value;
                std::memcpy(&value, samples.data() + at, sizeof value);
                low = std::min(low, value);
                high = std::max(high, value);
            }
            const std::lock_guard lock(mutex_);
            range_.minimum = std::min(range_.minimum, static_cast<double>(low));
            range_.maximum = std::max(range_.maximum, static_cast<double>(high));
        });
    }
    Range range() const { return range_; }

  private:
    std::mutex mutex_;
    Range range_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

/// [bytes] Of pieces of the source, once they are unpacked.
constexpr std::uint64_t most_kept = std::uint64_t{128} << 20;

class Conversion {
  public:
    Conversion(const Store& from, int level, const ConvertOptions& options,
               const io::GrowingFolder& partial)
        : from_(from),
          level_(level),
          options_(options),
          partial_(partial),
          image_(partial.result(), from.info().type, level_of(from, level).geometry, options),
          pieces_(from, most_kept, loader_for({}, 1), For::eyes) {
        for (int l = 0; l < image_.levels(); ++l) total_ += chunks(l);
    }

    Converted run() {
        partial_.check();  // that the image holds the same folder
        image_.write_metadata({});
        while_telling(options_.progress, [&](const std::stop_token& stop, auto& made) {
            std::atomic<std::int64_t> done = 0;
            for (int l = 0; l < image_.levels(); ++l) {
                for_all_at_once(std::size_t(chunks(l)), options_.threads, stop,
                                [&](std::size_t i, const auto& until) {
                                    convert(l, std::int64_t(i), until);
                                    made = double(++done) / double(total_);
                                });
            }
        });
        if (image_.stored_chunks() + empty_ != static_cast<std::uint64_t>(total_)) {
            throw io::OutputError(partial_.result().string() +
                                  ": chunks were removed while it was written; run it again");
        }
        image_.write_metadata(seen_.range());
        return {image_.levels(), static_cast<std::uint64_t>(total_), kept_, empty_, seen_.range()};
    }

  private:
    std::int64_t chunks(int level) const {
        return image_.chunks(level).cast<std::int64_t>().prod();
    }
    void convert(int level, std::int64_t number, const std::stop_token& stop) {
        const Index3 count = image_.chunks(level);
        const Index3 chunk(static_cast<int>(number % count[0]),
                           static_cast<int>(number / count[0] % count[1]),
                           static_cast<int>(number / count[0] / count[1]));
        auto samples = image_.written(level, chunk);
        if (samples) {
            ++kept_;
        } else {
            samples =
                level == 0 ? read(image_.box(0, chunk), stop) : image_.means(level, chunk, stop);
            if (!image_.write(level, chunk, *samples)) ++empty_;
        }
        if (level == 0) seen_.take(from_.info().type, *samples);
    }

    Bytes read(const SampleBox& box, const std::stop_token& stop) {
        Bytes samples(bytes_of(box, from_.info().type));
        if (from_.info().format == "memory") {
            from_.read(level_, box, samples, stop);
        } else {
            pieces_.read(level_, box, box, samples, stop);
        }
        return samples;
    }

    const Store& from_;
    int level_;
    const ConvertOptions& options_;
    const io::GrowingFolder& partial_;
    GrowingImage image_;
    Blocks pieces_;  // a chunk of the source may be larger than one of the image
    SeenRange seen_;
    std::int64_t total_ = 0;
    std::atomic<std::uint64_t> kept_ = 0, empty_ = 0;
};

}  // namespace

void check_zarr_place(const fs::path& out) {
    io::check_new_folder(out);
}

Converted convert_to_zarr(const Store& from, int level, const fs::path& out,
                          const ConvertOptions& options) {
    check_format(options);
    if (options.threads < 1 || options.threads > 256) {
        throw std::invalid_argument("there are 1 to 256 threads");
    }
    check_zarr_place(out);
    if (const std::string why = io::why_not_stored(level_of(from, level).geometry); !why.empty()) {
        throw io::OutputError(out.string() + ": " + why);
    }
    const auto source = [&](const std::stop_token& stop) { return source_of(from, level, stop); };
    const nlohmann::json before = while_telling(options.progress, source);
    io::GrowingFolder folder =
        options.resumable
            ? io::GrowingFolder::resumable(out, job_of(from, level, options, before).dump(1))
            : io::GrowingFolder::alone(out);
    Converted converted = Conversion(from, level, options, folder).run();
    io::Progress at_end;
    if (options.progress) at_end = [&](double) { options.progress(1); };
    const nlohmann::json after = while_telling(at_end, source);
    if (after["content"] != before["content"]) fail_changed(from);
    folder.put_in_place();
    converted.note = folder.note();
    if (after != before) {
        converted.note += (converted.note.empty() ? "" : "; ") + from.info().address +
                          ": was touched while it was converted: if its samples were changed then, "
                          "convert it again";
    }
    return converted;
}

}  // namespace palpate::stream

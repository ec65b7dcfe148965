// Writes a level of a store as multiscale OME-Zarr; see the header.
#include "palpate/stream/convert.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "io/helper_process.hpp"
#include "palpate/io/error.hpp"
#include "palpate/stream/growing_image.hpp"
#include "stream/stores.hpp"
#include "stream/zarr_writer.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

/// Calls work(i, stop) for i from 0 to below `count`, on several threads, and `tell` with how many
/// are done, on this one. The first exception, of either, stops all and is thrown.
template <class Work, class Tell>
void in_parallel(std::int64_t count, int threads, Work&& work, Tell&& tell) {
    std::atomic<std::int64_t> next = 0, done = 0;
    std::mutex mutex;
    std::condition_variable changed;
    std::exception_ptr failure;
    int running = threads;
    {
        std::stop_source stop;
        std::vector<std::jthread> team;
        const auto one = [&] {
            try {
                for (std::int64_t i = next++; i < count && !stop.stop_requested(); i = next++) {
                    work(i, stop.get_token());
                    ++done;
                }
            } catch (const Cancelled&) {
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
                stop.request_stop();
            }
            const std::lock_guard lock(mutex);
            --running;
            changed.notify_one();
        };
        for (int t = 0; t < threads; ++t) team.emplace_back(one);
        constexpr auto between = std::chrono::milliseconds(50);
        std::unique_lock lock(mutex);
        while (!changed.wait_for(lock, between, [&] { return running == 0; })) {
            lock.unlock();
            try {
                tell(done.load());
            } catch (...) {
                stop.request_stop();
                lock.lock();
                failure = std::current_exception();
                lock.unlock();
            }
            lock.lock();
            if (stop.stop_requested()) changed.wait(lock, [&] { return running == 0; });
        }
    }
    if (failure) std::rethrow_exception(failure);
}

/// The folder in which the image grows. Its note says of what and how, so that only the same work
/// is continued.
class Partial {
  public:
    Partial(const fs::path& out, const nlohmann::json& job)
        : out_(out), folder_(out.string() + ".partial"), note_(folder_ / "palpate-convert.json") {
        std::error_code error;
        if (fs::exists(fs::symlink_status(out, error))) {
            throw io::OutputError(out.string() +
                                  ": is there already; remove it or give another name");
        }
        fs::create_directory(folder_, error);
        if (error) {
            throw io::OutputError(folder_.string() + ": " + error.message() +
                                  "; choose another folder");
        }
        lock_ = ::open(folder_.c_str(), O_RDONLY | O_CLOEXEC | O_DIRECTORY);
        if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            ::close(lock_);
            throw io::OutputError(folder_.string() +
                                  ": another process is writing it; wait for that");
        }
        std::ifstream in(note_);
        const std::string before((std::istreambuf_iterator<char>(in)), {});
        const std::string text = job.dump(1);
        if (before == text) return;
        for (const auto& entry : fs::directory_iterator(folder_))
            fs::remove_all(entry.path(), error);
        put_file(note_, std::as_bytes(std::span(text)));
    }
    ~Partial() {
        if (lock_ >= 0) ::close(lock_);
    }
    Partial(const Partial&) = delete;
    Partial& operator=(const Partial&) = delete;

    const fs::path& folder() const { return folder_; }

    void finish() const {
        std::error_code error;
        fs::remove(note_, error);
        if (lock_ >= 0) ::syncfs(lock_);
        fs::rename(folder_, out_, error);
        if (error) throw io::OutputError(out_.string() + ": " + error.message());
    }

  private:
    fs::path out_, folder_, note_;
    int lock_ = -1;
};

/// Size, spacing, origin and direction, one after the other.
std::vector<double> grid_numbers(const Geometry& grid) {
    std::vector<double> numbers;
    for (const int size : grid.size) numbers.push_back(size);
    for (const double spacing : grid.spacing) numbers.push_back(spacing);
    for (const double origin : grid.origin) numbers.push_back(origin);
    for (const double part : grid.direction.reshaped()) numbers.push_back(part);
    return numbers;
}

/// What a run has to have in common with the one that it continues.
nlohmann::json job_of(const Store& from, int level, const ConvertOptions& options) {
    const StoreInfo& info = from.info();
    nlohmann::json job = {
        {"source", info.address},
        {"format", info.format},
        {"level", level},
        {"channel", info.channel},
        {"time", info.time},
        {"grid", grid_numbers(info.levels.at(static_cast<std::size_t>(level)).geometry)},
        {"type", name_of(info.type)},
        {"zarr", options.zarr_version},
        {"chunk", options.chunk},
        {"compression", static_cast<int>(options.compression)}};
    std::error_code error;
    if (fs::is_regular_file(info.address, error)) {
        job["bytes"] = fs::file_size(info.address, error);
        job["changed"] = fs::last_write_time(info.address, error).time_since_epoch().count();
    }
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

class Conversion {
  public:
    Conversion(const Store& from, int level, const ConvertOptions& options, const Partial& partial)
        : from_(from),
          level_(level),
          options_(options),
          image_(partial.folder(), from.info().type,
                 from.info().levels.at(static_cast<std::size_t>(level)).geometry, options) {
        for (int l = 0; l < image_.levels(); ++l) total_ += chunks(l);
    }

    Converted run() {
        image_.write_metadata({});
        std::int64_t before = 0;
        for (int l = 0; l < image_.levels(); ++l) {
            in_parallel(
                chunks(l), options_.threads,
                [&](std::int64_t i, const std::stop_token& stop) { convert(l, i, stop); },
                [&](std::int64_t done) { tell(before + done); });
            before += chunks(l);
        }
        tell(total_);
        image_.write_metadata(seen_.range());
        return {image_.levels(), static_cast<std::uint64_t>(total_), kept_, empty_, seen_.range()};
    }

  private:
    std::int64_t chunks(int level) const {
        return image_.chunks(level).cast<std::int64_t>().prod();
    }
    void tell(std::int64_t done) const {
        if (options_.progress) {
            options_.progress(static_cast<double>(done) / static_cast<double>(total_));
        }
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

    Bytes read(const SampleBox& box, const std::stop_token& stop) const {
        const Index3 size = box.high - box.low + Index3::Ones();
        Bytes samples(static_cast<std::size_t>(size.cast<std::int64_t>().prod()) *
                      size_of(from_.info().type));
        from_.read(level_, box, samples, stop);
        return samples;
    }

    const Store& from_;
    int level_;
    const ConvertOptions& options_;
    GrowingImage image_;
    SeenRange seen_;
    std::int64_t total_ = 0;
    std::atomic<std::uint64_t> kept_ = 0, empty_ = 0;
};

}  // namespace

Converted convert_to_zarr(const Store& from, int level, const fs::path& out,
                          const ConvertOptions& options) {
    check_format(options);
    if (options.threads < 1 || options.threads > 256) {
        throw std::invalid_argument("there are 1 to 256 threads");
    }
    const Partial partial(out, job_of(from, level, options));
    const Converted converted = Conversion(from, level, options, partial).run();
    partial.finish();
    return converted;
}

}  // namespace palpate::stream

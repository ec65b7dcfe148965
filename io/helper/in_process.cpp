// Runs our own readers in this process. See the header.
#include "io/helper/in_process.hpp"

#include <new>

#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

/// Data that the readers share with their caller. Elsewhere, a process separates the two.
struct Reading {
    std::shared_ptr<std::byte> samples;
    Progress progress;
};
thread_local Reading reading;

}  // namespace

std::span<std::byte> shared_samples(std::uint64_t bytes) {
    reading.samples = fresh_memory(static_cast<std::size_t>(bytes));
    return {reading.samples.get(), static_cast<std::size_t>(bytes)};
}

void say_progress(double fraction) {
    if (reading.progress) reading.progress(fraction);
}

void say_doing(const std::string&) {}

VolumeFile read_in_process(const Request& request, const Progress& progress,
                           const std::function<Result(const Request&)>& read) {
    const struct Forgetting {
        ~Forgetting() { reading = {}; }
    } forgetting;  // also where progress or `read` throw what is theirs
    reading = {nullptr, progress};
    const auto error = [&](const std::string& problem) {
        return InputError(request.path.string() + ": " + problem);
    };
    try {
        Result result = read(request);
        const auto bytes =
            static_cast<std::size_t>(sample_count(result.geometry)) * size_of(result.type);
        return {Volume(result.geometry, result.type, reading.samples, bytes),
                result.format,
                result.time_steps,
                std::move(result.notes),
                result.times.interval,
                result.times.first,
                result.values};
    } catch (const Failure& e) {
        throw error(e.what());
    } catch (const std::bad_alloc&) {
        throw error("not enough memory; crop or downsample the volume");
    }
}

}  // namespace palpate::io

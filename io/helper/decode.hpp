// Shared by the readers in the helper program: the request, the result, and the conversion of
// samples of any type into the memory that the caller adopts. Needs no format's library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/stored.hpp"
#include "io/words.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/io/series.hpp"
#include "palpate/io/value_info.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

/// Ends the job. what() says in one line what is wrong and what to do; the caller adds the file's
/// name.
class Failure : public std::runtime_error {
  public:
    explicit Failure(const std::string& what) : std::runtime_error(one_line(what)) {}
};

/// The samples are there, but cannot be read from where they lie by the box.
class OnlyWhole : public Failure {
  public:
    using Failure::Failure;
};

/// A series has to be chosen.
class ChooseSeries : public Failure {
  public:
    ChooseSeries(const std::string& what, std::vector<SeriesInfo> all)
        : Failure(what), series(std::move(all)) {}
    std::vector<SeriesInfo> series;
};

struct Request {
    std::filesystem::path path;
    std::string series;
    bool pictures = false;  ///< of the series, if one has to be chosen
    int time_step = 0;
    std::uint64_t memory_limit = UINT64_MAX;  ///< [bytes]
    GivenGrid grid;                           ///< instead of the file's
};

/// When the volumes of a 4-D file were taken.
struct FrameTimes {
    double interval = 0;  ///< [s] from one to the next; 0: the file does not say
    double first = 0;     ///< [s]
};
/// Times as a header gives them, in seconds: `unit` is "s", "ms", "us", "min" or one of their
/// longer names; an empty one means seconds, with a note; any other means that no time is given. An
/// interval that is not finite or not above 0 counts as unknown.
FrameTimes frame_times(double interval, double first, const std::string& unit,
                       std::vector<std::string>& notes);

/// The length of a unit [mm], with a note unless it is mm: lengths are converted, those of unknown
/// units taken as mm. No unit is mm.
double length_unit(const std::string& unit, std::vector<std::string>& notes);

struct Result {
    std::string format;
    Geometry geometry;
    SampleType type = SampleType::uint8;
    int time_steps = 1;
    std::vector<std::string> notes;
    FrameTimes times;
    ValueInfo values;
};

/// Least and greatest of some samples (NaN left out; +inf, -inf if there are none).
std::pair<double, double> range_of(Stored stored, std::span<const std::byte> samples);

/// The memory that the caller adopts, sized and mapped. Throws Failure if there is not enough.
/// May be called again with another size: only the last one counts.
std::span<std::byte> shared_samples(std::uint64_t bytes);
/// The same, null if there is not enough.
void* memory_of_caller(std::uint64_t bytes);

/// Bytes of a grid, checked before anything is allocated: no size below 1 or above 2^20, the whole
/// within the limit. `file_bytes` is what holds it; no compression packs better than 1100 : 1.
std::uint64_t checked_bytes(std::span<const std::int64_t> sizes, std::size_t bytes_per_sample,
                            std::uint64_t file_bytes, const Request& request);

/// Which volume of a 4-D file; throws Failure that says how many there are.
int checked_time_step(const Request& request, std::int64_t steps);
/// The same for a format with times: enters the step, the times and a note into the result.
void take_step(const Request& request, std::int64_t steps, const FrameTimes& times, Result& result);

/// Refuses a spacing that files may not have (io/file_grid.hpp). `where` names what gave it.
void check_spacing(double spacing, const std::string& where);
/// Refuses a coordinate that is not finite or too far from 0.
void check_coordinate(double coordinate, const std::string& where);
/// All of a grid: check() and these two. Throws Failure.
void check_geometry(const Geometry& geometry);
/// Puts in what is given instead of the file's grid, straightens the grid with a note, and checks
/// it. Throws Failure.
void settle_geometry(const GivenGrid& given, Geometry& geometry, std::vector<std::string>& notes);

/// Lets this process allocate so many bytes more than it has (and 64 MiB) until the next bound, so
/// that a library that asks for much more than a file needs gets std::bad_alloc. What is shared
/// with the caller does not count. Returns the bound before it. Does nothing under a sanitizer.
std::uint64_t bound_memory(std::uint64_t more);

/// The same while it lives.
class MemoryBound {
  public:
    explicit MemoryBound(std::uint64_t more) : before_(bound_memory(more)) {}
    ~MemoryBound();
    MemoryBound(const MemoryBound&) = delete;
    MemoryBound& operator=(const MemoryBound&) = delete;

  private:
    std::uint64_t before_;
};

/// Geometry and finite samples; the requested spacing is put in. Throws Failure.
void finish(Result& result, const Request& request, std::span<std::byte> samples);

/// Reports progress to the caller, and the current file (for the message in case of a crash).
void say_progress(double fraction);
void say_doing(const std::string& what);

/// "301x324x56"
std::string text_of(std::span<const std::int64_t> sizes);
/// A file's name without its folder, in quotes.
std::string quoted(const std::filesystem::path& file);

}  // namespace palpate::io

// Shared by the readers in the helper program. See the header.
#include "io/helper/decode.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "io/file_grid.hpp"
#include "io/finite.hpp"
#include "io/straightened.hpp"
#include "io/units.hpp"

namespace palpate::io {
namespace {

std::string gigabytes(double bytes) {
    return text_of(bytes / 1e9) + " GB";
}

}  // namespace

std::pair<double, double> range_of(Stored stored, std::span<const std::byte> samples) {
    return with_stored(stored, [&](auto type) {
        using T = decltype(type);
        std::pair<double, double> range{std::numeric_limits<double>::infinity(),
                                        -std::numeric_limits<double>::infinity()};
        for (std::size_t at = 0; at + sizeof(T) <= samples.size(); at += sizeof(T)) {
            T value;
            std::memcpy(&value, samples.data() + at, sizeof value);
            const auto number = static_cast<double>(value);
            range.first = number < range.first ? number : range.first;
            range.second = number > range.second ? number : range.second;
        }
        return range;
    });
}

std::uint64_t checked_bytes(std::span<const std::int64_t> sizes, std::size_t bytes_per_sample,
                            std::uint64_t file_bytes, const Request& request) {
    double bytes = static_cast<double>(bytes_per_sample);
    for (const std::int64_t s : sizes) {
        if (s < 1 || s > 1 << 20) {
            throw Failure("its header gives the size " + text_of(sizes) +
                          ", which is not possible; the header is damaged");
        }
        bytes *= static_cast<double>(s);
    }
    if (bytes > 1100.0 * static_cast<double>(file_bytes) + 1e6) {
        throw Failure("its header says " + text_of(sizes) + " samples (" + gigabytes(bytes) +
                      "), the file has only " + std::to_string(file_bytes) +
                      " bytes; it is cut off or its header is damaged: copy it again");
    }
    if (bytes > static_cast<double>(request.memory_limit)) {
        throw Failure("its " + text_of(sizes) + " samples need " + gigabytes(bytes) +
                      " of memory, the limit is " +
                      gigabytes(static_cast<double>(request.memory_limit)) +
                      "; allow more memory, or crop or downsample it");
    }
    return static_cast<std::uint64_t>(bytes);
}

int checked_time_step(const Request& request, std::int64_t steps) {
    if (request.time_step < 0 || request.time_step >= steps) {
        throw Failure("there is no time step " + std::to_string(request.time_step) + ": it has " +
                      std::to_string(steps) +
                      (steps == 1 ? ", number 0" : ", numbered from 0; choose one of them"));
    }
    return request.time_step;
}

void take_step(const Request& request, std::int64_t steps, const FrameTimes& times,
               Result& result) {
    const int step = checked_time_step(request, steps);
    result.time_steps = static_cast<int>(steps);
    if (steps == 1) return;
    result.times = times;
    result.notes.push_back("time step " + std::to_string(step) + " of " + std::to_string(steps) +
                           " (0 to " + std::to_string(steps - 1) + ") was taken");
}

void check_spacing(double spacing, const std::string& where) {
    if (is_file_spacing(spacing)) return;
    throw Failure("its " + where + " gives a spacing of " + text_of(spacing) +
                  " mm; correct it, spacings are above 0 (1e-9 to 1e9 mm)");
}

void check_coordinate(double coordinate, const std::string& where) {
    if (is_file_position(coordinate)) return;
    throw Failure("its " + where + " gives a position of " + text_of(coordinate) +
                  " mm; correct it, positions are within 1e9 mm of the origin");
}

void check_geometry(const Geometry& geometry) {
    try {
        check(geometry);
    } catch (const std::invalid_argument& e) {
        throw Failure(e.what());
    }
    for (int i = 0; i < 3; ++i) {
        check_spacing(geometry.spacing[i], "grid");
        check_coordinate(geometry.origin[i], "grid");
    }
}

void settle_geometry(const GivenGrid& given, Geometry& geometry, std::vector<std::string>& notes) {
    put_in(given, geometry);
    if (const auto nearest = straightened(geometry); nearest && nearest->is_changed) {
        notes.push_back(
            nearest->is_sheared
                ? "its axes are not quite at right angles: the nearest grid with right angles was "
                  "taken, whose samples lie up to " +
                      text_of(nearest->moved) + " mm from the file's"
                : "the vectors of its axes are not quite of length 1: they were taken as "
                  "directions only, and the spacing is as it is given");
        geometry = nearest->grid;
    }
    check_geometry(geometry);
}

void finish(Result& result, const Request& request, std::span<std::byte> samples) {
    settle_geometry(request.grid, result.geometry, result.notes);
    if (result.type != SampleType::float32) return;
    const std::span<float> floats{reinterpret_cast<float*>(samples.data()),
                                  samples.size() / sizeof(float)};
    const auto count = replace_non_finite(floats);
    if (count == floats.size()) {
        throw Failure("none of its samples is finite as float32; export it again");
    }
    if (count > 0) result.notes.push_back(non_finite_note(count));
}

FrameTimes frame_times(double interval, double first, const std::string& unit,
                       std::vector<std::string>& notes) {
    const auto second = unit.empty() ? std::optional(1.0) : seconds_in(unit);
    if (!second || !(std::isfinite(interval) && interval > 0)) return {};
    if (unit.empty()) notes.push_back("its header gives no unit of time: seconds were taken");
    return {interval * *second, std::isfinite(first) ? first * *second : 0};
}

double length_unit(const std::string& unit, std::vector<std::string>& notes) {
    if (unit.empty()) return 1;
    const auto length = millimetres_in(unit);
    if (!length) {
        add_note(notes,
                 "its unit of length '" + unit.substr(0, 40) + "' is not known: mm were taken");
    } else if (*length != 1) {
        add_note(notes, "its lengths are in " + unit + ": they were converted to mm");
    }
    return length.value_or(1);
}

std::string text_of(std::span<const std::int64_t> sizes) {
    std::string text;
    for (const auto s : sizes) {
        if (!text.empty()) text += 'x';
        text += std::to_string(s);
    }
    return text;
}

std::string quoted(const std::filesystem::path& file) {
    std::string text = "'";
    text += file.filename().string();
    text += '\'';
    return text;
}

}  // namespace palpate::io

// Finds the frames of a sequence, which are files or volumes of a file, and their times.
#include "palpate/io/sequence.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "io/named_files.hpp"
#include "io/system/number.hpp"
#include "io/system/own_names.hpp"
#include "io/words.hpp"
#include "palpate/io/output.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

std::string exact_text(double number) {
    std::string text;
    append_number(text, number);
    return text;
}

std::string text_of(const Vec3& v) {
    return exact_text(v[0]) + ", " + exact_text(v[1]) + ", " + exact_text(v[2]);
}

std::string text_of(const Index3& size) {
    return std::to_string(size[0]) + "x" + std::to_string(size[1]) + "x" + std::to_string(size[2]);
}

void check_interval(double interval) {
    if (!(std::isfinite(interval) && interval > 0 && interval <= 1e6)) {
        throw std::invalid_argument("an interval of " + exact_text(interval) +
                                    " s between frames makes no sense; give seconds above 0");
    }
}

/// A file name with a number in it: the text before and after, and the number of digits.
struct Pattern {
    std::string before, after;
    std::size_t digits = 0;  ///< at least; 0: any, leading zeros too
};

/// The pattern of a file name with one %d or %03d (%% is a %); nothing if it has none. Throws
/// InputError, with the path before it, for a % that is something else.
std::optional<Pattern> pattern_of(const fs::path& path) {
    const std::string name = path.filename().string();
    Pattern pattern;
    std::string* part = &pattern.before;
    for (std::size_t at = 0; at < name.size(); ++at) {
        if (name[at] != '%') {
            *part += name[at];
            continue;
        }
        if (name.compare(at, 2, "%%") == 0) {
            *part += name[at++];
            continue;
        }
        std::size_t end = at + 1;
        while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
        const std::string width = name.substr(at + 1, end - at - 1);
        const bool plain = width.empty();
        const bool padded = width.size() >= 2 && width.size() <= 3 && width[0] == '0';
        if (end == name.size() || name[end] != 'd' || !(plain || padded) ||
            part == &pattern.after) {
            throw InputError(path.string() +
                             ": a series is named with one %d, or %03d for three digits, in place "
                             "of the number (%% is a %)");
        }
        if (padded) pattern.digits = number_from<std::size_t>(width).value();
        part = &pattern.after;
        at = end;
    }
    if (part == &pattern.before) return std::nullopt;
    return pattern;
}

/// The number in a file name that the pattern fits.
std::optional<std::int64_t> number_in(const std::string& name, const Pattern& pattern) {
    const std::size_t around = pattern.before.size() + pattern.after.size();
    if (name.size() <= around || !name.starts_with(pattern.before) ||
        !name.ends_with(pattern.after)) {
        return std::nullopt;
    }
    const std::string digits = name.substr(pattern.before.size(), name.size() - around);
    if (digits.find_first_not_of("0123456789") != std::string::npos || digits.size() > 15) {
        return std::nullopt;
    }
    const bool as_printed =
        digits.size() == pattern.digits || (digits.size() > pattern.digits && digits[0] != '0');
    if (pattern.digits > 0 && !as_printed) return std::nullopt;
    return number_from<std::int64_t>(digits);
}

struct NumberedFile {
    std::int64_t number;
    fs::path path;
};

std::vector<NumberedFile> files_of(const fs::path& path, const Pattern& pattern) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::error_code error;
    std::vector<NumberedFile> files;
    fs::directory_iterator at(folder, error);
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        const auto number = number_in(at->path().filename().string(), pattern);
        if (number) files.push_back({*number, path.parent_path() / at->path().filename()});
    }
    if (error) {
        throw InputError(path.string() + ": its folder cannot be read (" + error.message() +
                         "); check the name");
    }
    if (files.empty()) {
        throw InputError(path.string() +
                         ": no file has such a name; check the name, a %d stands "
                         "for the number");
    }
    std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
        return a.number < b.number || (a.number == b.number && a.path < b.path);
    });
    for (std::size_t i = 1; i < files.size(); ++i) {
        if (files[i].number == files[i - 1].number) {
            throw InputError(path.string() + ": " + files[i - 1].path.filename().string() +
                             " and " + files[i].path.filename().string() +
                             " have the same number; say how many digits it has, as in %03d");
        }
    }
    return files;
}

/// Frame i's place in time, counted in intervals; says which numbers are missing.
std::vector<double> places_of(const std::vector<NumberedFile>& files,
                              std::vector<std::string>& notes) {
    std::int64_t step = 1;
    for (std::size_t i = 1; i < files.size(); ++i) {
        const std::int64_t gap = files[i].number - files[i - 1].number;
        step = i == 1 ? gap : std::min(step, gap);
    }
    std::vector<double> places;
    std::string gaps;
    int gap_count = 0;
    for (std::size_t i = 0; i < files.size(); ++i) {
        places.push_back(static_cast<double>(files[i].number - files[0].number) /
                         static_cast<double>(step));
        if (i == 0 || files[i].number - files[i - 1].number <= step) continue;
        if (++gap_count > 5) continue;
        if (!gaps.empty()) gaps += ", ";
        gaps += "between " + std::to_string(files[i - 1].number) + " and " +
                std::to_string(files[i].number);
    }
    if (gap_count > 5) gaps += " and in " + std::to_string(gap_count - 5) + " more places";
    if (gap_count > 0) {
        notes.push_back("files of the series are missing " + gaps +
                        ": the field goes evenly from the one to the other");
    }
    return places;
}

/// [s]; the one asked for, else the file's, else the default.
double interval_of(double asked, const VolumeFile& file, std::vector<std::string>& notes) {
    if (asked > 0) return asked;
    if (file.frame_interval >= 1e-6 && file.frame_interval <= 1e6) return file.frame_interval;
    notes.push_back("nothing says how much time lies between two frames: " +
                    exact_text(assumed_frame_interval) + " s was taken");
    return assumed_frame_interval;
}

SequenceFile opened(VolumeFile file, const std::vector<double>& places, double first_time,
                    double interval, std::vector<std::string> notes) {
    SequenceFile result{
        {}, file.volume, std::move(file.format), std::move(file.notes), std::move(file.values)};
    std::erase_if(result.notes,
                  [](const std::string& note) { return note.starts_with("time step "); });
    std::move(notes.begin(), notes.end(), std::back_inserter(result.notes));
    if (places.size() > 1) interval = interval_of(interval, file, result.notes);
    if (interval == 0) interval = assumed_frame_interval;
    Sequence& sequence = result.sequence;
    for (const double place : places) sequence.times.push_back(first_time + place * interval);
    sequence.period = (places.back() + 1) * interval;
    sequence.geometry = result.first.geometry();
    sequence.type = result.first.type();
    return result;
}

SequenceFile open_series(const fs::path& path, const Pattern& pattern,
                         const SequenceOptions& options) {
    std::vector<std::string> notes;
    const std::vector<NumberedFile> files = files_of(path, pattern);
    const std::vector<double> places = places_of(files, notes);
    VolumeFile first = read_volume(files.front().path, options.read);
    first.frame_interval = 0;  // of the volumes in that file, not of the series
    SequenceFile result = opened(std::move(first), places, 0, options.interval, std::move(notes));
    result.sequence.reader = [files, read = options.read](int frame, const Progress& progress) {
        ReadOptions with = read;
        with.progress = progress;
        return read_volume(files[static_cast<std::size_t>(frame)].path, with).volume;
    };
    result.sequence.frame_name = [files](int frame) {
        return files[static_cast<std::size_t>(frame)].path.string();
    };
    return result;
}

SequenceFile open_file(const fs::path& path, const SequenceOptions& options) {
    ReadOptions read = options.read;
    read.time_step = 0;
    return sequence_of(
        read_volume(path, read), options.interval,
        [path, read](int frame, const Progress& progress) {
            ReadOptions with = read;
            with.progress = progress;
            with.time_step = frame;
            return read_volume(path, with).volume;
        },
        [path](int frame) { return path.string() + ": frame " + std::to_string(frame); });
}

std::string name_of_frame(const Sequence& sequence, int frame) {
    return sequence.frame_name ? sequence.frame_name(frame) : "frame " + std::to_string(frame);
}

/// The difference between a frame and the first one. Empty if there is none.
std::string difference(const Volume& frame, const Sequence& sequence) {
    const Geometry& here = frame.geometry();
    const Geometry& there = sequence.geometry;
    const auto differs = [](const std::string& what, const std::string& a, const std::string& b) {
        return "its " + what + " " + a + ", that of the first frame " + b;
    };
    if (here.size != there.size) {
        return differs("size is", text_of(here.size), text_of(there.size));
    }
    if (frame.type() != sequence.type) {
        return differs("sample type is", std::string(name_of(frame.type())),
                       std::string(name_of(sequence.type)));
    }
    if (here.spacing != there.spacing) {
        return differs("spacing is", text_of(here.spacing), text_of(there.spacing) + " mm");
    }
    if (here.origin != there.origin) {
        return differs("origin is", text_of(here.origin), text_of(there.origin) + " mm");
    }
    return here.direction == there.direction ? "" : "its axes are not those of the first frame";
}

/// Metadata in the folder of a disc or a store, which has files in folders.
constexpr std::array metadata_names = {"DICOMDIR", "dicomdir", "zarr.json",      ".zgroup",
                                       ".zattrs",  ".zarray",  "attributes.json"};

/// Whether a folder is read with a file of this name: metadata, a chunk, or a slice, as those end:
/// "a.dcm", "I.001", "1.2.840.113619.4", "IM0001".
bool may_be_part(const fs::path& file) {
    static constexpr std::array of_slices = {".tif", ".tiff", ".dcm", ".dicom", ".ima", ""};
    const std::string end = lower(file.extension().string());
    return std::ranges::count(of_slices, end) > 0 || file.filename() == edits_note ||
           std::ranges::count(metadata_names, file.filename()) > 0 ||
           end.find_first_not_of("0123456789", 1) == std::string::npos;
}

bool is_part_of(const fs::path& file, const fs::path& folder) {
    std::error_code error;
    // By identity: slices may be links to files elsewhere.
    fs::directory_iterator at(folder, error);
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        std::error_code ignored;  // a link may lead nowhere
        if (may_be_part(at->path()) && fs::equivalent(at->path(), file, ignored)) return true;
    }
    const auto is_there = [&](const char* name) { return fs::exists(folder / name, error); };
    const std::string end = lower(fs::path(folder / "").parent_path().extension().string());
    if (end != ".zarr" && end != ".n5" && std::ranges::none_of(metadata_names, is_there))
        return false;
    const fs::path whole = fs::canonical(file, error);
    const fs::path inside = whole.lexically_relative(fs::canonical(folder, error));
    return may_be_part(whole) && !inside.empty() && *inside.begin() != "..";
}

/// The files of a series; one that is there is itself.
std::vector<fs::path> files_named(const fs::path& source) {
    std::error_code error;
    if (fs::exists(source, error)) return {source};
    std::vector<fs::path> files;
    try {
        if (const auto pattern = pattern_of(source)) {
            for (const NumberedFile& one : files_of(source, *pattern)) files.push_back(one.path);
        }
    } catch (const InputError&) {  // it cannot be read
    }
    return files;
}

}  // namespace

std::uint64_t Sequence::frame_bytes() const {
    return static_cast<std::uint64_t>(sample_count(geometry)) * size_of(type);
}

bool names_a_series(const fs::path& path) {
    std::error_code error;
    return !fs::exists(path, error) && pattern_of(path).has_value();
}

SequenceFile open_sequence(const fs::path& path, const SequenceOptions& options) {
    if (options.interval != 0) check_interval(options.interval);
    if (!names_a_series(path)) return open_file(path, options);
    return open_series(path, *pattern_of(path), options);
}

SequenceFile sequence_of(VolumeFile first, double interval,
                         std::function<Volume(int frame, const Progress& progress)> reader,
                         std::function<std::string(int frame)> frame_name) {
    if (interval != 0) check_interval(interval);
    std::vector<double> places;
    for (int i = 0; i < first.time_steps; ++i) places.push_back(i);
    const bool sensible = first.time_steps > 1 && std::abs(first.first_time) < 1e6;
    const double first_time = sensible ? first.first_time : 0;
    SequenceFile result = opened(std::move(first), places, first_time, interval, {});
    result.sequence.reader = std::move(reader);
    result.sequence.frame_name = std::move(frame_name);
    return result;
}

Sequence made_sequence(int count, double interval,
                       std::function<Volume(int frame, const Progress& progress)> make) {
    check_interval(interval);
    if (count < 1 || !make) throw std::invalid_argument("a sequence needs at least one frame");
    const Volume first = make(0, {});
    Sequence sequence;
    for (int i = 0; i < count; ++i) sequence.times.push_back(i * interval);
    sequence.period = count * interval;
    sequence.geometry = first.geometry();
    sequence.type = first.type();
    sequence.reader = std::move(make);
    return sequence;
}

Volume read_frame(const Sequence& sequence, int frame, const Progress& progress) {
    if (frame < 0 || frame >= sequence.count()) {
        throw std::invalid_argument("there is no frame " + std::to_string(frame) +
                                    ", the sequence has " + std::to_string(sequence.count()));
    }
    Volume volume = sequence.reader(frame, progress);
    const std::string flaw = difference(volume, sequence);
    if (flaw.empty()) return volume;
    throw InputError(name_of_frame(sequence, frame) + ": " + flaw +
                     "; all frames must lie on one grid and have one sample type");
}

void check(const Sequence& sequence) {
    if (sequence.times.empty() || !sequence.reader) {
        throw std::invalid_argument("a sequence needs at least one frame and a reader");
    }
    for (std::size_t i = 0; i < sequence.times.size(); ++i) {
        const bool rises = i == 0 || sequence.times[i] > sequence.times[i - 1];
        if (!std::isfinite(sequence.times[i]) || !rises) {
            throw std::invalid_argument("the time of frame " + std::to_string(i) +
                                        " does not lie after the one before");
        }
    }
    const double length = sequence.times.back() - sequence.times.front();
    if (!(std::isfinite(sequence.period) && sequence.period > length)) {
        throw std::invalid_argument("the period does not end after the last frame");
    }
    check(sequence.geometry);
}

bool is_read_from(const fs::path& path, const fs::path& source) {
    if (is_same_file(path, source)) return true;
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;
    if (fs::is_directory(source, error)) return is_part_of(path, source);
    const auto is_path = [&](const fs::path& one) { return is_same_file(one, path); };
    const std::vector<fs::path> files = files_named(source);
    return std::ranges::any_of(files, is_path) ||
           std::ranges::any_of(files_read_with(files), is_path);
}

}  // namespace palpate::io

// Reads DICOM: headers, then the slices of one series, then the grid that dicom_stack.hpp has
// planned.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "io/helper/dicom_header.hpp"
#include "io/helper/dicom_index.hpp"
#include "io/helper/dicom_library.hpp"
#include "io/helper/dicom_series.hpp"
#include "io/helper/dicom_stack.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* packed = "is packed; unpack it with gunzip";

bool is_whole(const DicomSlice& s) {
    return s.table || (s.slope == std::floor(s.slope) && s.intercept == std::floor(s.intercept));
}

/// The values that a slice may have, whatever it has.
std::pair<double, double> possible_values(const DicomSlice& s) {
    if (s.table) {
        const auto [least, most] = std::ranges::minmax(s.table->values);
        return {least, most};
    }
    return std::minmax({s.slope * s.least + s.intercept, s.slope * s.most + s.intercept});
}

struct PossibleValues {
    double low = 0, high = 0;
    bool are_floats = false;
};

/// The least type for whole numbers.
SampleType whole_type(const PossibleValues& values) {
    if (!values.are_floats && values.low >= -32768 && values.high <= 32767) {
        return SampleType::int16;
    }
    const bool fit = !values.are_floats && values.low >= 0 && values.high <= 65535;
    return fit ? SampleType::uint16 : SampleType::float32;
}

/// What the headers of all slices allow, in the place of what those of one time step have.
PossibleValues possible_values(const DicomSeries& series) {
    PossibleValues all;
    for (const DicomSlice& s : series.slices) {
        const auto [least, most] = possible_values(s);
        all.low = std::min(all.low, least);
        all.high = std::max(all.high, most);
        all.are_floats = all.are_floats || s.is_real || !is_whole(s);
    }
    return all;
}

/// The type for all time steps of a series if it does not change the stored numbers: theirs.
std::optional<SampleType> stored_type(const DicomSeries& series) {
    const DicomSlice& first = series.slices.front();
    const bool kept = std::ranges::all_of(series.slices, [&](const DicomSlice& s) {
        return s.slope == 1 && s.intercept == 0 && !s.table && !s.is_real && s.bits <= 16 &&
               s.bits == first.bits && (s.least < 0) == (first.least < 0);
    });
    if (!kept) return std::nullopt;
    return first.least < 0  ? SampleType::int16
           : first.bits > 8 ? SampleType::uint16
                            : SampleType::uint8;
}

/// The type for all slices together: Hounsfield units and the like come as 32-bit integers. Those
/// of `series` that are taken are `slices`. All time steps have one type, so that it must not
/// depend on the values of one of them.
SampleType common_type(const DicomSeries& series, int time_steps,
                       const std::vector<Decoded>& slices, std::vector<std::string>& notes) {
    const Stored first = slices.front().stored;
    bool same = true;
    PossibleValues values = time_steps > 1 ? possible_values(series) : PossibleValues();
    values.are_floats = !std::ranges::all_of(series.slices, is_whole);
    if (time_steps == 1) {
        std::tie(values.low, values.high) = range_of(first, slices.front().samples);
    }
    for (const Decoded& d : slices) {
        same = same && d.stored == first;
        values.are_floats = values.are_floats || is_real(d.stored);
        const auto range = range_of(d.stored, d.samples);
        values.low = std::min(values.low, range.first);
        values.high = std::max(values.high, range.second);
    }
    const auto stored = time_steps > 1 ? stored_type(series) : std::nullopt;
    if (stored) return *stored;
    if (time_steps == 1 && same && !values.are_floats && kept_as(first) != SampleType::float32) {
        return kept_as(first);
    }
    const SampleType type = whole_type(values);
    if (type != SampleType::float32 || (same && first == Stored::float32)) return type;
    notes.push_back(values.are_floats
                        ? "its slope or intercept is not a whole number: samples became float32"
                        : "its values go from " + text_of(values.low) + " to " +
                              text_of(values.high) + ", beyond 16 bits: samples became float32");
    return SampleType::float32;
}

/// Slices of one type, and a value at any place in one of them.
template <class T>
class Sampler {
  public:
    Sampler(const Stack& stack, const std::vector<std::vector<std::byte>>& slices, int columns,
            int rows, double outside)
        : stack_(stack), slices_(slices), columns_(columns), rows_(rows), outside_(outside) {}

    /// At grid column and row `x`, `y` of slice `s`, its shift undone: bilinear.
    double at(std::size_t s, int x, int y) const {
        if (!stack_.sheared) return pixel(s, x, y);
        const double u = x + stack_.first_u - stack_.slices[s].u;
        const double v = y + stack_.first_v - stack_.slices[s].v;
        const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
        const double a = u - i, b = v - j;
        return (1 - b) * ((1 - a) * pixel(s, i, j) + a * pixel(s, i + 1, j)) +
               b * ((1 - a) * pixel(s, i, j + 1) + a * pixel(s, i + 1, j + 1));
    }

  private:
    double pixel(std::size_t s, int x, int y) const {
        if (x < 0 || y < 0 || x >= columns_ || y >= rows_) return outside_;
        return reinterpret_cast<const T*>(slices_[s].data())[y * columns_ + x];
    }
    const Stack& stack_;
    const std::vector<std::vector<std::byte>>& slices_;
    int columns_, rows_;
    double outside_;
};

template <class T>
void fill(const Stack& stack, const std::vector<std::vector<std::byte>>& slices,
          const DicomSlice& one, double outside, T* to) {
    const Sampler<T> sampler(stack, slices, one.columns, one.rows, outside);
    const auto plane = static_cast<std::size_t>(stack.geometry.size[0]) *
                       static_cast<std::size_t>(stack.geometry.size[1]);
    for (const GridSlice& g : stack.grid) {
        if (g.is_empty) {
            to = std::fill_n(to, plane, T(0));
            continue;
        }
        if (g.weight == 0 && !stack.sheared) {
            std::memcpy(to, slices[g.first].data(), plane * sizeof(T));
            to += plane;
            continue;
        }
        for (int y = 0; y < stack.geometry.size[1]; ++y) {
            for (int x = 0; x < stack.geometry.size[0]; ++x) {
                double value = sampler.at(g.first, x, y);
                if (g.weight > 0) value += g.weight * (sampler.at(g.second, x, y) - value);
                *to++ = static_cast<T>(std::is_integral_v<T> ? std::round(value) : value);
            }
        }
    }
}

/// One note for all files whose decoders warned.
class DecoderWarnings {
  public:
    void take(const Decoded& decoded, const DicomSlice& slice) {
        if (decoded.decoder_said.empty()) return;
        if (files_++ == 0) first_ = quoted(slice.file) + " (" + decoded.decoder_said + ")";
    }
    void note(std::vector<std::string>& notes) const {
        if (files_ == 0) return;
        const std::string more = files_ == 1 ? "" : " and " + std::to_string(files_ - 1) + " more";
        notes.push_back("the decoder warned of damage in " + first_ + more +
                        ": do not trust the surface there");
    }

  private:
    std::size_t files_ = 0;
    std::string first_;
};

/// Notes on the files of a series, each thing once.
void note_files(const std::vector<DicomSlice>& slices, std::vector<std::string>& notes) {
    std::set<std::string> said;
    for (const DicomSlice& slice : slices) {
        std::vector<std::string> all = slice.notes;
        if (!slice.compression.empty()) {
            all.push_back("its samples are compressed (" + slice.compression +
                          ") without a checksum: damage within them may not be noticed");
        }
        for (std::string& note : all) {
            if (said.insert(note).second) notes.push_back(std::move(note));
        }
    }
}

/// Slices without slope or intercept among others that have both: a program may have lost these.
/// And a CT without them, whose values have no unit.
void note_missing_rescale(const std::vector<DicomSlice>& slices, std::vector<std::string>& notes) {
    const auto changes = [](const DicomSlice& s) {
        return s.has_rescale && (s.table || s.slope != 1 || s.intercept != 0);
    };
    const auto lacks = [](const DicomSlice& s) { return !s.has_rescale; };
    const auto first = std::ranges::find_if(slices, lacks);
    if (std::ranges::all_of(slices, lacks) && slices.front().values.modality == "CT") {
        notes.emplace_back(
            "it gives no slope or no intercept (RescaleSlope, RescaleIntercept): its values are "
            "not known to be HU");
        return;
    }
    if (first == slices.end() || std::ranges::none_of(slices, changes)) return;
    const auto count = std::ranges::count_if(slices, lacks);
    notes.push_back(
        std::to_string(count) + " of its " + std::to_string(slices.size()) +
        " slices (the first in " + quoted(first->file) + (count == 1 ? ") gives" : ") give") +
        " no slope or no intercept, and others do: a slope of 1 or an intercept of 0 was "
        "taken, do not trust the surface there");
}

/// Bits beyond BitsStored do not count (PS3.5, 8.1.1): overlays, but also numbers that do not fit.
void note_more_bits(const std::vector<DicomSlice>& slices, const std::vector<Decoded>& decoded,
                    std::vector<std::string>& notes) {
    const auto has_more = [](const Decoded& d) { return d.has_more_bits; };
    const auto first = std::ranges::find_if(decoded, has_more);
    const auto& about = slices.front().notes;
    if (first == decoded.end() || std::ranges::find(about, overlays_note) != about.end()) return;
    notes.push_back(
        "samples have bits beyond the stored ones (BitsStored), the first in " +
        quoted(slices[static_cast<std::size_t>(first - decoded.begin())].file) +
        ": these bits were not counted; if the values are wrong, correct BitsStored and HighBit");
}

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Without files that are copies of others, byte by byte; one of each stays. A slice with the same
/// identity but other bytes stays too, to be refused where the slices are placed.
DicomSeries without_copies(DicomSeries series, std::vector<std::string>& notes) {
    std::map<std::string, std::set<fs::path>> files;  // by identity
    std::set<fs::path> all, copies;
    for (const DicomSlice& slice : series.slices) {
        files[slice.instance_uid].insert(slice.file);
        all.insert(slice.file);
    }
    for (const auto& [identity, same] : files) {
        if (identity.empty() || same.size() == 1) continue;
        std::map<std::size_t, fs::path> seen;  // by hash
        for (const fs::path& file : same) {
            const std::string bytes = bytes_of(file);
            const auto [first, is_new] = seen.try_emplace(std::hash<std::string>()(bytes), file);
            if (!is_new && bytes_of(first->second) == bytes) copies.insert(file);
        }
    }
    if (copies.empty()) return series;
    std::erase_if(series.slices, [&](const DicomSlice& s) { return copies.contains(s.file); });
    notes.push_back(std::to_string(copies.size()) + " of its " + std::to_string(all.size()) +
                    " files are copies of others in the folder: they were left out");
    return series;
}

Result read_series(const DicomSeries& given, const Request& request) {
    std::vector<std::string> notes;
    const DicomSeries series = without_copies(given, notes);
    Stack stack = stack_slices(series, request);
    std::vector<DicomSlice> taken;
    for (const PlacedSlice& p : stack.slices) taken.push_back(series.slices[p.slice]);
    std::vector<Decoded> decoded = decode(taken, request);
    DecoderWarnings warnings;
    for (std::size_t i = 0; i < taken.size(); ++i) warnings.take(decoded[i], taken[i]);
    const DicomSlice& one = taken.front();
    Result result;
    result.format = one.frames > 1            ? "DICOM, several frames in one file"
                    : stack.slices.size() > 1 ? "DICOM series"
                                              : "DICOM, one slice";
    result.geometry = stack.geometry;
    result.values = one.values;
    result.notes = notes;
    result.notes.insert(result.notes.end(), stack.notes.begin(), stack.notes.end());
    take_step(request, stack.time_steps, {stack.seconds, 0}, result);
    note_files(taken, result.notes);
    note_missing_rescale(taken, result.notes);
    note_more_bits(taken, decoded, result.notes);
    warnings.note(result.notes);
    result.type = common_type(series, stack.time_steps, decoded, result.notes);
    const auto pixels = static_cast<std::size_t>(one.columns) * static_cast<std::size_t>(one.rows);
    double outside = range_of(decoded[0].stored, decoded[0].samples).first;
    std::vector<std::vector<std::byte>> slices;
    for (Decoded& d : decoded) {
        outside = std::min(outside, range_of(d.stored, d.samples).first);
        slices.emplace_back(pixels * size_of(result.type));
        convert(d.stored, d.samples.data(), result.type, slices.back().data(), pixels);
        d.samples = {};
    }
    const std::int64_t sizes[] = {stack.geometry.size[0], stack.geometry.size[1],
                                  stack.geometry.size[2]};
    const auto samples =
        shared_samples(checked_bytes(sizes, size_of(result.type), UINT64_MAX, request));
    void* const to = samples.data();
    with_type(result.type, [&](auto zero) {
        fill(stack, slices, one, outside, static_cast<decltype(zero)*>(to));
    });
    finish(result, request, samples);
    return result;
}

/// A small picture of a slice, from the darkest of its samples to the brightest.
Thumbnail picture_of(const DicomSlice& slice, const Request& request) {
    constexpr int longest = 64;
    const Decoded decoded = decode({slice}, request).front();
    const int step = (std::max(slice.columns, slice.rows) + longest - 1) / longest;
    Thumbnail picture{slice.columns / step, slice.rows / step, {}};
    const auto range = range_of(decoded.stored, decoded.samples);
    double low = range.first, high = range.second;
    if (slice.values.window) {
        const auto [centre, width] = *slice.values.window;
        low = centre - 0.5 * width;
        high = centre + 0.5 * width;
    }
    const double scale = high > low ? 255 / (high - low) : 0;
    with_stored(decoded.stored, [&](auto zero) {
        const auto* from = reinterpret_cast<const decltype(zero)*>(decoded.samples.data());
        for (int y = 0; y < picture.height; ++y) {
            for (int x = 0; x < picture.width; ++x) {
                const std::ptrdiff_t at = std::ptrdiff_t{y} * step * slice.columns + x * step;
                const double grey = (static_cast<double>(from[at]) - low) * scale;
                picture.grey.push_back(static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0)));
            }
        }
    });
    return picture;
}

Result read_chosen(const std::vector<DicomSeries>& all, const Request& request) {
    try {
        return read_series(choose_series(all, request.series), request);
    } catch (ChooseSeries& choice) {
        constexpr std::size_t most = 48;
        for (std::size_t i = 0; request.pictures && i < std::min(all.size(), most); ++i) {
            try {
                choice.series[i].picture = picture_of(middle_of(all[i]), request);
            } catch (const std::exception&) {
                // It is still listed; choosing it says what is wrong.
            }
        }
        throw;
    }
}

/// A slice alone may be one of a series, which its folder opens.
void note_others_beside(const fs::path& slice, std::vector<std::string>& notes) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(fs::absolute(slice).parent_path(), error)) {
        if (!is_shown_file(entry) || entry.path().filename() == slice.filename() ||
            !begins_as_dicom(entry.path())) {
            continue;
        }
        notes.emplace_back(
            "it is one slice, and other DICOM files are beside it: if they belong to one series, "
            "give their folder");
        return;
    }
}

Result read_file(const Request& request) {
    say_doing(request.path.filename().string());
    if (is_gzip(request.path)) throw Failure(packed);
    const auto all = series_of(slices_from(request.path));
    if (all.empty()) {
        throw Failure("is a DICOM file without an image; give the folder with the slices");
    }
    Result result = read_chosen(all, request);
    const bool is_alone = all.size() == 1 && all.front().slices.size() == 1;
    if (is_alone) note_others_beside(request.path, result.notes);
    return result;
}

/// A file's path with "#" for every number in its name: the same for all slices of most series.
std::string numberless(const fs::path& file) {
    std::string name;
    for (const char c : file.filename().string()) {
        const bool digit = c >= '0' && c <= '9';
        if (!digit || !name.ends_with('#')) name += digit ? '#' : c;
    }
    return (file.parent_path() / name).string();
}

/// Whether a file that is no DICOM was to be a slice: its name says so, or is that of a slice but
/// for its numbers, or it is empty or a dangling link, and without an extension, as slices are.
/// Passing over such a file would hide a gap, or make the body too short.
void check_others(const std::vector<fs::path>& slices, const std::vector<fs::path>& others) {
    std::set<std::string> names;
    std::set<fs::path> bare;  // folders of slices without an extension
    for (const fs::path& slice : slices) {
        names.insert(numberless(slice));
        if (!slice.has_extension()) bare.insert(slice.parent_path());
    }
    for (const fs::path& file : others) {
        const bool missing = is_dangling_link(fs::directory_entry(file));
        const bool empty = !missing && fs::file_size(file) == 0;
        const std::string like = numberless(file);  // a LOCKFILE has no number
        const bool is_bare = !file.has_extension() && bare.contains(file.parent_path()) &&
                             fs::path(like).filename().string().find('#') != std::string::npos;
        if (!has_dicom_name(file) && !names.contains(like) && !((empty || missing) && is_bare)) {
            continue;
        }
        if (missing) {
            throw Failure(quoted(file) +
                          " is a link to a file that is not there; get that file (git-annex: git "
                          "annex get), or take the link away");
        }
        throw Failure(quoted(file) + " " +
                      (empty ? "is empty (0 bytes), though slices have such names; copy it again"
                       : is_gzip(file)
                           ? packed
                           : "is no DICOM file, though slices have such names; copy it again") +
                      ", or take it away");
    }
}

/// Files that the folder's index lists may have been slices of the series.
void note_missing_images(const std::vector<fs::path>& indexes, const std::vector<fs::path>& files,
                         std::vector<std::string>& notes) {
    for (const fs::path& file : indexes) {
        try {
            const auto missing = images_missing(file, files);
            if (missing.empty()) continue;
            notes.push_back("its index (" + file.filename().string() + ") lists " +
                            std::to_string(missing.size()) +
                            " images that are not in the folder, the first is " +
                            quoted(fs::path(missing[0])) +
                            ": if they belong to this series, it is not complete");
        } catch (const Failure& e) {
            notes.push_back("its index could not be read (" + std::string(e.what()) +
                            "): it is not known whether images are missing");
        }
    }
}

Result read_folder(const Request& request) {
    std::vector<fs::path> files, others, indexes;
    const auto take = [&](const fs::directory_entry& entry) {
        if (!is_shown_file(entry) && !is_dangling_link(entry)) return;
        (is_dicom_index(entry.path())    ? indexes
         : begins_as_dicom(entry.path()) ? files
                                         : others)
            .push_back(entry.path());
    };
    if (has_dicom_index(request.path)) {
        std::ranges::for_each(fs::recursive_directory_iterator(request.path), take);
    } else {
        std::ranges::for_each(fs::directory_iterator(request.path), take);
    }
    std::ranges::sort(files);
    std::ranges::sort(others);
    check_others(files, others);
    std::vector<DicomSlice> slices;
    for (const fs::path& file : files) {
        say_doing(file.filename().string());
        say_progress(0.1 * static_cast<double>(slices.size()) / static_cast<double>(files.size()));
        for (DicomSlice& slice : slices_from(file)) slices.push_back(std::move(slice));
    }
    if (slices.empty())
        throw Failure("has DICOM files, but none with an image; give another folder");
    const auto all = series_of(std::move(slices));
    Result result = read_chosen(all, request);
    note_missing_images(indexes, files, result.notes);
    return result;
}

}  // namespace

Result read_dicom(const Request& request) {
    bound_memory(request.memory_limit);  // and each file by what it says of itself
    return fs::is_directory(request.path) ? read_folder(request) : read_file(request);
}

}  // namespace palpate::io

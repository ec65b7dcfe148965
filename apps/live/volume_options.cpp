// Which volume, which level: options and loading.
#include "apps/live/volume_options.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "apps/live/statistics.hpp"
#include "io/number.hpp"
#include "palpate/io/level.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/renderer.hpp"
#include "palpate/scenes/beating.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::app {
namespace {

constexpr std::string_view synthetic_prefix = "synthetic:";
constexpr std::string_view live_prefix = "live:";
/// [s] For the first frame of a live source.
constexpr double longest_wait = 5;

/// "synthetic:beating", with or without a size.
bool is_beating(const std::string& name) {
    const std::string scene = std::string(synthetic_prefix) + "beating";
    return name == scene || name.starts_with(scene + ":");
}

LoadedVolume synthetic(const scenes::Scene& scene, const std::string& name) {
    LoadedVolume loaded{scene.volume, name};
    loaded.format = "synthetic (" + scene.description + ")";
    loaded.isovalue = scene.isovalue;
    return loaded;
}

/// The synthetic volume that is a sequence.
LoadedVolume make_beating(const VolumeOptions& options, std::optional<SampleType> type) {
    const scenes::Scene first = scenes::make_volume(options.volume, type);
    const Geometry grid = first.volume.geometry();
    const SampleType kept = first.volume.type();
    const auto frame = [grid, kept](int number, const io::Progress&) {
        return scenes::beating_frame(grid, double(number) / scenes::beating_frames, kept).volume;
    };
    LoadedVolume loaded = synthetic(first, options.volume);
    loaded.time_steps = scenes::beating_frames;
    if (options.time_step) {
        if (*options.time_step >= loaded.time_steps) {
            throw std::invalid_argument(
                fmt::format("{} has {} frames, from 0", options.volume, loaded.time_steps));
        }
        loaded.volume = frame(*options.time_step, {});
        return loaded;
    }
    const double interval = options.frame_interval > 0
                                ? options.frame_interval
                                : scenes::beating_period / scenes::beating_frames;
    loaded.sequence = io::made_sequence(scenes::beating_frames, interval, frame);
    return loaded;
}

LoadedVolume make_synthetic(const VolumeOptions& options) {
    std::optional<SampleType> type;
    if (!options.type.empty()) type = sample_type_from(options.type);
    if (!options.dims.empty() || !options.spacing.empty()) {
        throw std::invalid_argument(
            "--dims and --spacing are for files; a synthetic volume's size is part of its name: "
            "synthetic:NAME:WxHxD");
    }
    if (!options.series.empty() || options.skip != 0) {
        throw std::invalid_argument("--series and --skip are for files");
    }
    if (is_beating(options.volume)) return make_beating(options, type);
    if (options.time_step) throw std::invalid_argument("--time-step is for sequences");
    return synthetic(scenes::make_volume(options.volume, type), options.volume);
}

/// What another program pushes, from its newest frames on.
LoadedVolume follow(const VolumeOptions& options) {
    const std::string path = options.volume.substr(live_prefix.size());
    if (options.smooth > 0) throw std::invalid_argument("--smooth is not for live sources");
    auto live = std::make_shared<const io::LiveFrames>(path);
    const std::shared_ptr<const Samples> samples = live->wait(longest_wait);
    if (!samples) {
        throw io::InputError(path + ": no frame has come yet; start the program that writes it");
    }
    LoadedVolume loaded{samples->volume(), options.volume};
    loaded.format = "live source";
    loaded.live = std::move(live);
    return loaded;
}

LoadedVolume read_file(const VolumeOptions& options, const io::Progress& progress) {
    io::SequenceOptions asked;
    asked.interval = options.frame_interval;
    io::ReadOptions& read = asked.read;
    if (!options.dims.empty() || !options.type.empty()) {
        read.raw = io::raw_layout_from(options.dims, options.type, options.spacing, options.skip);
    }
    if (!options.spacing.empty()) read.spacing = io::spacing_from(options.spacing);
    read.series = options.series;
    read.progress = progress;
    if (options.time_step && !io::names_a_series(options.volume)) {
        read.time_step = *options.time_step;
        io::VolumeFile file = io::read_volume(options.volume, read);
        LoadedVolume loaded{std::move(file.volume), options.volume};
        loaded.format = std::move(file.format);
        loaded.notes = std::move(file.notes);
        loaded.time_steps = file.time_steps;
        return loaded;
    }
    io::SequenceFile file = io::open_sequence(options.volume, asked);
    LoadedVolume loaded{std::move(file.first), options.volume};
    loaded.format = std::move(file.format);
    loaded.notes = std::move(file.notes);
    loaded.sequence = std::move(file.sequence);
    loaded.time_steps = loaded.sequence.count();
    if (loaded.time_steps == 1) loaded.sequence = {};
    if (!options.time_step) return loaded;
    if (*options.time_step >= loaded.time_steps) {
        throw io::InputError(fmt::format("{}: there is no time step {}: it has {} frames",
                                         options.volume, *options.time_step, loaded.time_steps));
    }
    if (*options.time_step > 0) {
        loaded.volume = io::read_frame(loaded.sequence, *options.time_step, progress);
    }
    loaded.sequence = {};
    return loaded;
}

}  // namespace

std::string flaw_in_count(const std::string& text) {
    const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    return digits ? "" : text + " is not a whole number from 0";
}

void VolumeOptions::add_to(CLI::App& command, bool optional) {
    auto* positional =
        command.add_option("VOLUME", volume,
                           "File, folder, series (heart_%03d.nrrd), synthetic:NAME[:WxHxD], or "
                           "live:FILE");
    if (!optional) positional->required();
    command.add_option("--dims", dims, "Size of a raw file in samples: WxHxD")->type_name("WxHxD");
    command.add_option("--type", type,
                       "Sample type of a raw file (or a synthetic volume): uint8, int16, uint16, "
                       "float32");
    command
        .add_option("--spacing", spacing,
                    "Spacing [mm] instead of what the file gives or lacks: X,Y,Z")
        ->type_name("X,Y,Z");
    command.add_option("--skip", skip, "Bytes of header to skip in a raw file")
        ->check(flaw_in_count);
    command.add_option("--series", series, "DICOM series: its number in the list, or its UID");
    command
        .add_option("--time-step", time_step,
                    "This frame alone of a 4-D file or a numbered series (heart_%d.nrrd), from 0")
        ->check(flaw_in_count);
    command
        .add_option("--frame-interval", frame_interval,
                    "Time from frame to frame [s] instead of what the file gives or lacks")
        ->check(CLI::PositiveNumber);
    command
        .add_option("--smooth", smooth,
                    "Smooth the samples so many times (3x3x3 binomial), against the terraces of 8 "
                    "bits; they become float32")
        ->check(CLI::Range(0, 64));
    command.add_flag("-q,--quiet", quiet, "No progress, no notes");
}

LoadedVolume load(const VolumeOptions& options, const io::Progress& progress) {
    const std::string& name = options.volume;
    LoadedVolume loaded = name.starts_with(synthetic_prefix) ? make_synthetic(options)
                          : name.starts_with(live_prefix)    ? follow(options)
                                                             : read_file(options, progress);
    if (options.smooth == 0) return loaded;
    loaded.volume = smoothed(loaded.volume, options.smooth);
    if (loaded.sequence.count() == 0) return loaded;
    loaded.sequence.type = loaded.volume.type();
    loaded.sequence.reader = [read = std::move(loaded.sequence.reader), passes = options.smooth](
                                 int frame, const io::Progress& each) {
        return smoothed(read(frame, each), passes);
    };
    return loaded;
}

std::map<std::string, std::string> to_names(const VolumeOptions& options) {
    std::map<std::string, std::string> names{{"volume", options.volume}};
    const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) names[name] = value;
    };
    add("dims", options.dims);
    add("type", options.type);
    add("spacing", options.spacing);
    add("series", options.series);
    if (options.skip > 0) add("skip", std::to_string(options.skip));
    if (options.time_step) add("time-step", std::to_string(*options.time_step));
    if (options.frame_interval > 0) {
        std::string interval;
        io::append_number(interval, options.frame_interval);
        add("frame-interval", interval);
    }
    if (options.smooth > 0) add("smooth", std::to_string(options.smooth));
    return names;
}

VolumeOptions options_from(const std::map<std::string, std::string>& names) {
    const auto value = [&](const char* name) {
        const auto found = names.find(name);
        return found == names.end() ? std::string() : found->second;
    };
    VolumeOptions options;
    options.volume = value("volume");
    options.dims = value("dims");
    options.type = value("type");
    options.spacing = value("spacing");
    options.series = value("series");
    options.skip = io::number_from<std::uint64_t>(value("skip")).value_or(0);
    options.time_step = io::number_from<int>(value("time-step"));
    options.frame_interval = io::number_from<double>(value("frame-interval")).value_or(0);
    options.smooth = io::number_from<int>(value("smooth")).value_or(0);
    return options;
}

void FieldOptions::add_to(CLI::App& command) {
    command.add_option("-i,--isovalue", isovalue,
                       "Level to feel, in the data's units (300) or percent of its range (53%)");
    add_side_to(command);
}

void FieldOptions::add_side_to(CLI::App& command) {
    command.add_option("--solid", solid, "Which side of the level is solid: above, below")
        ->check(CLI::IsMember({"above", "below"}))
        ->capture_default_str();
    command.add_option("--background", background,
                       "Level outside the data (default: the data's minimum; its maximum for "
                       "--solid below)");
}

Field make_field(const LoadedVolume& loaded, const FieldOptions& options) {
    std::optional<double> background;
    if (!options.background.empty()) {
        background = io::level_from_text(options.background, loaded.volume);
    }
    return Field(loaded.volume, options.solid == "below" ? Solid::below : Solid::above, background);
}

double isovalue_of(const LoadedVolume& loaded, const Field& field, const FieldOptions& options) {
    if (options.isovalue.empty() && !loaded.isovalue) {
        throw std::invalid_argument(
            fmt::format("--isovalue is needed: which level of {} to feel; palpate info {} suggests "
                        "some",
                        loaded.name, loaded.name));
    }
    const double isovalue = options.isovalue.empty()
                                ? *loaded.isovalue
                                : io::level_from_text(options.isovalue, loaded.volume);
    const std::string warning = isovalue_warning(field, isovalue);
    if (!warning.empty()) {
        fmt::print(stderr, "palpate: warning: isovalue {} (data {} to {}): {}\n", isovalue,
                   loaded.volume.minimum(), loaded.volume.maximum(), warning);
    }
    return isovalue;
}

double suggested_isovalue_of(const LoadedVolume& loaded, const Field& field, FieldOptions options) {
    if (options.isovalue.empty() && !loaded.isovalue) {
        const std::vector<double> levels = suggested_isovalues(histogram_of(loaded.volume, 256));
        if (levels.empty()) {
            throw std::invalid_argument(loaded.name +
                                        ": the data are constant, there is nothing to feel");
        }
        options.isovalue = fmt::format("{}", levels.front());
    }
    return isovalue_of(loaded, field, options);
}

}  // namespace palpate::app

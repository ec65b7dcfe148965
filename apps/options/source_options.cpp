// Options of sources and fields.
#include "apps/options/source_options.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "apps/options/say.hpp"
#include "apps/options/values.hpp"
#include "palpate/filters/dequantize.hpp"
#include "palpate/names.hpp"
#include "palpate/renderer.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::app {

void SourceOptions::add_to(CLI::App& command, For purpose, bool optional) {
    command_ = &command;
    purpose_ = purpose;
    command
        .add_option("VOLUME", volume(),
                    fmt::format("File, folder, series (heart_%03d.nrrd), web address of a store, "
                                "synthetic:{{{}}}[:WxHxD], or live:FILE",
                                fmt::join(scenes::volume_names(), ",")))
        ->type_name("FILE")
        ->required(!optional);
    const auto text = [&](const char* name, const char* help) {
        return command.add_option(std::string("--") + name, texts[name], help);
    };
    text("dims", "Size of a raw file in samples: WxHxD")->type_name("WxHxD");
    text("type", "Sample type of a raw file (or a synthetic volume)")
        ->check(one_of(all_names<SampleType>()));
    text("spacing", "Spacing [mm], which replaces that of the file: X,Y,Z")->type_name("X,Y,Z");
    text("orientation",
         "Side of the body that each axis runs to, which replaces that of the file: three letters "
         "such as LPS or RAS")
        ->type_name("LPS");
    text("skip", "Bytes of header to skip in a raw file")
        ->type_name("UINT")
        ->check(count(largest_count));
    text("byte-order", "Byte order of a raw file (default: little)")
        ->check(one_of({"little", "big"}));
    text("series", "DICOM series: its number in the list, or its UID");
    command
        .add_option("--time-step", frame,
                    "Only this frame of a 4-D file or a numbered series (heart_%d.nrrd), from 0")
        ->check(count());
    command
        .add_option("--frame-interval", frame_interval,
                    "Time between two frames [s], which replaces that of the file")
        ->check(above_zero());
    command
        .add_option("--smooth", smooth,
                    "Smooth the samples this many times (3x3x3 binomial), against the steps of "
                    "8-bit data. They become float32")
        ->check(from_to(0, 64));
    // A flag, so that the word after it stays the volume.
    command
        .add_flag("--dequantize{" + std::to_string(filters::DequantizeOptions{}.rounds) + "}",
                  dequantize,
                  "Remove the terraces of rounded data and the stair steps of masks: --dequantize "
                  "or --dequantize=ROUNDS. Samples become float32")
        ->check(count(filters::most_rounds));
    command.add_flag("--prefilter", prefilter,
                     "Sharpen the samples so that thin structures keep their height in the smooth "
                     "field. They become float32");
    add_store_options(command);
    command.add_flag("-q,--quiet", quiet, "No progress, no notes");
}

namespace {

const char* help_of_level(SourceOptions::For purpose) {
    switch (purpose) {
        case SourceOptions::For::touching:
            return "Level of detail of a store that is touched, 0 for the finest. A plain file is "
                   "then read while it is touched";
        case SourceOptions::For::description:
            return "Level of detail of a store that is described, 0 for the finest";
        case SourceOptions::For::surfaces:
            return "Level of detail of a store that is read whole, 0 for the finest (default: an "
                   "overview)";
        case SourceOptions::For::conversion:
            break;
    }
    return "Level of detail of a store that is converted, 0 for the finest";
}

}  // namespace

void SourceOptions::add_store_options(CLI::App& command) {
    const bool touches = purpose_ == For::touching;
    command.add_option("--level", texts["level"], help_of_level(purpose_))
        ->type_name("UINT")
        ->check(count());
    command.add_option("--channel", texts["channel"], "Channel of a store, from 0")
        ->type_name("UINT")
        ->check(count());
    command
        .add_option("--memory", memory,
                    touches ? "Memory limit of the whole program while a store is touched (without "
                              "it, 512MB for samples). A plain file is then read while it is "
                              "touched"
                            : "Memory limit. Chunks of a store may take half of it while they are "
                              "unpacked (without it, a quarter of this machine's memory)")
        ->type_name("SIZE")
        ->transform(size_in_bytes());
    // A command that does not list an option still takes it, and says that it does nothing.
    command
        .add_flag("--coarse-first", coarse_first,
                  "Use a coarser level until the finer one has loaded")
        ->group(touches ? "Options" : "");
    command
        .add_flag("--all-times", all_times,
                  "Take the times of a store as a sequence, each read whole at the level")
        ->group(purpose_ == For::conversion ? "" : "Options");
    command.add_option("--cache", cache_folder, "Folder that keeps downloaded data")
        ->type_name("FOLDER");
    command.add_option("--cache-size", cache_bytes, "Size limit of this folder (4GB)")
        ->type_name("SIZE")
        ->transform(size_in_bytes());
    command.add_flag("--forbidden-is-missing", forbidden_is_missing,
                     "Treat chunks for which the server answers 403 as not stored, as with S3");
}

void SourceOptions::warn_of_no_effect(const run::Source& source) const {
    app::warn_of_no_effect(*command_, run::without_effect(source));
    if (purpose_ == For::touching || !std::holds_alternative<run::StoreSource>(source.from)) return;
    app::warn_of_no_effect(*command_, {"--coarse-first"}, "no hand touches the volume");
}

void SourceOptions::warn_of_no_effect(const run::LoadedVolume& volume) const {
    app::warn_of_no_effect(*command_, run::without_effect(volume));
}

run::Source SourceOptions::source() const {
    std::map<std::string, std::string> given = texts;
    std::erase_if(given, [](const auto& entry) { return entry.second.empty(); });
    if (memory) given["memory"] = std::to_string(*memory);
    if (coarse_first) given["coarse-first"] = "yes";
    if (all_times) given["all-times"] = "yes";
    if (forbidden_is_missing) given["forbidden-is-missing"] = "yes";
    run::Source source = run::source_from(given);
    if (auto* store = std::get_if<run::StoreSource>(&source.from)) {
        store->options.cache_folder = cache_folder;
        store->options.cache_bytes = cache_folder.empty() ? 0 : cache_bytes;
    }
    source.frame = frame;
    source.frame_interval = frame_interval;
    source.smooth = smooth;
    source.prefilter = prefilter;
    if (dequantize < 0) {  // of --dequantize=0, which means "off" for a flag
        throw std::invalid_argument("--dequantize takes 1 to " +
                                    std::to_string(filters::most_rounds) +
                                    " rounds: leave it out to keep the samples");
    }
    source.dequantize = dequantize;
    return source;
}

void add_field_options(CLI::App& command, run::FieldSetup& field) {
    command.add_option_function<std::string>(
        "-i,--isovalue",
        [&field](const std::string& text) { field.isovalue = io::level_from_text(text); },
        "Isovalue of the surface, in the data's units (300) or percent of its range (53%)");
    add_side_options(command, field);
}

void add_side_options(CLI::App& command, run::FieldSetup& field) {
    add_named(command, "--solid", field.solid, "Which side of the isovalue is solid");
    command
        .add_option_function<std::string>(
            "--field",
            [&field](const std::string& text) { field.interpolation = interpolation_from(text); },
            "Interpolation between samples: cubic (smooth) or linear (with facets, the paper's)")
        ->check(one_of({"cubic", "linear"}))
        ->default_str("cubic; linear for paper, gradient and gradient-improved");
    command.add_option_function<std::string>(
        "--background",
        [&field](const std::string& text) { field.background = io::level_from_text(text); },
        "Density outside the data (default: the data's minimum, or its maximum with --solid "
        "below)");
}

void warn_of_isovalue(const Field& field, double isovalue) {
    const std::string warning = run::level_warning(field, isovalue);
    if (!warning.empty()) say("palpate: warning: {}\n", warning);
}

void warn_of_layers(const io::LayersFile& layers, const run::LoadedVolume& loaded) {
    const std::string warning = run::layers_warning(layers, loaded);
    if (!warning.empty()) say("palpate: warning: {}\n", warning);
}

double required_isovalue(const run::LoadedVolume& loaded, const Field& field,
                         const run::FieldSetup& setup) {
    if (!setup.isovalue && !loaded.isovalue) {
        throw std::invalid_argument(
            fmt::format("--isovalue is needed: the level of {} that you want to touch. palpate "
                        "info {} suggests some",
                        loaded.name, loaded.name));
    }
    return suggested_isovalue(loaded, field, setup);
}

double required_isovalue(const run::LoadedVolume& loaded, const Field& field,
                         const run::FieldSetup& setup, const run::RenderSetup& render) {
    const auto& layers = render.layers;
    if (!layers || layers->layers.layers.empty()) {
        const auto* wanted = std::get_if<run::RangesSetup>(&render.penetrability);
        if (!wanted || setup.isovalue || loaded.isovalue) {
            return required_isovalue(loaded, field, setup);
        }
        const run::LevelRange& range = wanted->ranges.front();
        return io::level_in(loaded.volume, field.solid() == Solid::above ? range.low : range.high);
    }
    warn_of_layers(*layers, loaded);
    run::Setup all;
    all.field = setup;
    all.render = render;
    return run::isovalue_of(loaded, all);
}

double suggested_isovalue(const run::LoadedVolume& loaded, const Field& field,
                          const run::FieldSetup& setup) {
    const double isovalue = run::isovalue_of(loaded, setup);
    warn_of_isovalue(field, isovalue);
    return isovalue;
}

}  // namespace palpate::app

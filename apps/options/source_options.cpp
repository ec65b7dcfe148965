// Options of sources and fields.
#include "apps/options/source_options.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "io/system/number.hpp"
#include "palpate/filters/dequantize.hpp"
#include "palpate/renderer.hpp"

namespace palpate::app {

std::string flaw_in_count(const std::string& text) {
    const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    return digits ? "" : text + " is not a whole number from 0";
}

void SourceOptions::add_to(CLI::App& command, bool optional) {
    auto* positional =
        command.add_option("VOLUME", volume(),
                           "File, folder, series (heart_%03d.nrrd), web address of a store, "
                           "synthetic:NAME[:WxHxD], or live:FILE");
    if (!optional) positional->required();
    const auto text = [&](const char* name, const char* help) {
        return command.add_option(std::string("--") + name, texts[name], help);
    };
    text("dims", "Size of a raw file in samples: WxHxD")->type_name("WxHxD");
    text("type",
         "Sample type of a raw file (or a synthetic volume): uint8, int16, uint16, float32");
    text("spacing", "Spacing [mm] instead of what the file gives or lacks: X,Y,Z")
        ->type_name("X,Y,Z");
    text("orientation",
         "Where the axes run to in the body instead of what the file gives or lacks: three letters "
         "as in LPS or RAS")
        ->type_name("LPS");
    text("skip", "Bytes of header to skip in a raw file")->type_name("UINT")->check(flaw_in_count);
    text("byte-order", "Byte order of a raw file: little (default), big")
        ->type_name("ORDER")
        ->check(CLI::IsMember({"little", "big"}));
    text("series", "DICOM series: its number in the list, or its UID");
    command
        .add_option("--time-step", frame,
                    "This frame alone of a 4-D file or a numbered series (heart_%d.nrrd), from 0")
        ->check(flaw_in_count);
    command
        .add_option("--frame-interval", frame_interval,
                    "Time from frame to frame [s] instead of what the file gives or lacks")
        ->check(CLI::PositiveNumber);
    command
        .add_option("--smooth", smooth,
                    "Smooth the samples so many times (3x3x3 binomial), against the steps of 8-bit "
                    "data; they become float32")
        ->check(CLI::Range(0, 64));
    // A flag, so that the word after it stays the volume.
    command
        .add_flag("--dequantize{" + std::to_string(filters::DequantizeOptions{}.rounds) + "}",
                  dequantize,
                  "Give back what rounding to levels took, against terraces and the stair steps of "
                  "masks: --dequantize or --dequantize=ROUNDS; samples become float32")
        ->check(CLI::Range(0, filters::most_rounds));
    command.add_flag("--prefilter", prefilter,
                     "Sharpen the samples so that thin structures keep their height in the smooth "
                     "field; they become float32");
    add_streaming_to(command);
    command.add_flag("-q,--quiet", quiet, "No progress, no notes");
}

void SourceOptions::add_streaming_to(CLI::App& command) {
    command
        .add_option(
            "--level", texts["level"],
            "Level of detail to feel of a store with several, 0 the finest; a plain file is "
            "then read as it is felt")
        ->type_name("UINT")
        ->check(flaw_in_count);
    command.add_option("--channel", texts["channel"], "Channel of a store, from 0")
        ->type_name("UINT")
        ->check(flaw_in_count);
    command
        .add_option("--memory", memory,
                    "Most memory that the program may take while it feels (512MB for what is "
                    "felt); a plain file is then read as "
                    "it is felt")
        ->transform(CLI::AsSizeValue(false));
    command.add_flag("--coarse-first", coarse_first,
                     "Feel a coarser level where the one that is felt has not come yet");
    command.add_flag("--all-times", all_times,
                     "A store's times as a sequence, each read whole at the level");
    command.add_option("--cache", cache_folder, "Folder that keeps what came over the network");
    command.add_option("--cache-size", cache_bytes, "Most that this folder keeps (4GB)")
        ->transform(CLI::AsSizeValue(false));
    command.add_flag("--forbidden-is-missing", forbidden_is_missing,
                     "Chunks for which the server answers 403 are not stored, as with S3");
}

run::Source SourceOptions::source() const {
    std::map<std::string, std::string> given = texts;
    std::erase_if(given, [](const auto& entry) { return entry.second.empty(); });
    if (given.contains("skip") && !io::number_from<std::uint64_t>(given["skip"])) {
        throw std::invalid_argument("--skip " + given["skip"] + ": no file is that long");
    }
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
    source.dequantize = dequantize;
    return source;
}

void add_field_options(CLI::App& command, run::FieldSetup& field) {
    command.add_option_function<std::string>(
        "-i,--isovalue",
        [&field](const std::string& text) { field.isovalue = io::level_from_text(text); },
        "Level to feel, in the data's units (300) or percent of its range (53%)");
    add_side_options(command, field);
}

void add_side_options(CLI::App& command, run::FieldSetup& field) {
    command
        .add_option_function<std::string>(
            "--solid",
            [&field](const std::string& text) {
                field.solid = text == "below" ? Solid::below : Solid::above;
            },
            "Which side of the level is solid: above, below")
        ->check(CLI::IsMember({"above", "below"}))
        ->default_str("above");
    command
        .add_option_function<std::string>(
            "--field",
            [&field](const std::string& text) { field.interpolation = interpolation_from(text); },
            "How densities continue between samples: cubic (smooth), linear (with facets, the "
            "paper's)")
        ->check(CLI::IsMember({"cubic", "linear"}))
        ->default_str("cubic; linear for the methods paper and gradient");
    command.add_option_function<std::string>(
        "--background",
        [&field](const std::string& text) { field.background = io::level_from_text(text); },
        "Level outside the data (default: the data's minimum; its maximum for "
        "--solid below)");
}

void warn_of_isovalue(const Field& field, double isovalue) {
    const std::string warning = isovalue_warning(field, isovalue);
    if (warning.empty()) return;
    const Volume& volume = field.volume();
    fmt::print(stderr, "palpate: warning: isovalue {} (data {} to {}): {}\n", isovalue,
               volume.minimum(), volume.maximum(), warning);
}

void warn_of_layers(const io::LayersFile& layers, const run::LoadedVolume& loaded) {
    const std::string warning = run::layers_warning(layers, loaded);
    if (!warning.empty()) fmt::print(stderr, "palpate: warning: {}\n", warning);
}

double required_isovalue(const run::LoadedVolume& loaded, const Field& field,
                         const run::FieldSetup& setup) {
    if (!setup.isovalue && !loaded.isovalue) {
        throw std::invalid_argument(
            fmt::format("--isovalue is needed: which level of {} to feel; palpate info {} suggests "
                        "some",
                        loaded.name, loaded.name));
    }
    return suggested_isovalue(loaded, field, setup);
}

double required_isovalue(const run::LoadedVolume& loaded, const Field& field,
                         const run::FieldSetup& setup, const run::RenderSetup& render) {
    const auto& layers = render.layers;
    if (!layers || layers->layers.layers.empty()) return required_isovalue(loaded, field, setup);
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

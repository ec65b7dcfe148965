// palpate convert: any volume as multiscale OME-Zarr or as another file, in bounded memory.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/options/no_effect.hpp"
#include "apps/options/say.hpp"
#include "apps/options/source_options.hpp"
#include "apps/options/values.hpp"
#include "apps/options/words.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/written_formats.hpp"
#include "palpate/stream/convert.hpp"

namespace palpate::app {
namespace {

struct ConvertWords {
    SourceOptions source;
    std::string output;
    std::string ome_version = "0.5";
    bool compress = false;
    bool json = false;
    stream::ConvertOptions zarr;
};

/// A store, the level of it that is taken, and what else the source has.
struct Taken {
    std::shared_ptr<const stream::Store> store;
    int level = 0;
    int frames = 1;
};

/// The store that a source can be read as; nothing: it is loaded.
std::optional<run::StoreSource> store_of(const run::Source& source) {
    if (source.smooth > 0 || source.dequantize > 0 || source.prefilter) return std::nullopt;
    if (const auto* store = std::get_if<run::StoreSource>(&source.from)) {
        if (store->all_times) {
            throw std::invalid_argument(
                "only one time can be converted: choose it with --time-step");
        }
        run::StoreSource taken = *store;
        if (taken.loader.whole_process) taken.options.unpacking = taken.loader.memory / 2;
        return taken;
    }
    const auto* file = std::get_if<run::FileSource>(&source.from);
    if (!file) return std::nullopt;
    run::StoreSource store{file->path, {}, {}};
    store.options.raw = file->raw;
    store.options.spacing = file->spacing;
    store.options.orientation = file->orientation;
    if (!stream::is_store(file->path, store.options)) return std::nullopt;
    return store;
}

/// Null for files that are read as a whole, such as TIFF with some kinds of tiles.
std::shared_ptr<const stream::Store> opened_store(const ConvertWords& words,
                                                  const run::Source& source,
                                                  const run::StoreSource& from) {
    ProgressBar bar("opening", words.source.quiet);
    try {
        return stream::open_store(from.address, from.options,
                                  [&](double fraction) { bar.at(fraction); });
    } catch (const io::InputError&) {
        if (!std::holds_alternative<run::FileSource>(source.from)) throw;
        return nullptr;
    }
}

/// Leaves a source where it is if it can be read box by box, and loads any other one.
Taken opened(const CLI::App& command, const ConvertWords& words) {
    const run::Source source = words.source.source();
    auto from = store_of(source);
    if (from) from->options.time = source.frame.value_or(0);
    if (auto store = from ? opened_store(words, source, *from) : nullptr) {
        words.source.warn_of_no_effect(source);
        const std::string name = io::without_secrets(name_of(source));
        warn_of_no_effect(command, {"--series"}, name + " is not a DICOM series");
        warn_of_no_effect(command, {"--frame-interval"}, "a single frame is converted");
        if (store->info().times < 2) {
            warn_of_no_effect(command, {"--time-step"}, name + " has a single frame");
        }
        if (!words.source.quiet) {
            for (const std::string& note : store->info().notes) {
                say("palpate: note: {}: {}\n", from->address, note);
            }
        }
        const int frames = store->info().times;
        return {std::move(store), from->loader.level, frames};
    }
    run::LoadedVolume loaded = load_for_terminal(words.source);
    return {stream::store_of(loaded.volume, loaded.name), 0, loaded.time_steps};
}

/// Notes what the output lacks of the source, unless the user chose it.
void note_losses(const CLI::App& command, const ConvertWords& words, const Taken& taken) {
    if (words.source.quiet) return;
    const auto note = [&](const std::string& text) {
        say("palpate: note: {}: {}\n", words.source.name(), text);
    };
    if (taken.frames > 1 && command.count("--time-step") == 0) {
        note(fmt::format("only the first of its {} frames is converted (--time-step)",
                         taken.frames));
    }
    const std::size_t channels = taken.store->info().channels.size();
    if (channels > 1 && command.count("--channel") == 0) {
        note(fmt::format("only the first of its {} channels is converted (--channel)", channels));
    }
    if (words.source.name().ends_with(".seg.nrrd")) {
        note("names and colours of its segments are not converted");
    }
    const bool oriented = taken.store->info().levels.front().geometry.oriented;
    const auto extension = io::written_extension_of(words.output);
    if (!oriented && (extension == ".nii" || extension == ".nii.gz")) {
        note("its orientation is not known, which NIfTI cannot say: " + words.output +
             " has the axes L, P and S");
    }
}

void to_zarr(const ConvertWords& words, const Taken& taken) {
    stream::ConvertOptions options = words.zarr;
    options.zarr_version = words.ome_version == "0.4" ? 2 : 3;
    stream::Converted converted;
    {
        ProgressBar bar("converting", words.source.quiet);
        options.progress = [&](double fraction) { bar.at(fraction); };
        converted = stream::convert_to_zarr(*taken.store, taken.level, words.output, options);
    }
    if (!converted.note.empty() && !words.source.quiet) {
        say("palpate: note: {}\n", converted.note);
    }
    if (words.json) {
        print_json({{"format", "OME-Zarr " + words.ome_version},
                    {"levels", converted.levels},
                    {"chunks", converted.chunks},
                    {"kept", converted.kept},
                    {"empty", converted.empty},
                    {"minimum", converted.range.minimum},
                    {"maximum", converted.range.maximum}});
    } else if (!words.source.quiet) {
        fmt::print("{}: OME-Zarr {}, {}, {} ({} kept from before, {} empty)\n", words.output,
                   words.ome_version,
                   counted(static_cast<std::uint64_t>(converted.levels), "level"),
                   counted(converted.chunks, "chunk"), converted.kept, converted.empty);
    }
}

void to_file(const ConvertWords& words, const Taken& taken) {
    ProgressBar bar("converting", words.source.quiet);
    io::WriteOptions options;
    options.compress = words.compress;
    options.progress = [&](double fraction) { bar.at(fraction); };
    stream::write_plain(*taken.store, taken.level, words.output, options);
    const Index3& size = stream::level_of(*taken.store, taken.level).geometry.size;
    if (words.json) {
        print_json({{"format", std::string(io::written_extension_of(words.output))}});
    } else if (!words.source.quiet) {
        fmt::print("{}: {} x {} x {} samples\n", words.output, size[0], size[1], size[2]);
    }
}

void convert(const CLI::App& command, const ConvertWords& words) {
    check_volume_name(words.output);
    check_outputs({words.source.name()}, {words.output});
    const bool zarr = io::without_slash(words.output).extension() == ".zarr";
    if (zarr) {
        stream::check_zarr_place(words.output);
        warn_of_no_effect(command, {"--compress"}, "--compression is for the chunks of OME-Zarr");
    } else {
        warn_of_no_effect(command, {"--ome-version", "--chunk", "--compression", "--threads"},
                          words.output + " is not OME-Zarr");
        const std::string why = io::why_not_compressed(words.output);
        if (!why.empty()) warn_of_no_effect(command, {"--compress"}, why);
    }
    const Taken taken = opened(command, words);
    (void)stream::level_of(*taken.store, taken.level);  // throws where there is none
    note_losses(command, words, taken);
    zarr ? to_zarr(words, taken) : to_file(words, taken);
    stop_if_interrupted();
}

}  // namespace

void add_convert(CLI::App& app) {
    auto words = std::make_shared<ConvertWords>();
    CLI::App* command =
        app.add_subcommand("convert", "Write a volume as multiscale OME-Zarr or as another file");
    command->footer(
        "OUT is a folder *.zarr, or a file of any format that is written. VOLUME may also be a\n"
        "*.zarr or *.n5 folder, an http://, https:// or s3:// address of one, or a file of Imaris\n"
        "(.ims), BigDataViewer (.h5) or tiled TIFF. OME-Zarr grows in OUT.partial; the same "
        "command\n"
        "continues after an interruption.\n\n"
        "Example:\n  palpate convert head.nrrd head.zarr --ome-version 0.4");
    words->source.add_to(*command, SourceOptions::For::conversion);
    command->add_option("OUT", words->output, "Folder *.zarr, or file to write")
        ->type_name(file_of(io::written_extensions()))
        ->required();
    command
        ->add_option("--ome-version", words->ome_version,
                     "Version of OME-Zarr: 0.4 (Zarr 2) or 0.5 (Zarr 3)")
        ->check(one_of({"0.4", "0.5"}))
        ->capture_default_str();
    command->add_option("--chunk", words->zarr.chunk, "Samples per chunk along each axis")
        ->check(from_to(8, 512))
        ->capture_default_str();
    add_named(*command, "--compression", words->zarr.compression,
              "Compression of chunks: none, gzip, zstd or blosc");
    command->add_flag("--compress", words->compress, "Compress the samples of other formats");
    command
        ->add_option("--threads", words->zarr.threads,
                     "Number of threads that read, pack and write chunks")
        ->check(from_to(1, 256))
        ->capture_default_str();
    command->add_flag("--json", words->json, "Print the summary as JSON");
    command->callback([words, command] { convert(*command, *words); });
}

}  // namespace palpate::app

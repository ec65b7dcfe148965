// Draws the progress bar; loads volumes with one.
#include "apps/palpate/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "apps/options/say.hpp"
#include "apps/palpate/commands.hpp"
#include "palpate/io/error.hpp"

namespace palpate::app {
namespace {

using namespace std::chrono_literals;
constexpr auto patience = 400ms;  // shorter work shows no bar
constexpr auto redraw = 100ms;
constexpr int width = 30;

}  // namespace

ProgressBar::ProgressBar(std::string label, bool quiet)
    : label_(io::without_secrets(std::move(label))),
      begin_(std::chrono::steady_clock::now()),
      last_(begin_),
      show_(!quiet && ::isatty(STDERR_FILENO)) {}

ProgressBar::~ProgressBar() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::at(double fraction) {
    stop_if_interrupted();
    const auto now = std::chrono::steady_clock::now();
    if (!show_ || now - begin_ < patience || now - last_ < redraw) return;
    last_ = now;
    drawn_ = true;
    const double part = std::clamp(fraction, 0.0, 1.0);
    const int full = static_cast<int>(part * width);
    const std::string line = fmt::format("\r{} [{:#<{}}{:.<{}}] {:3.0f} %", label_, "", full, "",
                                         width - full, 100 * part);
    std::fputs(line.c_str(), stderr);
}

run::LoadedVolume load_for_terminal(const SourceOptions& options) {
    const run::Source source = options.source();
    options.warn_of_no_effect(source);
    run::LoadedVolume loaded = load_for_terminal(source, options.quiet);
    options.warn_of_no_effect(loaded);
    return loaded;
}

run::LoadedVolume load_for_terminal(const run::Source& source, bool quiet) {
    ProgressBar bar("reading " + name_of(source), quiet);
    run::LoadedVolume loaded = run::load(source, [&](double fraction) { bar.at(fraction); });
    if (!quiet) {
        for (const std::string& note : loaded.notes) {
            say("palpate: note: {}: {}\n", loaded.name, note);
        }
    }
    return loaded;
}

run::LoadedVolume load_whole(const SourceOptions& options) {
    run::LoadedVolume loaded = load_for_terminal(options);
    if (!loaded.streamed) return loaded;
    if (!options.has_level()) {
        if (!options.quiet) {
            say("palpate: note: {}: its surface is that of this overview (--level N takes a level "
                "as a whole)\n",
                loaded.name);
        }
        return loaded;
    }
    const auto& [store, loader, opened] = *loaded.streamed;
    const Geometry& grid = stream::level_of(*store, loader.level).geometry;
    const double bytes =
        static_cast<double>(sample_count(grid)) * static_cast<double>(size_of(store->info().type));
    if (options.memory && bytes > static_cast<double>(*options.memory)) {
        throw io::InputError(
            fmt::format("{}: level {} needs {:.0f} MB; allow more memory, or take "
                        "a coarser one",
                        loaded.name, loader.level, bytes / 1e6));
    }
    ProgressBar bar("reading " + loaded.name, options.quiet);
    loaded.volume =
        stream::read_level(*store, loader.level, [&](double fraction) { bar.at(fraction); });
    return loaded;
}

std::string dequantize_suggestion(const std::optional<filters::Terraces>& terraces) {
    if (!terraces || !terraces->wide()) return {};
    const bool is_usual = terraces->rounds() == filters::DequantizeOptions{}.rounds;
    return fmt::format("--dequantize{}: {}", is_usual ? "" : fmt::format("={}", terraces->rounds()),
                       filters::reason_to_dequantize(*terraces));
}

void note_terraces(const run::LoadedVolume& loaded) {
    const run::Source& source = loaded.source;
    if (source.dequantize > 0 || source.smooth > 0 || loaded.streamed || loaded.live) return;
    const std::string suggestion =
        dequantize_suggestion(filters::terraces_of(loaded.volume, stop_if_interrupted));
    if (suggestion.empty()) return;
    say("palpate: note: {}: try {}\n", loaded.name, suggestion);
}

}  // namespace palpate::app

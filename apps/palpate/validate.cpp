// palpate replay RECORDING --validate.
#include "apps/palpate/validate.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "apps/palpate/progress.hpp"
#include "palpate/run/replay.hpp"

namespace palpate::app {
namespace {

/// Other reasons why a tick may differ; reads on to the end of the recording.
std::string excuses(io::RecordingReader& reader) {
    std::string words;
    if (reader.head().version != PALPATE_VERSION) {
        words +=
            " (recorded with version " + reader.head().version + ", this is " PALPATE_VERSION ")";
    }
    while (reader.next()) {
    }
    if (reader.lost() > 0) {
        words += fmt::format(" (the recording lost {} events while it was made)", reader.lost());
    }
    return words;
}

}  // namespace

void validate(const std::string& recording, const std::string& volume, bool quiet) {
    io::RecordingReader reader{std::filesystem::path(recording)};
    const run::LoadedVolume loaded =
        load_for_terminal(run::recorded_source(reader.head(), recording, volume), quiet);
    run::Replay replay(reader, loaded, recording);
    ProgressBar bar("validating", quiet);
    while (const auto tick = replay.next()) {
        if (const auto differs = run::difference(tick->recorded, tick->again)) {
            throw io::InputError(
                fmt::format("{}: tick {} (line {}, {} s) differs: {}: recorded {}, "
                            "now {}{}",
                            recording, tick->number, reader.line(), tick->recorded.tick.time,
                            differs->part, differs->recorded, differs->again, excuses(reader)));
        }
        if (replay.ticks() % 1024 == 0) bar.at(reader.progress());
    }
    if (quiet) return;
    fmt::print("{}: {} ticks and {} commands, rendered again, are the same bit for bit\n",
               recording, replay.ticks(), replay.commands());
    if (reader.lost() > 0) {
        fmt::print("the recording lost {} events while it was made\n", reader.lost());
    }
    if (!reader.complete()) fmt::print("the recording was cut off before its end\n");
}

}  // namespace palpate::app

// Renders all hands of a recording again, and says where a tick differs.
#include "io/system/number.hpp"
#include "palpate/run/replay.hpp"

namespace palpate::run {
namespace {

/// Other reasons why a tick may differ; reads on to the end of the recording.
std::string excuses(io::RecordingReader& reader) {
    std::string words;
    const std::string& version = reader.head().version;
    if (version != PALPATE_VERSION) {
        words += " (recorded with version " + version + ", this is " PALPATE_VERSION ")";
    }
    while (reader.next()) {
    }
    if (reader.lost() == 0) return words;
    return words + " (the recording lost " + std::to_string(reader.lost()) +
           " events while it was made)";
}

/// Throws io::InputError.
[[noreturn]] void refuse(io::RecordingReader& reader, const Replay::Tick& tick,
                         const Difference& differs, const std::string& where) {
    std::string seconds;
    io::append_number(seconds, tick.recorded.tick.time);
    const std::string line = std::to_string(reader.line());
    throw io::InputError(where + "tick " + std::to_string(tick.number) + " (line " + line + ", " +
                         seconds + " s) differs: " + differs.part + ": recorded " +
                         differs.recorded + ", now " + differs.again + excuses(reader));
}

}  // namespace

std::vector<ValidatedHand> validate(const std::string& text, const std::string& recording,
                                    const LoadedVolume& loaded, const OnProgress& progress) {
    constexpr std::int64_t ticks_between_progress = 1024;
    std::vector<ValidatedHand> hands;
    for (int number = 1, count = 1; number <= count; ++number) {
        io::RecordingReader reader(text, recording, number);
        count = reader.hands();
        const std::string hand = count > 1 ? "hand " + std::to_string(number) + ", " : "";
        const auto tell = [&] {
            if (progress) progress((number - 1 + reader.progress()) / count);
        };
        Replay replay(reader, loaded, recording, tell);
        while (const auto tick = replay.next()) {
            if (const auto differs = difference(tick->recorded, tick->again)) {
                refuse(reader, *tick, *differs, recording + ": " + hand);
            }
            if (replay.ticks() % ticks_between_progress == 0) tell();
        }
        hands.push_back({hand, replay.ticks(), replay.commands(), reader.lost(), reader.complete(),
                         reader.has_checksums()});
    }
    return hands;
}

}  // namespace palpate::run

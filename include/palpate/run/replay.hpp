// Renders a recording again, tick by tick, without device and servo.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/io/recording.hpp"
#include "palpate/progress.hpp"
#include "palpate/run/recorded_samples.hpp"
#include "palpate/run/source.hpp"

namespace palpate::run {

/// The volume of a recording: its recorded name, in the working folder or else in the folder of the
/// recording, or `instead` unless that is empty. Throws io::InputError for a live source, whose
/// frames are not in the recording.
Source recorded_source(const io::RecordingHead& head, const std::filesystem::path& recording,
                       const std::string& instead = {});

/// The session of a recording before its first tick. Throws io::InputError if the volume is not the
/// one that was recorded (size, type or samples), or if the settings in the head cannot be
/// rendered. Exceptions of `progress` are passed on.
Session recorded_session(const io::RecordingHead& head, const LoadedVolume& loaded,
                         const std::string& recording, const OnProgress& progress = {});

/// The first part of a tick that differs from the recording.
struct Difference {
    std::string part;  ///< "HIP", "force", ...
    std::string recorded, again;
};
/// Compares bit by bit, but all NaN are equal (text keeps no payload). Nothing: the ticks are the
/// same.
std::optional<Difference> difference(const SessionTick& recorded, const SessionTick& again);

class Replay {
  public:
    /// `reader` is before the first event and outlives this. `tell` is called repeatedly while the
    /// volume is compared and while next() waits for samples of a store, and may throw to stop.
    /// Throws as recorded_session().
    Replay(io::RecordingReader& reader, const LoadedVolume& loaded, std::string recording,
           std::function<void()> tell = {});

    struct Tick {
        SessionTick recorded, again;
        std::int64_t number;  ///< from 0
    };
    /// Executes the commands up to the next tick and renders that; nothing at the end. Throws
    /// io::InputError for a damaged line and for a command that cannot be executed.
    std::optional<Tick> next();

    /// The session after the last tick.
    const Session& session() const { return session_; }
    /// Versions of the samples up to the last tick.
    RecordedSamples& samples() { return samples_; }
    std::int64_t ticks() const { return ticks_; }
    std::int64_t commands() const { return commands_; }

  private:
    void carry_out(const Command& recorded);

    io::RecordingReader& reader_;
    const LoadedVolume loaded_;
    std::string recording_;
    Session session_;
    RendererSettings start_;
    RecordedSamples samples_;
    std::int64_t ticks_ = 0, commands_ = 0;
};

/// A hand of a recording that was rendered again, with the same result.
struct ValidatedHand {
    std::string words;  ///< "hand 1, ", or empty for the only one
    std::int64_t ticks, commands;
    std::int64_t lost;   ///< events that the recording lost while it was made
    bool complete;       ///< false: it was cut off before its end
    bool has_checksums;  ///< false: an earlier version made it
};
/// Renders every tick of all hands of a recording again and compares it bit for bit, except for the
/// times of updates. `text` is its content, `recording` its name, `loaded` the volume of
/// recorded_source(). Throws io::InputError that names the first difference, and as Replay does.
/// `progress` may throw to stop.
std::vector<ValidatedHand> validate(const std::string& text, const std::string& recording,
                                    const LoadedVolume& loaded, const OnProgress& progress = {});

}  // namespace palpate::run

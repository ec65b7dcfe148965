// What people and scripts ask of a live session: words in a file, and keys.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/palpate/data_commands.hpp"
#include "palpate/servo.hpp"

namespace palpate::app {

/// What a word or a key may do besides a Command of the session.
struct Quit {};
struct Help {};
using Request = std::variant<Command, DataRequest, Quit, Help>;

/// Turns words into requests. Knows the data's units, and what was asked before, since words change
/// one setting at a time.
class LiveCommands {
  public:
    LiveCommands(const Field& field, double isovalue, const RendererSettings& settings);

    /// `isovalue 300`, `isovalue 53%`, `stiffness 0.5`, `damping 0.001`, `viscosity 0`,
    /// `friction 0.3,0.2`, `penetrability off`, `penetrability threshold PT [MINIMUM]`,
    /// `penetrability ranges PT LOW:HIGH ...`, `forces on|off`, `freeze on|off`, `clutch on|off`,
    /// `scale 1.5`, `quit`; and those of data_request(). Throws std::invalid_argument, saying what
    /// was meant to be there.
    Request from_words(std::string_view line);

    /// What a key does now; nothing for a key without a meaning. See key_help().
    std::optional<Request> from_key(char key, const Snapshot& now);
    static std::string key_help();

  private:
    Penetrability penetrability_from(const std::vector<std::string>& words) const;

    Field field_;
    double isovalue_;
    RendererSettings settings_;
    std::optional<Penetrability> penetrability_;  // to switch on again; the plain one if none
    std::optional<HandBrush> brush_;              // in the hand, and the one to take up again
    std::optional<HandBrush> last_brush_;
};

/// A request and when [s] it is due.
struct TimedRequest {
    double time;
    Request request;
};
/// Lines `SECONDS WORDS`, in order of time; # begins a comment. Throws io::InputError with the line
/// for what is not understood.
std::vector<TimedRequest> read_commands(const std::string& path, LiveCommands& commands);

}  // namespace palpate::app

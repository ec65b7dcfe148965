// Commands of people and scripts for a live run: words in a file, and keys.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/palpate/data_commands.hpp"
#include "palpate/servo.hpp"

namespace palpate::app {

/// Requests that are no Command of the session.
struct Quit {};
struct Help {};
using Request = std::variant<Command, DataRequest, Quit, Help>;

/// Turns words into requests. Knows the data's units and the settings so far, since words change
/// one setting at a time.
class LiveCommands {
  public:
    /// The data of `run` must live as long as this.
    explicit LiveCommands(const run::Run& run);

    /// `isovalue 300`, `isovalue 53%`, `stiffness 0.5`, `damping 0.001`, `viscosity 0`,
    /// `friction 0.3,0.2`, `penetrability off`, `penetrability threshold PT [MINIMUM]`,
    /// `penetrability ranges PT LOW:HIGH ...`, `layers off`, `layers FILE|NAME`, `forces on|off`,
    /// `freeze on|off`, `clutch on|off`, `scale 1.5`, `quit`; and those of data_commands.hpp.
    /// Throws std::invalid_argument, saying what was expected, and io::OutputError for a file that
    /// could not be saved now.
    Request from_words(std::string_view line);

    /// The request of a key; nothing for a key without a meaning. See key_help().
    std::optional<Request> from_key(char key, const Snapshot& now);
    static std::string key_help();

  private:
    Penetrability penetrability_from(const CommandWords& words) const;
    Command layers_from(const CommandWords& words);
    Command use_layers(std::shared_ptr<const Layers> layers);
    Command setting_from(const CommandWords& words, RendererSettings& next) const;
    DataRequest take_up(const std::optional<run::HandBrush>& brush);

    const run::Data* data_;
    Field field_;
    double isovalue_;
    RendererSettings settings_;
    std::optional<Penetrability> penetrability_;  // to switch on again; nothing: a plain threshold
    std::shared_ptr<const Layers> last_layers_;   // to switch on again
    std::optional<run::HandBrush> brush_;         // in use
    std::optional<run::HandBrush> last_brush_;    // to take up again
};

/// A request and when [s] it is due.
struct TimedRequest {
    double time;
    Request request;
};
/// One of several hands.
struct WhichHand {
    int number = 1;  ///< from 1
    int count = 1;
};
/// Lines `SECONDS WORDS`, in order of time; # begins a comment. Those of a hand: `SECONDS hand N
/// WORDS` are the hand's that they name, the others are for all hands, but what is done once, as
/// edits, is the first one's. Throws io::InputError with the line for words that are not
/// understood, and io::OutputError for a file that could not be saved now.
std::vector<TimedRequest> read_commands(const std::string& path, LiveCommands& commands,
                                        const WhichHand& hand = {});

}  // namespace palpate::app

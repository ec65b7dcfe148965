// Commands of people and scripts for the data of a live run: edits of a volume, playback of a
// sequence.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "palpate/run/run.hpp"

namespace palpate::app {

/// Throws std::invalid_argument, saying which words were expected.
[[noreturn]] void wrong_words(const std::string& meant);

namespace ask {
struct SetBrush {
    std::optional<run::HandBrush> brush;  ///< nothing: off
};
/// One stroke of a brush, at the level felt when it is carried out.
struct Touch {
    run::HandBrush brush;  ///< its rate does not matter: the stroke is done at once
    Vec3 from, to;         ///< [mm, physical]
};
struct Fill {
    edit::Fill fill;
};
struct Undo {};
struct Redo {};
struct Save {
    std::string path;
};
struct Play {
    double speed;  ///< 0: pause
};
struct Step {
    int frames;  ///< on, or back if negative
};
struct Seek {
    double time;  ///< [s]
};
struct Loop {
    bool on;
};
}  // namespace ask
using DataRequest = std::variant<ask::SetBrush, ask::Touch, ask::Fill, ask::Undo, ask::Redo,
                                 ask::Save, ask::Play, ask::Step, ask::Seek, ask::Loop>;

/// `brush KIND RADIUS [RATE [VALUE]]`, `brush off`, `carve|add|smooth|paint X,Y,Z[:X,Y,Z] RADIUS
/// [VALUE]`, `fill I,J,K[:I,J,K] VALUE`, `undo`, `redo`, `save FILE`, `play [SPEED]`, `pause`,
/// `step [FRAMES]`, `seek SECONDS`, `loop on|off`. Nothing for other words; throws
/// std::invalid_argument, saying what was expected.
std::optional<DataRequest> data_request(const std::vector<std::string>& words,
                                        const Volume& volume);

/// Carries out a request at the level `isovalue`, on the field felt; returns a sentence for the
/// person who asked, or nothing. Throws std::invalid_argument for a request that the data cannot
/// fulfil, io::OutputError and io::InputError. Any thread.
std::string carry_out(const DataRequest& request, run::Data& data, const Field& field,
                      double isovalue);

}  // namespace palpate::app

// What people and scripts ask of the data in a live session: edits of a volume, and how a sequence
// is played.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/live/data_in_hand.hpp"

namespace palpate::app {

/// Throws std::invalid_argument: words are not what they are meant to be.
[[noreturn]] void wrong_words(const std::string& meant);

namespace ask {
struct SetBrush {
    std::optional<HandBrush> brush;  ///< none: off
};
/// One stroke of a brush, at the level that is felt when it is carried out.
struct Touch {
    HandBrush brush;  ///< its rate does not matter: all of it at once
    Vec3 from, to;    ///< [mm, physical]
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
    double speed;  ///< 0: stand still
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
/// std::invalid_argument, saying what was meant to be there.
std::optional<DataRequest> data_request(const std::vector<std::string>& words,
                                        const Volume& volume);

/// Carries out a request; gives a sentence for the person who asked, or nothing. Throws
/// std::invalid_argument for what the data cannot do, io::OutputError and io::InputError.
std::string carry_out(const DataRequest& request, DataInHand& data, const Snapshot& now);

}  // namespace palpate::app

// Options and arguments that change nothing beside the others. The command line warns of them, and
// the Python module refuses them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "palpate/run/setup.hpp"

namespace palpate::run {

/// Options that change nothing, whether they were given or not.
struct NoEffect {
    /// As in Python: "frame_interval". On the command line, this is --frame-interval.
    std::vector<std::string> names;
    std::string why;  ///< "heart.nrrd is not a sequence"
};

/// "series, frame_interval do nothing: WHY". Empty if `given` is.
std::string no_effect_text(const std::vector<std::string>& given, const std::string& why);

/// Options that a source of this kind does not use.
std::vector<NoEffect> without_effect(const Source& source);
/// Options that this volume does not use. That is known only after it was loaded.
std::vector<NoEffect> without_effect(const LoadedVolume& loaded);
/// Arguments and commands that these samples do not use.
std::vector<NoEffect> without_effect(const Samples& samples);
/// Options that these settings do not use.
std::vector<NoEffect> without_effect(const RenderSetup& setup);
/// The same for a replay, in which nobody changes the tool and the hand never pauses.
std::vector<NoEffect> without_effect_in_replay(const RenderSetup& setup);

/// Arguments by their names, and whether they were given.
using Given = std::map<std::string, bool>;
/// Throws std::invalid_argument, with no_effect_text(), for given ones that change nothing.
void refuse_without_effect(const std::vector<NoEffect>& all, const Given& given);

}  // namespace palpate::run

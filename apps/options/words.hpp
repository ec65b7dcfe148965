// Durations and force flags as text, for the terminal's line and the window.
#pragma once

#include <cstdint>
#include <string>

#include "palpate/renderer.hpp"

namespace palpate::app {

/// A duration as people read it: 850 ns, 12.4 us, 3.1 ms.
std::string duration_text(std::int64_t ns);

/// "1 level", "2 levels".
std::string counted(std::uint64_t count, const std::string& thing);

/// What a force is held back by, in words; empty for a force that is simply rendered.
std::string force_words(const Tick& tick);

}  // namespace palpate::app

// Demos of data that change under the hand: `palpate demo sculpt` and `palpate demo beating`.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate::app {

void add_demo_sculpt(CLI::App& demo);
void add_demo_beating(CLI::App& demo);

}  // namespace palpate::app

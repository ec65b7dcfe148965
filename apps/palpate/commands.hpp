// The commands of the program `palpate`, one file each. Every add_*() declares a subcommand with
// its options. The command runs in CLI11's callback and reports problems by throwing.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/options/interruption.hpp"

namespace palpate::app {

void add_info(CLI::App& app);
struct Words;  // window.hpp
void add_touch(CLI::App& app, const Words& words);
void add_view(CLI::App& app, const Words& words);
void add_record(CLI::App& app);
void add_devices(CLI::App& app);
void add_doctor(CLI::App& app);
void add_replay(CLI::App& app);
void add_extract(CLI::App& app);
void add_convert(CLI::App& app);
void add_render(CLI::App& app);
void add_tool(CLI::App& app);
void add_demo(CLI::App& app);
void add_demo_sculpt(CLI::App& demo);
void add_demo_beating(CLI::App& demo);

}  // namespace palpate::app

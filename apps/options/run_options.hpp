// The options of a live run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/options/render_options.hpp"
#include "apps/options/source_options.hpp"

namespace palpate::app {

struct RunOptions {
    SourceOptions source;
    RenderOptions render;
    run::Setup given;                            ///< but for `render` and `device`: take setup()
    std::vector<devices::DeviceChoice> devices;  ///< of the hands; none: one with `given.device`
    /// Those of `given` that the command line names.
    std::vector<run::ButtonSetup run::Buttons::*> named_buttons;
    std::string record, commands;
    double seconds = 0;  ///< 0: until the hand has finished or the run is stopped
    std::string brush;   ///< as the command's words: "carve 3"; empty: none
    std::string save;    ///< file for the edited volume; empty: none
    bool json = false;
    bool unpaced = false;  ///< as fast as the session can be computed

    /// `record` has --output in place of --record; `view` can do without a volume, and has no
    /// options for scripts (--commands, --seconds, --json).
    enum class For { touch, record, view };
    void add_to(CLI::App& command, For purpose);
    /// Once the command line has been read: how each hand feels. Throws std::invalid_argument.
    std::vector<run::Setup> setups() const;

    /// Options that have their effect also with the settings of a session file.
    std::vector<std::string> beside_session() const;

  private:
    void add_device_options(CLI::App& command);
    void add_script_options(CLI::App& command);
    void add_data_options(CLI::App& command);
};

}  // namespace palpate::app

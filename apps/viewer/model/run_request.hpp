// What the command line asks of the runs to come.
#pragma once

#include <optional>
#include <string>

#include "palpate/run/setup.hpp"

namespace palpate::viewer {

struct RunRequest {
    run::Setup setup;
    /// The device asked for: it is used instead of the one in a session file.
    std::optional<devices::DeviceChoice> device;
    std::string record;  ///< recording to write; empty: none
};

}  // namespace palpate::viewer

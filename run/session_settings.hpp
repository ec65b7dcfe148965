// The settings of a session for one device. Private to run/.
#pragma once

#include "palpate/run/setup.hpp"

namespace palpate::run {

/// Those of the setup, with the bits of this device's buttons. Throws std::invalid_argument for a
/// button that the device does not have, and for one with both purposes.
SessionSettings session_settings(const Setup& setup, const DeviceInfo& info);

}  // namespace palpate::run

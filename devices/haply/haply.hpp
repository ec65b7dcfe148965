// Haply Inverse3, through Haply's Inverse Service (WebSocket and JSON on the loopback).
#pragma once

#include <memory>

#include "devices/haply/inverse3.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices::haply {

/// Asks at the usual address (HAPLY_WS_HOST, HAPLY_WS_PORT, otherwise 127.0.0.1:10001); takes at
/// most about 0.3 s. Never throws for what it finds. The channel keeps the time of `timing`.
DeviceFinding find(Talk talk = {}, const Timing& timing = {});

/// Connects within about a second and reads the first state of the device, whose thread is not
/// started. Connects again when the connection is lost later. Throws std::invalid_argument for
/// wrong options, DeviceError where nothing listens or the service has no such device.
std::unique_ptr<Inverse3> open(const DeviceChoice& choice, const DeviceScene& scene, Talk talk = {},
                               const Timing& timing = {});

}  // namespace palpate::devices::haply

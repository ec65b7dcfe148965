// Commands to a running session, as Python gives them.
#pragma once

#include "bindings/python/setup.hpp"
#include "palpate/session.hpp"

namespace palpate::python {

/// What can be sent: a command of palpate.command, or settings that replace those in use.
using Sent = std::variant<command::Isovalue, command::Freeze, command::Clutch, command::Forces,
                          command::Scale, command::Samples, command::Moment, command::Speed,
                          command::UseLayers, command::UseTool, command::Lift, AskedForce, Friction,
                          DeviceTransform, DeviceLimits, PressThrough>;

/// Throws std::invalid_argument. `isovalue`: least level where a Penetrability gives none; `usual`:
/// forces where ForceSettings leave them open.
Command command_of(const Sent& sent, const Field& field, double isovalue,
                   const ForceSettings& usual);

}  // namespace palpate::python

// Includes the whole core, in the order of the flow of data. One tick:
//
//   volume -> samples -> field -> lattice, cubic --> proxy, layers -> force -> device
//                edit --^                  tool --> tool_proxy ----^
//
//   renderer: one call for all from proxy to force, with a point, with layers or with a tool
//   session: a renderer with clutch, freeze and commands
//   servo: the thread that runs a session with a device
//   exchange: how other threads take part
//
// surface (the whole isosurface as a mesh) observes field and lattice.
#pragma once

// The order is the flow of data, not the alphabet.
// clang-format off
#include "palpate/names.hpp"
#include "palpate/progress.hpp"
#include "palpate/volume.hpp"
#include "palpate/tool.hpp"
#include "palpate/samples.hpp"
#include "palpate/field.hpp"
#include "palpate/edit.hpp"
#include "palpate/lattice.hpp"
#include "palpate/cubic.hpp"
#include "palpate/proxy.hpp"
#include "palpate/tool_proxy.hpp"
#include "palpate/force.hpp"
#include "palpate/layers.hpp"
#include "palpate/renderer.hpp"
#include "palpate/exchange.hpp"
#include "palpate/device.hpp"
#include "palpate/session.hpp"
#include "palpate/settings.hpp"
#include "palpate/servo.hpp"
#include "palpate/surface.hpp"
// clang-format on

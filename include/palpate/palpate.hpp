// Includes the whole core, in the order of the flow of data. One tick:
//
//   volume -> samples -> field -> lattice --+
//      edit, editor --^     penetrability --+--> proxy -> force, layers -> device
//                                 renderer: one call for proxy..force, with a point or a tool
//                         tool -> tool_proxy: the proxy of a rigid body
//
// surface (the whole isosurface as a mesh) observes volume, field and lattice.
#pragma once

// The order is the flow of data, not the alphabet.
// clang-format off
#include "palpate/names.hpp"
#include "palpate/volume.hpp"
#include "palpate/tool.hpp"
#include "palpate/tool_body.hpp"
#include "palpate/pages.hpp"
#include "palpate/resident.hpp"
#include "palpate/samples.hpp"
#include "palpate/field.hpp"
#include "palpate/edit.hpp"
#include "palpate/editor.hpp"
#include "palpate/lattice.hpp"
#include "palpate/cubic.hpp"
#include "palpate/kept_piece.hpp"
#include "palpate/density.hpp"
#include "palpate/proxy.hpp"
#include "palpate/tool_proxy.hpp"
#include "palpate/penetrability.hpp"
#include "palpate/force.hpp"
#include "palpate/layers.hpp"
#include "palpate/reach.hpp"
#include "palpate/renderer.hpp"
#include "palpate/exchange.hpp"
#include "palpate/latency.hpp"
#include "palpate/device.hpp"
#include "palpate/session.hpp"
#include "palpate/servo.hpp"
#include "palpate/surface.hpp"
// clang-format on

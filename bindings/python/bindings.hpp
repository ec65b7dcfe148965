// The parts of the module. Each adds its classes and functions. In the order in which they need
// each other.
#pragma once

#include "bindings/python/casters.hpp"

namespace palpate::python {

void bind_errors();

using Bind = void(py::module_& module);
Bind bind_volumes, bind_filters, bind_files, bind_stores, bind_growing_images,
    bind_dequantize_parts, bind_fields, bind_surfaces, bind_settings, bind_layers, bind_tools,
    bind_render_setup, bind_renderer, bind_offline, bind_devices, bind_snapshots, bind_commands,
    bind_servo, bind_edits, bind_run, bind_recordings, bind_evaluation, bind_proxies,
    bind_tool_paths, bind_closed_loop, bind_scenes;

}  // namespace palpate::python

// The parts of the module. Each adds its classes and functions. In the order in which they need
// each other.
#pragma once

#include "bindings/python/casters.hpp"

namespace palpate::python {

void bind_errors();
void bind_volumes(py::module_& module);
void bind_filters(py::module_& module);
void bind_files(py::module_& module);
void bind_stores(py::module_& module);
void bind_growing_images(py::module_& module);
void bind_dequantize_parts(py::module_& module);
void bind_fields(py::module_& module);
void bind_surfaces(py::module_& module);
void bind_settings(py::module_& module);
void bind_layers(py::module_& module);
void bind_tools(py::module_& module);
void bind_render_setup(py::module_& module);
void bind_renderer(py::module_& module);
void bind_offline(py::module_& module);
void bind_devices(py::module_& module);
void bind_snapshots(py::module_& module);
void bind_commands(py::module_& module);
void bind_servo(py::module_& module);
void bind_edits(py::module_& module);
void bind_run(py::module_& module);
void bind_recordings(py::module_& module);
void bind_evaluation(py::module_& module);
void bind_proxies(py::module_& module);
void bind_tool_paths(py::module_& module);
void bind_closed_loop(py::module_& module);
void bind_scenes(py::module_& module);

}  // namespace palpate::python

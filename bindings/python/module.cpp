// The extension module palpate._palpate. Users import the package palpate (palpate/__init__.py),
// which imports this one.
#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "bindings/python/bindings.hpp"

namespace py = pybind11;

namespace {

/// Folder of the helper programs: inside the package if pip installed it, or in the prefix of the
/// installation.
std::string folder_of_helpers() {
    Dl_info info;
    if (!dladdr(reinterpret_cast<const void*>(&folder_of_helpers), &info) || !info.dli_fname) {
        return {};
    }
    const auto package = std::filesystem::absolute(info.dli_fname).parent_path();
    const auto inside = package / "libexec/palpate";
    std::error_code error;
    if (std::filesystem::is_directory(inside, error)) return inside;
    return (package / PALPATE_LIBEXEC_FROM_PYTHON).lexically_normal();
}

/// pybind11 would give memory that nothing was written to.
void* refuse_unmade(std::size_t) {
    throw py::type_error("this object was not made: call its class, not __new__()");
}

/// Objects of this module's classes that __init__() has not made are refused wherever they are
/// used.
void refuse_unmade_objects(const py::module_& module) {
    for (const auto& [name, member] : module.attr("__dict__").cast<py::dict>()) {
        if (py::isinstance<py::module_>(member)) {
            refuse_unmade_objects(member.cast<py::module_>());
        } else if (PyType_Check(member.ptr())) {
            auto* const type = reinterpret_cast<PyTypeObject*>(member.ptr());
            if (auto* const info = py::detail::get_type_info(type)) {
                info->operator_new = &refuse_unmade;
            }
        }
    }
}

}  // namespace

/// Asked for by palpate::io (docs/package.md).
extern "C" const char* palpate_helper_folder();
extern "C" const char* palpate_helper_folder() {
    static const std::string folder = folder_of_helpers();
    return folder.c_str();
}

PYBIND11_MODULE(_palpate, module) {
    using namespace palpate::python;
    module.attr("__version__") = PALPATE_VERSION;
    bind_errors();
    for (Bind* const bind : {&bind_volumes,        &bind_filters,
                             &bind_files,          &bind_stores,
                             &bind_growing_images, &bind_dequantize_parts,
                             &bind_fields,         &bind_surfaces,
                             &bind_settings,       &bind_layers,
                             &bind_tools,          &bind_render_setup,
                             &bind_renderer,       &bind_offline,
                             &bind_devices,        &bind_snapshots,
                             &bind_commands,       &bind_servo,
                             &bind_edits,          &bind_run,
                             &bind_recordings,     &bind_evaluation,
                             &bind_proxies,        &bind_tool_paths,
                             &bind_closed_loop,    &bind_scenes})
        bind(module);
    refuse_unmade_objects(module);
}

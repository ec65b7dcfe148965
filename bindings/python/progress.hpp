// Progress of long work that runs without the GIL: calls the user's function, and lets Ctrl-C stop
// the work.
#pragma once

#include <functional>

#include "bindings/python/casters.hpp"

namespace palpate::python {

/// A Python function of the fraction done, or nothing.
using ProgressFunction = std::optional<py::function>;

/// Throws what the function throws, and KeyboardInterrupt. The function has to outlive the result.
inline std::function<void(double)> progress_of(const ProgressFunction& function) {
    return [&function](double fraction) {
        const py::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (function) (*function)(fraction);
    };
}

}  // namespace palpate::python

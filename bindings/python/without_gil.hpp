// Objects that own threads which may want the GIL are destroyed without it.
#pragma once

#include <memory>
#include <utility>

#include "bindings/python/casters.hpp"

namespace palpate::python {

/// Made and destroyed without the GIL, whoever lets go of it last.
template <class T, class... Arguments>
std::shared_ptr<T> made_without_gil(Arguments&&... arguments) {
    const auto destroy = [](T* object) {
        if (PyGILState_Check()) {
            const py::gil_scoped_release unlocked;
            delete object;
        } else {
            delete object;
        }
    };
    const py::gil_scoped_release unlocked;
    return {new T(std::forward<Arguments>(arguments)...), destroy};
}

}  // namespace palpate::python

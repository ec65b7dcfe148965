// Destroys objects that own threads without holding the GIL, because those threads may want it.
#pragma once

#include <memory>
#include <utility>

#include "bindings/python/casters.hpp"
#include "bindings/python/own_process.hpp"

namespace palpate::python {

/// Whether or not the caller has the GIL.
template <class T>
void destroy_without_gil(T* object) {
    if (!PyGILState_Check()) {
        delete object;
        return;
    }
    const GilReleased unlocked;
    delete object;
}

/// Made and destroyed without the GIL, whoever lets go of it last; never destroyed in a forked
/// child.
template <class T, class... Arguments>
std::shared_ptr<T> made_without_gil(Arguments&&... arguments) {
    const auto destroy = [process = OwnProcess()](T* object) {
        if (process.is_here()) destroy_without_gil(object);
    };
    const GilReleased unlocked;
    return {new T(std::forward<Arguments>(arguments)...), destroy};
}

/// Calls stop(object), without the GIL, when the process ends while `self` still holds the object.
template <class T, class Stop>
void stop_at_exit(const py::object& self, Stop stop) {
    const std::weak_ptr<T> held = self.cast<std::shared_ptr<T>>();
    const py::cpp_function at_exit([held, stop, process = OwnProcess()] {
        const std::shared_ptr<T> object = held.lock();
        if (!object || !process.is_here()) return;
        const GilReleased unlocked;
        stop(*object);
    });
    py::module_::import("weakref").attr("finalize")(self, at_exit);
}

}  // namespace palpate::python

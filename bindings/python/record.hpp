// Binds a plain struct as a Python class: keyword arguments for its fields, `__repr__`, pickling
// and, where the struct has it, equality. Its fields are listed in `_fields`.
#pragma once

#include <concepts>

#include "bindings/python/casters.hpp"

namespace palpate::python {

template <class T>
class Record {
  public:
    Record(py::module_& module, const char* name, const char* about)
        : class_(module, name, about) {}

    /// A member, with its unit in `about`.
    template <class Member>
    Record& field(const char* name, Member T::*member, const char* about) {
        class_.def_readwrite(name, member, about);
        names_.append(name);
        return *this;
    }
    /// A field that looks otherwise in Python: get(const T&), set(T&, value).
    template <class Get, class Set>
    Record& property(const char* name, Get get, Set set, const char* about) {
        class_.def_property(name, get, set, about);
        names_.append(name);
        return *this;
    }
    /// After all fields.
    py::class_<T> done() {
        py::class_<T> made = done_but_pickling();
        const py::tuple names(names_);
        made.def(py::pickle(
            [names](const py::object& self) {
                py::dict state;
                for (const auto& name : names) state[name] = self.attr(py::str(name));
                return state;
            },
            [](const py::dict& state) { return from_fields(state); }));
        return made;
    }
    /// The same for what is pickled otherwise.
    py::class_<T> done_but_pickling() {
        const py::tuple names(names_);
        class_.attr("_fields") = names;
        class_.def(py::init([names](const py::kwargs& given) {
            for (const auto& [name, value] : given) {
                if (!names.contains(name)) {
                    throw py::type_error(
                        std::string(py::str("no field {}; there are {}")
                                        .format(name, py::str(", ").attr("join")(names))));
                }
            }
            return from_fields(py::dict(given));
        }));
        class_.def("__repr__", [names](const py::object& self) {
            py::list parts;
            for (const auto& name : names) {
                parts.append(py::str("{}={!r}").format(name, self.attr(py::str(name))));
            }
            return py::str("{}({})").format(py::type::of(self).attr("__name__"),
                                            py::str(", ").attr("join")(parts));
        });
        class_.def("__copy__", [](const T& self) { return T(self); });
        if constexpr (std::equality_comparable<T>) {
            class_.def(
                "__eq__", [](const T& self, const T& other) { return self == other; },
                py::is_operator());
        }
        return class_;
    }

  private:
    static T from_fields(const py::dict& fields) {
        py::object made = py::cast(T{});
        for (const auto& [name, value] : fields) py::setattr(made, name, value);
        return made.cast<T>();
    }

    py::class_<T> class_;
    py::list names_;
};

}  // namespace palpate::python

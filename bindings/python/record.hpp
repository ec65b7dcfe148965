// Binds a plain struct as a Python class of settings: its fields are listed in `_fields`. Keyword
// arguments, `__repr__`, pickling, equality, and that nested settings stay one with their owner,
// come from palpate/settings.py.
#pragma once

#include "bindings/python/casters.hpp"
#include "palpate/settings.hpp"

namespace palpate::python {

/// "[N] Largest force" of a setting in a table.
template <class Owner, class Value>
std::string text_of(const Setting<Owner, Value>& setting) {
    std::string text = setting.about;
    if (*setting.unit != '\0') text = std::string("[") + setting.unit + "] " + text;
    if (*setting.left_open != '\0') text += std::string("; None: ") + setting.left_open;
    return text;
}

/// Throws std::invalid_argument for a number that the setting can never have.
template <class Owner>
void check_range(const Setting<Owner, double>& setting, double value) {
    if (setting.range.has(value)) return;
    const std::string unit = *setting.unit != '\0' ? std::string(" [") + setting.unit + "]" : "";
    throw std::invalid_argument(setting.title + unit + " = " +
                                std::string(py::str(py::float_(value))) + ": must be " +
                                setting.range.words);
}

/// Reads a member of a member: member_of(&Tick::proxy, &ProxyUpdate::scp)(tick).
template <class Owner, class First, class... Path>
auto member_of(First Owner::*first, Path... path) {
    return [=](const Owner& whole) { return ((whole.*first).*....*path); };
}

/// Adds a member of a member that cannot be set.
template <class... Options, class... Path>
void add_part(py::class_<Options...>& kind, const char* name, const char* about, Path... path) {
    kind.def_property_readonly(name, member_of(path...), about);
}

template <class T>
class Record {
  public:
    Record(py::module_& module, const char* name, const char* about)
        : class_(module, name, about, py::dynamic_attr()) {}

    /// A member, with its unit in `about`.
    template <class Owner, class Member>
    Record& field(const char* name, Member Owner::*member, const char* about) {
        class_.def_readwrite(name, member, about);
        names_.append(name);
        return *this;
    }
    /// All fields of a struct that has a table, as the table describes them.
    template <class Owner = T>
    Record& settings() {
        for_each_setting<Owner>([&](const auto& one) { setting(one); });
        return *this;
    }
    /// A field as its setting describes it, which refuses numbers out of range.
    template <class Owner, class Value>
    Record& setting(const Setting<Owner, Value>& one) {
        return field(one.name, one.member, text_of(one).c_str());
    }
    template <class Owner>
    Record& setting(const Setting<Owner, double>& one) {
        return property(
            one.name, [=](const T& whole) { return whole.*one.member; },
            [=](T& whole, double value) {
                check_range(one, value);
                whole.*one.member = value;
            },
            text_of(one).c_str());
    }
    /// A member of a member: part("solid", "Side", &Setup::field, &FieldSetup::solid).
    template <class Owner, class First, class... Path>
    Record& part(const char* name, const char* about, First Owner::*first, Path... path) {
        using Value = decltype(member_of(first, path...)(std::declval<const T&>()));
        return property(
            name, [=](const T& whole) { return member_of(first, path...)(whole); },
            [=](T& whole, Value value) { ((whole.*first).*....*path) = std::move(value); }, about);
    }
    /// A field that looks otherwise in Python: get(const T&), set(T&, value).
    template <class Get, class Set>
    Record& property(const char* name, Get get, Set set, const char* about) {
        class_.def_property(name, get, set, about);
        names_.append(name);
        return *this;
    }
    /// A field that palpate/settings.py makes.
    Record& alias(const char* name) {
        names_.append(name);
        return *this;
    }
    /// After all fields.
    py::class_<T> done() {
        class_.attr("_fields") = py::tuple(names_);
        class_.def(py::init([] { return T{}; }));
        class_.def("__copy__", [](const T& self) { return T(self); });
        return class_;
    }

  private:
    py::class_<T> class_;
    py::list names_;
};

/// Copies of what never changes are the object itself.
template <class Class>
Class& copied_as_itself(Class& kind) {
    return kind.def("__copy__", [](const py::object& self) { return self; })
        .def("__deepcopy__", [](const py::object& self, const py::dict&) { return self; });
}

}  // namespace palpate::python

// Binds a plain struct as a Python class of settings: its fields are listed in `_fields`. Keyword
// arguments, `__repr__`, pickling, equality, and that nested settings stay one with their owner,
// come from palpate/settings.py.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings/python/casters.hpp"
#include "palpate/settings.hpp"
#include "palpate/tool.hpp"

namespace palpate::python {

/// "[N] Largest force" of a setting in a table.
template <class Owner, class Value>
std::string text_of(const Setting<Owner, Value>& setting) {
    std::string text = setting.about;
    if (*setting.unit != '\0') text = std::string("[") + setting.unit + "] " + text;
    if (*setting.left_open != '\0') text += std::string("; None: ") + setting.left_open;
    return text;
}

namespace ranges {
using namespace palpate::ranges;
inline constexpr ValueRange spacing = scale;
inline constexpr ValueRange speed{-1000, 1000, false, "from -1000 to 1000"};
}  // namespace ranges

/// Calls visit(number) for each number of a value. Values of other types have none.
template <class T>
requires(std::is_arithmetic_v<T> && !std::same_as<T, bool>) void each_number(T number,
                                                                             const auto& visit) {
    visit(static_cast<double>(number));
}
template <class Derived>
void each_number(const Eigen::DenseBase<Derived>& matrix, const auto& visit) {
    for (const auto number : matrix.reshaped()) visit(static_cast<double>(number));
}
void each_number(const io::Level& level, const auto& visit) {
    const auto* part = std::get_if<io::PercentOfRange>(&level);
    visit(part ? part->percent : std::get<double>(level));
}
template <class T, std::size_t size>
void each_number(const std::array<T, size>& values, const auto& visit) {
    for (const T& value : values) each_number(value, visit);
}
void each_number(const std::vector<std::pair<io::Level, io::Level>>& ranges, const auto& visit) {
    for (const auto& [low, high] : ranges) {
        each_number(low, visit);
        each_number(high, visit);
    }
}
template <class T>
concept HasNumbers = requires(const T& value) {
    each_number(value, [](double) {});
};
template <HasNumbers T>
void each_number(const std::optional<T>& value, const auto& visit) {
    if (value) each_number(*value, visit);
}

/// Throws std::invalid_argument for a number out of range, and for axes that are not orthonormal.
template <HasNumbers Value>
void check_numbers(const std::string& name, const Value& value, const ValueRange& range) {
    each_number(value, [&](double number) {
        if (range.has(number)) return;
        const py::gil_scoped_acquire gil;
        throw std::invalid_argument(name + " = " + std::string(py::str(py::float_(number))) +
                                    ": must be " + range.words);
    });
    if constexpr (std::same_as<Value, Mat3>) {
        if (!value.isUnitary(1e-4)) throw std::invalid_argument(name + " must be orthonormal");
    }
}
template <class Owner, class Value>
void check_range(const Setting<Owner, Value>& setting, const Value& value) {
    check_numbers(title_of(setting), value, setting.range);
    if constexpr (std::same_as<Value, Mat3>) {
        if (!is_rotation(value)) {
            throw std::invalid_argument(std::string(setting.title) +
                                        " must be orthonormal and must not mirror");
        }
    }
}

/// An orientation. Throws std::invalid_argument if its length is not 1, to a thousandth.
inline Quaternion unit_quaternion(const std::string& name, const Quaternion& given) {
    const double length = given.norm();
    if (std::abs(length - 1) <= 1e-3) return given.normalized();
    throw std::invalid_argument(name + " must have length 1, not " + number_text(length));
}

/// What a field is, and the range of its numbers.
struct Ranged {
    const char* about;
    ValueRange range;
};

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

/// A class of results: its members cannot be set. It is pickled by them.
template <class T>
class Result {
  public:
    Result(py::module_& module, const char* name, const char* about)
        : class_(module, name, about) {}

    /// As add_part().
    template <class Owner, class First, class... Path>
    Result& part(const char* name, const char* about, First Owner::*first, Path... path) {
        add_part(class_, name, about, first, path...);
        using Value = decltype(member_of(first, path...)(std::declval<const T&>()));
        parts_.emplace_back(name, [=](T& whole, const py::handle& value) {
            ((whole.*first).*....*path) = value.cast<Value>();
        });
        return *this;
    }
    /// After all members.
    py::class_<T>& done() {
        return class_.def(py::pickle(
            [parts = parts_](const py::object& self) {
                py::list values;
                for (const auto& [name, set] : parts) values.append(self.attr(name));
                return py::tuple(values);
            },
            [parts = parts_](const py::tuple& values) {
                T made;
                std::size_t next = 0;
                for (const auto& [name, set] : parts) set(made, values[next++]);
                return made;
            }));
    }

  private:
    py::class_<T> class_;
    std::vector<std::pair<const char*, std::function<void(T&, const py::handle&)>>> parts_;
};

template <class T>
class Record {
  public:
    Record(py::module_& module, const char* name, const char* about)
        : class_(module, name, about, py::dynamic_attr()) {}

    /// A member that has no numbers.
    template <class Owner, class Member>
    Record& field(const char* name, Member Owner::*member, const char* about) {
        static_assert(!HasNumbers<Member>, "numbers need a range");
        class_.def_readwrite(name, member, about);
        names_.append(name);
        return *this;
    }
    /// A member with numbers, with its unit in `about`.
    template <class Owner, HasNumbers Member>
    Record& field(const char* name, Member Owner::*member, const Ranged& ranged) {
        return part(name, ranged, member);
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
        if constexpr (HasNumbers<Value>) {
            return property(
                one.name, [=](const T& whole) { return whole.*one.member; },
                [=](T& whole, const Value& value) {
                    check_range(one, value);
                    whole.*one.member = value;
                },
                text_of(one).c_str());
        } else {
            return field(one.name, one.member, text_of(one).c_str());
        }
    }
    /// A member of a member: part("solid", "Side", &Setup::field, &FieldSetup::solid).
    template <class Owner, class First, class... Path>
    Record& part(const char* name, const char* about, First Owner::*first, Path... path) {
        using Value = decltype(member_of(first, path...)(std::declval<const T&>()));
        static_assert(!HasNumbers<Value>, "numbers need a range");
        return part_with(
            name, about, [](const Value&) {}, first, path...);
    }
    template <class Owner, class First, class... Path>
    Record& part(const char* name, const Ranged& ranged, First Owner::*first, Path... path) {
        const auto check = [name, range = ranged.range](const auto& value) {
            check_numbers(name, value, range);
        };
        return part_with(name, ranged.about, check, first, path...);
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
    template <class Check, class Owner, class First, class... Path>
    Record& part_with(const char* name, const char* about, Check check, First Owner::*first,
                      Path... path) {
        using Value = decltype(member_of(first, path...)(std::declval<const T&>()));
        return property(
            name, [=](const T& whole) { return member_of(first, path...)(whole); },
            [=](T& whole, Value value) {
                check(value);
                ((whole.*first).*....*path) = std::move(value);
            },
            about);
    }

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

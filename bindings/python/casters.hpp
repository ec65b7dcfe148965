// How values of Palpate look in Python: names for enumerations, arrays for vectors and quaternions,
// numbers or "53%" for levels. Every source of the module includes this.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings/python/numbers.hpp"
#include "palpate/device.hpp"
#include "palpate/edit.hpp"
#include "palpate/io/level.hpp"
#include "palpate/layers.hpp"
#include "palpate/names.hpp"

namespace palpate::python {

/// The name of a file, as os.fsdecode() gives it.
inline py::str text_of_path(const std::string& name) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeFSDefaultAndSize(name.data(), static_cast<py::ssize_t>(name.size())));
}

template <class E>
using Names = std::pair<const char*, E>;

// The names of an enumeration's values; `kind` is what messages call it.
template <class E>
struct Named;

template <>
struct Named<Solid> {
    static constexpr const char* kind = "solid";
    static constexpr Names<Solid> values[] = {{"above", Solid::above}, {"below", Solid::below}};
};
template <>
struct Named<Interpolation> {
    static constexpr const char* kind = "interpolation";
    static constexpr Names<Interpolation> values[] = {{"linear", Interpolation::linear},
                                                      {"cubic", Interpolation::cubic}};
};
template <>
struct Named<SampleType> {
    static constexpr const char* kind = "sample type";
    static constexpr Names<SampleType> values[] = {{"uint8", SampleType::uint8},
                                                   {"int16", SampleType::int16},
                                                   {"uint16", SampleType::uint16},
                                                   {"float32", SampleType::float32}};
};
template <>
struct Named<Mode> {
    static constexpr const char* kind = "mode";
    static constexpr Names<Mode> values[] = {{"free", Mode::free},
                                             {"constrained", Mode::constrained}};
};
template <>
struct Named<UpdateStatus> {
    static constexpr const char* kind = "status";
    static constexpr Names<UpdateStatus> values[] = {{"done", UpdateStatus::done},
                                                     {"out_of_budget", UpdateStatus::out_of_budget},
                                                     {"recovering", UpdateStatus::recovering},
                                                     {"refused", UpdateStatus::refused},
                                                     {"not_finite", UpdateStatus::not_finite},
                                                     {"waiting", UpdateStatus::waiting}};
};
template <>
struct Named<BrushKind> {
    static constexpr const char* kind = "brush";
    static constexpr Names<BrushKind> values[] = {{"carve", BrushKind::carve},
                                                  {"add", BrushKind::add},
                                                  {"smooth", BrushKind::smooth},
                                                  {"paint", BrushKind::paint}};
};
template <>
struct Named<Facing> {
    static constexpr const char* kind = "facing";
    static constexpr Names<Facing> values[] = {
        {"anterior", Facing::anterior}, {"posterior", Facing::posterior},
        {"left", Facing::left},         {"right", Facing::right},
        {"superior", Facing::superior}, {"inferior", Facing::inferior}};
};
template <>
struct Named<DeviceStatus> {
    static constexpr const char* kind = "device status";
    static constexpr Names<DeviceStatus> values[] = {{"starting", DeviceStatus::starting},
                                                     {"ready", DeviceStatus::ready},
                                                     {"uncalibrated", DeviceStatus::uncalibrated},
                                                     {"stale", DeviceStatus::stale},
                                                     {"lost", DeviceStatus::lost},
                                                     {"fault", DeviceStatus::fault},
                                                     {"finished", DeviceStatus::finished}};
};
template <>
struct Named<HapticProperty> {
    static constexpr const char* kind = "haptic property";
    static constexpr Names<HapticProperty> values[] = {
        {"stiffness", HapticProperty::stiffness},
        {"static_friction", HapticProperty::static_friction},
        {"dynamic_friction", HapticProperty::dynamic_friction},
        {"damping", HapticProperty::damping},
        {"viscosity", HapticProperty::viscosity},
        {"puncture_force", HapticProperty::puncture_force},
        {"drag", HapticProperty::drag}};
};

template <class E>
concept IsNamed = requires {
    Named<E>::kind;
};

template <IsNamed E>
const char* text_of(E value) {
    for (const auto& [name, known] : Named<E>::values) {
        if (known == value) return name;
    }
    return "?";
}
/// Throws std::invalid_argument, listing the names.
template <IsNamed E>
E named(const std::string& text) {
    std::vector<std::string> names;
    for (const auto& [name, value] : Named<E>::values) {
        if (text == name) return value;
        names.emplace_back(name);
    }
    throw std::invalid_argument(std::string(Named<E>::kind) + " '" + text +
                                "': " + use_one_of(names, text));
}

}  // namespace palpate::python

namespace pybind11::detail {

template <class E>
requires palpate::python::IsNamed<E>
struct type_caster<E> {
    PYBIND11_TYPE_CASTER(E, const_name("str"));

    bool load(handle source, bool) {
        if (!isinstance<str>(source)) return false;
        value = palpate::python::named<E>(source.cast<std::string>());
        return true;
    }
    static handle cast(E from, return_value_policy, handle) {
        return str(palpate::python::text_of(from)).release();
    }
};

/// Numbers x, y, z, w, as in C, C# and scipy. What has them says so in its name: orientation_xyzw.
template <>
struct type_caster<palpate::Quaternion> {
    PYBIND11_TYPE_CASTER(palpate::Quaternion, const_name("numpy.ndarray[float64[4]]"));

    bool load(handle source, bool convert) {
        make_caster<Eigen::Vector4d> numbers;
        if (!numbers.load(source, convert)) return false;
        const auto& q = cast_op<const Eigen::Vector4d&>(numbers);
        value = palpate::Quaternion(q);
        return true;
    }
    static handle cast(const palpate::Quaternion& q, return_value_policy, handle parent) {
        return make_caster<Eigen::Vector4d>::cast(q.coeffs(), return_value_policy::move, parent);
    }
};

/// A number, or text like "53%".
template <>
struct type_caster<palpate::io::Level> {
    PYBIND11_TYPE_CASTER(palpate::io::Level, const_name("Union[float, str]"));

    bool load(handle source, bool convert) {
        if (isinstance<str>(source)) {
            value = palpate::io::level_from_text(source.cast<std::string>());
            return true;
        }
        make_caster<double> number;
        if (!number.load(source, convert)) return false;
        value = cast_op<double>(number);
        return true;
    }
    static handle cast(const palpate::io::Level& from, return_value_policy, handle) {
        if (const auto* part = std::get_if<palpate::io::PercentOfRange>(&from)) {
            return (str(float_(part->percent)).attr("removesuffix")(".0") + str("%")).release();
        }
        return float_(std::get<double>(from)).release();
    }
};

}  // namespace pybind11::detail

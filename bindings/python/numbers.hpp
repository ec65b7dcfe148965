// Arrays of numbers as arguments. NumPy converts nearly anything by itself: it cuts fractions,
// wraps large numbers, drops imaginary parts and masks, and makes NaN of None. Here an argument
// either has the numbers that are asked for, or is refused.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "palpate/volume.hpp"

namespace palpate::python {

namespace py = pybind11;

/// In C order.
template <class T>
using Numbers = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// Masked elements have numbers below their mask that nobody meant, also in lists of arrays, which
/// NumPy joins without their masks. Throws std::invalid_argument.
inline void refuse_masked(py::handle given) {
    if (py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given)) {
        for (const py::handle each : given) refuse_masked(each);
        return;
    }
    if (!py::isinstance<py::array>(given) || !py::hasattr(given, "mask")) return;
    if (!py::module_::import("numpy").attr("any")(given.attr("mask")).cast<bool>()) return;
    throw std::invalid_argument(
        "the array has masked elements; give them a value first, with array.filled(value)");
}

template <class T, class From>
bool holds(From number) {
    if constexpr (std::is_floating_point_v<From>) {
        const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
        const double begin = std::is_signed_v<T> ? -end : 0;
        return number == std::trunc(number) && number >= begin && number < end;
    } else {
        return std::in_range<T>(number);
    }
}

/// Whether T holds all numbers of an array of type From.
template <class T, class From>
bool holds_some(const py::array& array) {
    const auto numbers = Numbers<From>::ensure(array);
    for (py::ssize_t i = 0; i < numbers.size(); ++i) {
        if (!holds<T>(numbers.data()[i])) return false;
    }
    return true;
}

/// The same for large ones, some rows at a time: Ctrl-C stops it, and it takes little memory.
template <class T, class From>
bool holds_all(const py::array& array) {
    if (array.dtype().is(py::dtype::of<T>())) return true;
    constexpr py::ssize_t some = 1 << 18;
    if (array.ndim() == 0 || array.size() <= some) return holds_some<T, From>(array);
    const py::ssize_t rows = array.shape(0);
    const py::ssize_t each = std::max<py::ssize_t>(1, rows * some / array.size());
    for (py::ssize_t row = 0; row < rows; row += each) {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const py::slice part(row, std::min(rows, row + each), 1);
        if (!holds_some<T, From>(py::array(array[part]))) return false;
    }
    return true;
}

/// An array of what NumPy reads, or shares by DLPack alone. Null where there is none.
inline py::array any_array_from(py::handle given) {
    if (!py::hasattr(given, "__dlpack__") || py::hasattr(given, "__array__")) {
        return py::array::ensure(given);
    }
    return py::module_::import("numpy").attr("from_dlpack")(given);
}

/// Null for what has other numbers, or none at all.
template <class T>
Numbers<T> numbers_from(py::handle given) {
    refuse_masked(given);
    const py::array array = any_array_from(given);
    const char kind = array ? array.dtype().kind() : '?';
    bool good = kind == 'i' || kind == 'u' || kind == 'f';
    if constexpr (std::is_floating_point_v<T>) {
        good = good || kind == 'b';
    } else if (good) {
        good = kind == 'f'   ? holds_all<T, double>(array)
               : kind == 'i' ? holds_all<T, std::int64_t>(array)
                             : holds_all<T, std::uint64_t>(array);
    }
    return good ? Numbers<T>::ensure(array) : py::reinterpret_steal<Numbers<T>>(py::handle());
}

}  // namespace palpate::python

namespace pybind11::detail {

template <class T>
struct pyobject_caster<array_t<T, array::c_style | array::forcecast>> {
    using type = palpate::python::Numbers<T>;

    bool load(handle source, bool convert) {
        if (!convert && !type::check_(source)) return false;
        value = palpate::python::numbers_from<T>(source);
        return static_cast<bool>(value);
    }
    static handle cast(const handle& from, return_value_policy, handle) { return from.inc_ref(); }
    PYBIND11_TYPE_CASTER(type, handle_type_name<type>::name);
};

/// A vector or matrix of fixed size; what Python gets is a copy.
template <class Matrix>
struct fixed_caster {
    using Scalar = typename Matrix::Scalar;
    using Properties = EigenProps<Matrix>;

    bool load(handle source, bool convert) {
        make_caster<palpate::python::Numbers<Scalar>> given;
        if (!given.load(source, convert)) return false;
        const auto numbers = cast_op<palpate::python::Numbers<Scalar>>(given);
        const auto dimensions = numbers.ndim();
        if (dimensions < 1 || dimensions > 2 || !Properties::conformable(numbers)) return false;
        for (Eigen::Index row = 0; row < Matrix::RowsAtCompileTime; ++row) {
            for (Eigen::Index column = 0; column < Matrix::ColsAtCompileTime; ++column) {
                value(row, column) = numbers.data()[row * Matrix::ColsAtCompileTime + column];
            }
        }
        return true;
    }
    static handle cast(const Matrix& from, return_value_policy, handle) {
        return eigen_array_cast<Properties>(from);
    }
    PYBIND11_TYPE_CASTER(Matrix, Properties::descriptor);
};
template <>
struct type_caster<palpate::Vec3> : fixed_caster<palpate::Vec3> {};
template <>
struct type_caster<palpate::Index3> : fixed_caster<palpate::Index3> {};
template <>
struct type_caster<palpate::Mat3> : fixed_caster<palpate::Mat3> {};
template <>
struct type_caster<Eigen::Vector4d> : fixed_caster<Eigen::Vector4d> {};

}  // namespace pybind11::detail

// NumPy arrays from and to the values of Palpate.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bindings/python/casters.hpp"
#include "palpate/volume.hpp"

namespace palpate::python {

/// Numbers in C order. Other arrays and lists are converted, if they hold numbers
/// (bindings/python/numbers.hpp).
using Doubles = Numbers<double>;

/// The array's samples [z, y, x]: copied, shared, or, without `copy`, shared where they can be.
/// Throws std::invalid_argument, saying what is wrong and what to do.
Volume volume_from(const py::array& array, const Geometry& geometry_but_size,
                   std::optional<bool> copy);
/// A view of the samples, [z, y, x], that cannot be written to and keeps them alive.
py::array array_of(const Volume& volume);

/// Points in the rows of an array of shape (n, 3). Throws std::invalid_argument, which calls the
/// array `name`.
std::vector<Vec3> points_from(const Doubles& array, const char* name);

/// An array that takes the numbers over, without a copy.
template <class T>
py::array_t<T> array_from(std::vector<T> numbers, const std::vector<py::ssize_t>& shape) {
    auto kept = std::make_unique<std::vector<T>>(std::move(numbers));
    const T* data = kept->data();
    const py::capsule owner(kept.release(),
                            [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(shape, data, owner);
}
template <class T>
py::array_t<T> array_from(std::vector<T> numbers) {
    const auto count = static_cast<py::ssize_t>(numbers.size());
    return array_from(std::move(numbers), {count});
}
/// Shape (n, 3), without a copy.
py::array_t<double> array_from(std::vector<Vec3> points);

inline Eigen::Vector4d xyzw(const Quaternion& q) {
    return q.coeffs();
}

/// `of(row)` of each row, which needs no GIL: a number (small whole ones become int), or an Eigen
/// vector of fixed size, or x, y, z, w of a quaternion, in a row of its own.
template <class Row, class Of>
auto column(const std::vector<Row>& rows, const Of& of) {
    using Value = std::decay_t<decltype(of(rows.front()))>;
    if constexpr (std::is_arithmetic_v<Value>) {
        using Number = std::conditional_t<std::same_as<Value, std::int8_t>, int, Value>;
        py::array_t<Number> array(static_cast<py::ssize_t>(rows.size()));
        Number* to = array.mutable_data();
        const GilReleasedForRows unlocked(rows.size());
        for (const Row& row : rows) *to++ = of(row);
        return array;
    } else if constexpr (std::same_as<Value, Quaternion>) {
        return column(rows, [&](const Row& row) { return xyzw(of(row)); });
    } else {
        constexpr py::ssize_t width = Value::SizeAtCompileTime;
        py::array_t<double> array({static_cast<py::ssize_t>(rows.size()), width});
        double* to = array.mutable_data();
        const GilReleasedForRows unlocked(rows.size());
        for (const Row& row : rows) {
            const Value value = of(row);
            for (int i = 0; i < width; ++i) *to++ = value[i];
        }
        return array;
    }
}
}  // namespace palpate::python

// How values of Palpate look in Python: names for enumerations, arrays for vectors and quaternions,
// numbers or "53%" for levels. Every source of the module includes this.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cxxabi.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <optional>
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

/// As py::gil_scoped_release, but safe if the interpreter ends meanwhile. Python would then unwind
/// this thread through C++ functions, which would abort the process. Instead, the thread waits
/// until the process ends.
class GilReleased {
  public:
    GilReleased() : thread_(PyEval_SaveThread()) {}
    ~GilReleased() {
        until_the_end([&] { PyEval_RestoreThread(thread_); });
    }
    GilReleased(const GilReleased&) = delete;
    GilReleased& operator=(const GilReleased&) = delete;

    /// Calls work(), which takes the GIL or runs Python. Does not return if the interpreter has
    /// ended.
    template <class Work>
    static void until_the_end(const Work& work) {
        try {
            work();
        } catch (abi::__forced_unwind&) {
            for (;;) ::pause();
        }
    }

  private:
    PyThreadState* thread_;
};

/// As py::gil_scoped_acquire. The thread waits in the same way if the interpreter has ended.
class GilTaken {
  public:
    GilTaken() {
        GilReleased::until_the_end([this] { taken_.emplace(); });
    }

  private:
    std::optional<py::gil_scoped_acquire> taken_;
};

/// As GilReleased for a loop over so many rows. A short one keeps the GIL, because handing it over
/// and waiting for it would take longer.
class GilReleasedForRows {
  public:
    explicit GilReleasedForRows(std::size_t rows) {
        constexpr std::size_t many = 4096;
        if (rows >= many) unlocked_.emplace();
    }

  private:
    std::optional<GilReleased> unlocked_;
};

/// What a function of Python returns. Only the call itself is unwound if the interpreter ends
/// meanwhile, because to release an object then would crash.
template <class... Arguments>
py::object called(py::handle function, const Arguments&... arguments) {
    const py::tuple given = py::make_tuple(arguments...);
    PyObject* answer = nullptr;
    GilReleased::until_the_end([&] { answer = PyObject_CallObject(function.ptr(), given.ptr()); });
    if (!answer) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(answer);
}

/// What work() returns.
template <class Work>
auto without_gil(Work&& work) {
    const GilReleased unlocked;
    return work();
}

/// A UserWarning, unless the text is empty, for the line of the caller: so many calls in Python
/// from here. Needs the GIL. Throws what Python raises if warnings are errors.
inline void warn(const std::string& text, int calls) {
    if (!text.empty() && PyErr_WarnEx(PyExc_UserWarning, text.c_str(), calls) != 0) {
        throw py::error_already_set();
    }
}

/// In UTF-8. Throws Python's UnicodeEncodeError for halves of surrogate pairs.
inline std::string text_from(py::handle text) {
    py::ssize_t size = 0;
    const char* const data = PyUnicode_AsUTF8AndSize(text.ptr(), &size);
    if (!data) throw py::error_already_set();
    return {data, static_cast<std::size_t>(size)};
}

/// The name of a file, as os.fsdecode() gives it.
inline py::str text_of_path(const std::string& name) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeFSDefaultAndSize(name.data(), static_cast<py::ssize_t>(name.size())));
}

}  // namespace palpate::python

namespace pybind11::detail {

template <palpate::HasNames E>
struct type_caster<E> {
    PYBIND11_TYPE_CASTER(E, const_name("str"));

    bool load(handle source, bool) {
        if (!isinstance<str>(source)) return false;
        value = palpate::named<E>(palpate::python::text_from(source));
        return true;
    }
    static handle cast(E from, return_value_policy, handle) {
        return str(palpate::enum_name(from)).release();
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
            value = palpate::io::level_from_text(palpate::python::text_from(source));
            return true;
        }
        make_caster<double> number;
        if (!number.load(source, convert)) return false;
        value = cast_op<double>(number);
        if (!std::isnan(cast_op<double>(number))) return true;
        throw std::invalid_argument("a level or isovalue must be a number, not nan");
    }
    static handle cast(const palpate::io::Level& from, return_value_policy, handle) {
        if (const auto* part = std::get_if<palpate::io::PercentOfRange>(&from)) {
            return (str(float_(part->percent)).attr("removesuffix")(".0") + str("%")).release();
        }
        return float_(std::get<double>(from)).release();
    }
};

}  // namespace pybind11::detail

// Turns Palpate's exceptions into KeyboardInterrupt after Ctrl-C, otherwise into those of
// palpate/errors.py. Those of the standard library become Python's own: invalid_argument and
// length_error ValueError, bad_alloc MemoryError, logic_error RuntimeError.
#include <new>
#include <system_error>

#include "bindings/python/bindings.hpp"
#include "palpate/devices/error.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/series.hpp"
#include "palpate/run/run.hpp"

namespace palpate::python {
namespace {

/// In one line. Names of files in it may have bytes that are no text.
py::object message_of(const std::exception& error) {
    const std::string text = io::one_line(io::without_secrets(error.what()));
    return py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
        text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace"));
}

void raise(const char* kind, const std::exception& error) {
    const py::object type = py::module_::import("palpate.errors").attr(kind);
    PyErr_SetObject(type.ptr(), message_of(error).ptr());
}

void raise_choice(const io::SeriesChoice& choice) {
    const py::object type = py::module_::import("palpate.errors").attr("SeriesChoice");
    py::list series;
    for (const io::SeriesInfo& info : choice.series()) {
        series.append(py::dict(py::arg("uid") = info.uid, py::arg("description") = info.description,
                               py::arg("modality") = info.modality, py::arg("slices") = info.slices,
                               py::arg("text") = io::text_of(info)));
    }
    PyErr_SetObject(type.ptr(), type(message_of(choice), series).ptr());
}

}  // namespace

void bind_errors() {
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        // A signal such as Ctrl-C ends waits with an error, and is what the caller has to see.
        if (PyErr_CheckSignals() != 0) return;
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const io::SeriesChoice& error) {
            raise_choice(error);
        } catch (const io::InputError& error) {
            raise("InputError", error);
        } catch (const io::OutputError& error) {
            raise("OutputError", error);
        } catch (const devices::DeviceError& error) {
            raise("DeviceError", error);
        } catch (const run::QueueFull& error) {
            raise("QueueFull", error);
        } catch (const std::bad_alloc&) {
            PyErr_SetString(PyExc_MemoryError, "not enough memory");
        } catch (const std::system_error& error) {
            PyErr_SetString(PyExc_OSError, error.what());
        } catch (const std::invalid_argument& error) {
            PyErr_SetObject(PyExc_ValueError, message_of(error).ptr());
        }
    });
}

}  // namespace palpate::python

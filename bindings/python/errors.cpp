// Turns Palpate's exceptions into those of palpate/errors.py. Those of the standard library become
// Python's own: invalid_argument and length_error ValueError, bad_alloc MemoryError, logic_error
// RuntimeError.
#include <system_error>

#include "bindings/python/bindings.hpp"
#include "palpate/devices/error.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/series.hpp"
#include "palpate/run/run.hpp"

namespace palpate::python {
namespace {

void raise(const char* kind, const std::exception& error) {
    const py::object type = py::module_::import("palpate.errors").attr(kind);
    PyErr_SetString(type.ptr(), error.what());
}

void raise_choice(const io::SeriesChoice& choice) {
    const py::object type = py::module_::import("palpate.errors").attr("SeriesChoice");
    py::list series;
    for (const io::SeriesInfo& info : choice.series()) {
        series.append(py::dict(py::arg("uid") = info.uid, py::arg("description") = info.description,
                               py::arg("modality") = info.modality, py::arg("slices") = info.slices,
                               py::arg("text") = io::text_of(info)));
    }
    PyErr_SetObject(type.ptr(), type(choice.what(), series).ptr());
}

}  // namespace

void bind_errors() {
    py::register_local_exception_translator([](std::exception_ptr thrown) {
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
        } catch (const std::system_error& error) {
            PyErr_SetString(PyExc_OSError, error.what());
        }
    });
}

}  // namespace palpate::python

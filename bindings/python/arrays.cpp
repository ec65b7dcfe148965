// Shares samples between NumPy arrays and volumes.
#include "bindings/python/arrays.hpp"

#include "bindings/python/progress.hpp"

namespace palpate::python {
namespace {

/// In either byte order.
std::optional<SampleType> type_of(const py::dtype& dtype) {
    for (const std::string& name : all_names<SampleType>()) {
        const py::dtype known(name);
        if (dtype.kind() == known.kind() && dtype.itemsize() == known.itemsize()) {
            return sample_type_from(name);
        }
    }
    return std::nullopt;
}

/// Why the samples cannot be shared as they lie; empty if they can.
std::string why_not_shared(const py::array& array) {
    if (!(array.flags() & py::array::c_style)) {
        return "the array is not C-contiguous (strides " +
               std::string(py::str(array.attr("strides"))) + " bytes, shape " +
               std::string(py::str(array.attr("shape"))) +
               "): samples are shared as they lie, x fastest";
    }
    if (!(array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_)) {
        return "the array's samples are not aligned";
    }
    if (!array.dtype().attr("isnative").cast<bool>()) {
        return "the array's samples have the other byte order than this machine";
    }
    return {};
}

/// Keeps a Python object while the pointer is held. Any thread may release the pointer.
std::shared_ptr<const void> kept_by(py::object owner, const void* data) {
    PyObject* const held = owner.release().ptr();
    return {data, [held](const void*) {
                if (!Py_IsInitialized()) return;  // the process ends
                const py::gil_scoped_acquire gil;
                Py_DECREF(held);
            }};
}

/// C-contiguous and in this machine's byte order. Slice by slice, so that Ctrl-C stops it.
py::array copied(const py::array& given) {
    const py::dtype type = given.dtype().attr("newbyteorder")("=");
    py::array copy(type, std::vector<py::ssize_t>(given.shape(), given.shape() + given.ndim()));
    Stoppable work;
    const auto slices = given.shape(0);
    for (py::ssize_t i = 0; i < slices; ++i) {
        copy[py::int_(i)] = given[py::int_(i)];
        work.done(static_cast<std::size_t>(given.nbytes() / slices));
    }
    return copy;
}

}  // namespace

Volume volume_from(const py::array& given, const Geometry& geometry_but_size,
                   std::optional<bool> copy) {
    refuse_masked(given);
    if (given.ndim() != 3) {
        throw std::invalid_argument("a volume's array has three axes, z, y and x; this one has " +
                                    std::to_string(given.ndim()));
    }
    const auto type = type_of(given.dtype());
    if (!type) {
        throw std::invalid_argument("samples of type " + std::string(py::str(given.dtype())) +
                                    ": a volume takes uint8, int16, uint16 and float32; convert "
                                    "them with astype(), or use palpate.as_volume()");
    }
    py::array array = given;
    const std::string why = why_not_shared(given);
    if (copy.value_or(!why.empty())) {
        array = copied(given);
    } else if (!why.empty()) {
        throw std::invalid_argument(why + "; pass copy=True for a copy");
    }
    Geometry geometry = geometry_but_size;
    for (const int axis : {0, 1, 2}) {
        const py::ssize_t size = array.shape(2 - axis);
        if (size > std::numeric_limits<int>::max()) {
            throw std::invalid_argument("an axis of " + std::to_string(size) +
                                        " samples is too long");
        }
        geometry.size[axis] = static_cast<int>(size);
    }
    const void* data = array.data();
    const auto bytes = static_cast<std::size_t>(array.nbytes());
    auto samples = kept_by(std::move(array), data);
    const GilReleased unlocked;  // every sample is looked at
    return {geometry, *type, std::move(samples), bytes, ctrl_c()};
}

py::array array_of(const Volume& volume) {
    const Index3& size = volume.geometry().size;
    const py::capsule owner(new Volume(volume), [](void* p) { delete static_cast<Volume*>(p); });
    py::array array(py::dtype(std::string(name_of(volume.type()))),
                    std::vector<py::ssize_t>{size[2], size[1], size[0]}, volume.data(), owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

std::vector<Vec3> points_from(const Doubles& array, const char* name) {
    if (array.ndim() != 2 || array.shape(1) != 3) {
        throw std::invalid_argument(std::string(name) +
                                    ": an array of shape (n, 3) is needed, not " +
                                    std::string(py::str(array.attr("shape"))));
    }
    std::vector<Vec3> points(static_cast<std::size_t>(array.shape(0)));
    const double* from = array.data();
    Stoppable work;
    const GilReleasedForRows unlocked(points.size());
    for (Vec3& point : points) {
        point = Vec3(from[0], from[1], from[2]);
        from += 3;
        work.done(sizeof point);
    }
    return points;
}

py::array_t<double> array_from(std::vector<Vec3> points) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    auto kept = std::make_unique<std::vector<Vec3>>(std::move(points));
    const auto count = static_cast<py::ssize_t>(kept->size());
    const double* data = kept->empty() ? nullptr : kept->front().data();
    const py::capsule owner(kept.release(),
                            [](void* p) { delete static_cast<std::vector<Vec3>*>(p); });
    return py::array_t<double>({count, py::ssize_t{3}}, data, owner);
}

}  // namespace palpate::python

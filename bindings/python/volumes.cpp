// Volumes and their place in space.
#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/record.hpp"
#include "io/straightened.hpp"

namespace palpate::python {
namespace {

/// Missing arguments are assumed, and the geometry records this.
Geometry geometry_of(const std::optional<Vec3>& spacing, const Vec3& origin,
                     const std::optional<Mat3>& direction) {
    Geometry geometry;
    geometry.spacing = spacing.value_or(geometry.spacing);
    geometry.origin = origin;
    geometry.direction = direction.value_or(geometry.direction);
    geometry.measured = spacing.has_value();
    geometry.oriented = direction.has_value();
    return geometry;
}

/// The same samples in another place.
Volume placed(const Volume& volume, const Geometry& geometry) {
    const auto kept = std::make_shared<const Volume>(volume);
    return {geometry, volume.type(), std::shared_ptr<const void>(kept, kept->data()),
            volume.bytes()};
}

py::object text_of_volume(const py::object& self) {
    const auto& volume = self.cast<const Volume&>();
    const Index3& size = volume.geometry().size;
    return py::str("Volume({}x{}x{} {}, spacing {} mm, {:g} to {:g})")
        .format(size[0], size[1], size[2], std::string(name_of(volume.type())),
                py::cast(volume.geometry().spacing).attr("tolist")(), volume.minimum(),
                volume.maximum());
}

/// The nearest direction whose axes are at right angles, and how far that moves a sample [mm].
std::optional<std::pair<Mat3, double>> straightened_turn(const Index3& size, const Vec3& spacing,
                                                         const Mat3& direction) {
    Geometry geometry;
    geometry.size = size;
    geometry.spacing = spacing;
    geometry.direction = direction;
    const auto nearest = io::straightened(geometry);
    if (!nearest) return std::nullopt;
    return std::pair(nearest->grid.direction, nearest->moved);
}

void bind_geometry(py::module_& module) {
    Record<Geometry>(module, "Geometry",
                     "The grid in physical space (LPS, mm): sample (i, j, k) lies at\n"
                     "origin + direction @ (spacing * (i, j, k)).")
        .field("size", &Geometry::size,
               {"Samples along x, y and z: int, shape (3,).", ranges::not_negative})
        .field("spacing", &Geometry::spacing,
               {"Between neighbouring samples [mm], shape (3,).", ranges::spacing})
        .field("origin", &Geometry::origin,
               {"Physical position of sample (0, 0, 0) [mm].", ranges::finite})
        .field("direction", &Geometry::direction,
               {"Columns: unit vectors of the index axes, shape (3, 3).", ranges::finite})
        .field(
            "oriented", &Geometry::oriented,
            "The axes are those of the body (LPS); False: the file does not say, left and right\n"
            "may be mirrored.")
        .field("measured", &Geometry::measured,
               "The spacing is in mm; False: the file does not say.")
        .done()
        .def("physical", &physical_from_index, py::arg("index"),
             "The physical point [mm] of an index (i, j, k), fractions allowed.")
        .def("index", &index_from_physical, py::arg("physical"),
             "The index (i, j, k) of a physical point [mm].")
        .def_property_readonly("centre", &physical_centre,
                               "The middle of the grid [mm, physical].");
}

}  // namespace

void bind_volumes(py::module_& module) {
    bind_geometry(module);
    module.def("_straightened", &straightened_turn, py::arg("size"), py::arg("spacing"),
               py::arg("direction"));
    py::class_<Volume> volume(
        module, "Volume",
        "Samples on a regular grid. They do not change: edits make new versions (Editor).");
    copied_as_itself(volume)
        .def(
            py::init([](const py::array& array, const std::optional<Vec3>& spacing,
                        const Vec3& origin, const std::optional<Mat3>& direction,
                        std::optional<bool> copy) {
                return volume_from(array, geometry_of(spacing, origin, direction), copy);
            }),
            py::arg("array"), py::arg("spacing") = py::none(), py::arg("origin") = Vec3(0, 0, 0),
            py::arg("direction") = py::none(), py::arg("copy") = false,
            "Shares the samples of an array of shape (z, y, x) of uint8, int16, uint16 or\n"
            "float32, without a copy: do not write to it afterwards. An array that is not\n"
            "C-contiguous is a ValueError. copy=True copies any array, copy=None those that\n"
            "cannot be shared. spacing and origin in mm (x, y, z), LPS. Without a direction the\n"
            "geometry is not `oriented`: nothing says which side is left. Without a spacing, 1 mm\n"
            "is assumed and it is not `measured`. as_volume() converts other types and\n"
            "understands nibabel and zarr.")
        .def_property_readonly("geometry", &Volume::geometry, "A copy of its Geometry.",
                               py::return_value_policy::copy)
        .def_property_readonly("type", &Volume::type, "'uint8', 'int16', 'uint16' or 'float32'.")
        .def_property_readonly("minimum", &Volume::minimum, "Least sample [data units].")
        .def_property_readonly("maximum", &Volume::maximum, "Greatest sample [data units].")
        .def_property_readonly("nbytes", &Volume::bytes, "Bytes of the samples.")
        .def_property_readonly("array", &array_of,
                               "The samples as an array of shape (z, y, x), shared and read-only.")
        .def(
            "__array__",
            [](const Volume& self, const py::object& dtype) -> py::object {
                py::array array = array_of(self);
                return dtype.is_none()
                           ? py::object(array)
                           : py::object(array.attr("astype")(dtype, py::arg("copy") = false));
            },
            py::arg("dtype") = py::none(), "For numpy.asarray(): shared and read-only.")
        .def("_placed", &placed, py::arg("geometry"), py::call_guard<GilReleased>())
        .def("__repr__", &text_of_volume)
        .def(py::pickle(
            [](const Volume& self) {
                const Geometry& g = self.geometry();
                return py::make_tuple(array_of(self), g);
            },
            [](const py::tuple& state) {
                return volume_from(state[0].cast<py::array>(), state[1].cast<Geometry>(), {});
            }));
}

}  // namespace palpate::python

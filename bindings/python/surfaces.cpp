// Isosurfaces as arrays, and meshes in files.
#include "palpate/surface.hpp"

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::python {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Indices = Numbers<std::uint32_t>;

SurfaceMesh extract(const Field& field, const io::Level& level, double tolerance, bool normals,
                    const ProgressFunction& progress) {
    if (field.interpolation() == Interpolation::linear) {
        run::refuse_without_effect(
            {{{"tolerance"}, "the facets of the linear field are exact"},
             {{"normals"}, "those of the linear field are the normals of the facets"}},
            {{"tolerance", tolerance != 0}, {"normals", normals}});
    }
    SurfaceOptions options;
    options.tolerance = tolerance;
    options.normals = normals;
    const auto tell = progress_of(progress);
    options.progress = [&tell](double fraction) {
        tell(fraction);
        return true;
    };
    const double isovalue = io::level_in(field.volume(), level);
    warn(run::level_warning(field, isovalue), 2);
    const GilReleased unlocked;
    return extract_surface(field, isovalue, options);
}

SurfaceMesh mesh_from(const Doubles& vertices, const Indices& triangles) {
    if (triangles.ndim() != 2 || triangles.shape(1) != 3) {
        throw std::invalid_argument("triangles: an array of shape (m, 3) is needed");
    }
    SurfaceMesh mesh;
    mesh.vertices = points_from(vertices, "vertices");
    const std::uint32_t* corner = triangles.data();
    const auto count = static_cast<std::size_t>(triangles.shape(0));
    const GilReleasedForRows unlocked(mesh.vertices.size() + count);
    Stoppable work;
    for (const Vec3& vertex : mesh.vertices) {
        check_numbers("vertices", vertex, ranges::finite);
        work.done(sizeof vertex);
    }
    mesh.triangles.reserve(count);
    for (std::size_t i = 0; i < count; ++i, corner += 3) {
        mesh.triangles.push_back({corner[0], corner[1], corner[2]});
        work.done(sizeof mesh.triangles[0]);
        for (const std::uint32_t vertex : mesh.triangles.back()) {
            if (vertex < mesh.vertices.size()) continue;
            throw std::invalid_argument("triangle " + std::to_string(i) +
                                        " names a vertex that there is not");
        }
    }
    return mesh;
}

/// A view of a mesh's numbers that keeps the mesh alive.
template <class T, class Rows>
py::array_t<T> view(const py::object& mesh, const Rows& rows) {
    const auto count = static_cast<py::ssize_t>(rows.size());
    const T* data = rows.empty() ? nullptr : rows.front().data();
    py::array_t<T> array({count, py::ssize_t{3}}, data, mesh);
    array.attr("flags").attr("writeable") = false;
    return array;
}

}  // namespace

void bind_surfaces(py::module_& module) {
    py::class_<SurfaceMesh> mesh(module, "Mesh", "An oriented triangle mesh.");
    copied_as_itself(mesh)
        .def(py::init(&mesh_from), py::arg("vertices"), py::arg("triangles"),
             "vertices [mm], shape (n, 3); triangles: their indices, shape (m, 3).")
        .def_property_readonly(
            "vertices",
            [](const py::object& self) {
                return view<double>(self, self.cast<const SurfaceMesh&>().vertices);
            },
            "[mm, physical], shape (n, 3); shared and read-only, as the others.")
        .def_property_readonly(
            "triangles",
            [](const py::object& self) {
                return view<std::uint32_t>(self, self.cast<const SurfaceMesh&>().triangles);
            },
            "Indices of vertices, uint32, shape (m, 3), counter-clockwise seen from outside.")
        .def_property_readonly(
            "normals",
            [](const py::object& self) {
                return view<double>(self, self.cast<const SurfaceMesh&>().normals);
            },
            "Unit, out of the solid, shape (n, 3); (0, 3) unless asked for.")
        .def_property_readonly("enclosed_volume", &enclosed_volume, "Of a closed mesh [mm^3].")
        .def(
            "write",
            [](const SurfaceMesh& self, const std::filesystem::path& path) {
                io::write_mesh(self, path, ctrl_c());
            },
            py::arg("path"), py::call_guard<GilReleased>(),
            "As .ply, .stl, .obj or .vtp, whole or not at all. Raises OutputError.")
        .def(py::pickle(
            [](const py::object& self) {
                return py::make_tuple(self.attr("vertices"), self.attr("triangles"),
                                      self.attr("normals"));
            },
            [](const py::tuple& state) {
                SurfaceMesh made = mesh_from(state[0].cast<Doubles>(), state[1].cast<Indices>());
                made.normals = points_from(state[2].cast<Doubles>(), "normals");
                return made;
            }))
        .def("__repr__", [](const SurfaceMesh& m) {
            return py::str("Mesh({} vertices, {} triangles)")
                .format(m.vertices.size(), m.triangles.size());
        });
    module.def(
        "extract", &extract, py::arg("field"), py::arg("isovalue"), py::kw_only(),
        py::arg("tolerance") = 0.0, py::arg("normals") = false, py::arg("progress") = py::none(),
        "The whole isosurface as one watertight Mesh. isovalue: a number [data units] or\n"
        "'53%'. tolerance [voxel]: facets of a cubic field are split until they are as near;\n"
        "normals: of a cubic field, those that are felt.");
    module.def(
        "read_mesh",
        [](const std::filesystem::path& path) { return io::read_mesh(path, ctrl_c()); },
        py::arg("path"), py::call_guard<GilReleased>(),
        "The triangles of an .stl, .ply, .obj or .vtp file. Raises InputError.");
}

}  // namespace palpate::python

// Fields and their surfaces in the C interface.
#include "palpate/field.hpp"
#include "bindings/c/handles.hpp"
#include "bindings/c/structs.hpp"

namespace palpate::c {

extern "C" PALPATE_API palpate_status palpate_field_create(const palpate_volume* volume,
                                                           const palpate_field_options* options,
                                                           palpate_field** out) {
    return guarded([&] {
        given(out, "out");
        const run::LoadedVolume& loaded = given(volume, "volume").loaded;
        const run::FieldSetup setup = field_setup(options);
        *out = new palpate_field{run::make_field(loaded.volume, setup), usual_isovalue(loaded)};
    });
}

extern "C" PALPATE_API palpate_status palpate_field_values(const palpate_field* field,
                                                           const double* points, size_t count,
                                                           double* densities, double* gradients) {
    return guarded([&] {
        const Field& f = given(field, "field").field;
        if (count == 0) return;
        given(points, "points");
        for (std::size_t i = 0; i < count; ++i) {
            if (!vec3(points + 3 * i).allFinite()) {
                throw std::invalid_argument("point " + std::to_string(i) + " is not finite");
            }
        }
        constexpr std::size_t between = 4096;
        ReportedItems told(progress_of_thread(), count, between);
        for (std::size_t i = 0; i < count; ++i) {
            told.done();
            const Vec3 point = vec3(points + 3 * i);
            if (densities) densities[i] = value_at(f, point);
            if (gradients) put(gradient_at(f, point), gradients + 3 * i);
        }
    });
}

extern "C" PALPATE_API palpate_status palpate_field_ray(const palpate_field* field, double isovalue,
                                                        const double from[3], const double to[3],
                                                        palpate_ray_hit* out) {
    return guarded([&] {
        const Field& f = given(field, "field").field;
        const Vec3 begin = vec3(&given(from, "from")), end = vec3(&given(to, "to"));
        if (!begin.allFinite() || !end.allFinite()) {
            throw std::invalid_argument("the ends of a ray have to be finite");
        }
        check_isovalue(isovalue, f.solid());
        const RayHit hit = cast_ray(f, isovalue, begin, end);
        auto result = sized<palpate_ray_hit>();
        result.hit = hit.hit;
        put(hit.point, result.point);
        put(hit.normal, result.normal);
        give(out, "out", result);
    });
}

extern "C" PALPATE_API void palpate_field_destroy(palpate_field* field) {
    delete field;
}

extern "C" PALPATE_API palpate_status palpate_mesh_create(const palpate_field* field,
                                                          double isovalue, palpate_mesh** out) {
    return guarded([&] {
        given(out, "out");
        const Field& f = given(field, "field").field;
        const auto tell = [progress = progress_of_thread()](double fraction) {
            if (progress) progress(fraction);
            return true;
        };
        *out = new palpate_mesh{extract_surface(f, isovalue, {.progress = tell})};
    });
}

extern "C" PALPATE_API size_t palpate_mesh_vertex_count(const palpate_mesh* mesh) {
    return mesh ? mesh->mesh.vertices.size() : 0;
}

extern "C" PALPATE_API size_t palpate_mesh_triangle_count(const palpate_mesh* mesh) {
    return mesh ? mesh->mesh.triangles.size() : 0;
}

extern "C" PALPATE_API palpate_status palpate_mesh_read(const palpate_mesh* mesh, float* vertices,
                                                        uint32_t* triangles) {
    return guarded([&] {
        const SurfaceMesh& m = given(mesh, "mesh").mesh;
        for (std::size_t i = 0; vertices && i < m.vertices.size(); ++i) {
            for (int a = 0; a < 3; ++a) *vertices++ = static_cast<float>(m.vertices[i][a]);
        }
        for (std::size_t i = 0; triangles && i < m.triangles.size(); ++i) {
            triangles = std::copy_n(m.triangles[i].data(), 3, triangles);
        }
    });
}

extern "C" PALPATE_API void palpate_mesh_destroy(palpate_mesh* mesh) {
    delete mesh;
}

}  // namespace palpate::c

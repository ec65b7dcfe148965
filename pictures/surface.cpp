// Extracts isosurfaces and gives them normals.
#include "pictures/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>
#include <thread>
#include <vector>

#include "palpate/field.hpp"

namespace palpate::pictures {
namespace {

template <class T>
Volume thinned(const Volume& volume, int every) {
    const Geometry& g = volume.geometry();
    Geometry coarse = g;
    coarse.size = (g.size.array() - 1) / every + 1;
    coarse.spacing = g.spacing * every;
    std::vector<T> samples;
    samples.reserve(static_cast<std::size_t>(sample_count(coarse)));
    const auto all = volume.samples<T>();
    const auto row = static_cast<std::size_t>(g.size[0]);
    const auto slice = row * static_cast<std::size_t>(g.size[1]);
    const auto step = static_cast<std::size_t>(every);
    for (std::size_t z = 0; z < static_cast<std::size_t>(g.size[2]); z += step) {
        for (std::size_t y = 0; y < static_cast<std::size_t>(g.size[1]); y += step) {
            for (std::size_t x = 0; x < row; x += step) {
                samples.push_back(all[z * slice + y * row + x]);
            }
        }
    }
    return Volume(coarse, std::move(samples));
}

/// Out of the solid: of a cubic field its gradient, of a linear one, which has facets, central
/// differences over a voxel along each axis of the grid.
/// `facet`, the normal of the mesh, where they say nothing (plateaus) or something else (sheets
/// thinner than a voxel).
Eigen::Vector3f smooth_normal(const Field& field, const Vec3& at, const Eigen::Vector3f& facet) {
    const Geometry& g = field.geometry();
    const bool is_smooth = field.interpolation() == Interpolation::cubic;
    Vec3 gradient = is_smooth ? gradient_at(field, at) : Vec3::Zero();
    for (int axis = 0; axis < 3 && !is_smooth; ++axis) {
        const Vec3 step = g.spacing[axis] * g.direction.col(axis);
        gradient += (value_at(field, Vec3(at + step)) - value_at(field, Vec3(at - step))) /
                    g.spacing[axis] * g.direction.col(axis);
    }
    const Eigen::Vector3f normal = (-field.sign() * gradient).normalized().cast<float>();
    return normal.dot(facet) > 0.3F ? normal : facet;
}

}  // namespace

Field coarser(const Field& field, int every) {
    const Volume& v = field.volume();
    Volume coarse =
        with_type(v.type(), [&](auto zero) { return thinned<decltype(zero)>(v, every); });
    return Field(std::move(coarse), field.solid(), field.background(), field.interpolation());
}

std::vector<Eigen::Vector3f> mesh_normals(const SurfaceMesh& mesh) {
    std::vector<Eigen::Vector3f> normals(mesh.vertices.size(), Eigen::Vector3f::Zero());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& corner = mesh.vertices[a];
        const Vec3 twice_area = (mesh.vertices[b] - corner).cross(mesh.vertices[c] - corner);
        for (const std::uint32_t v : {a, b, c}) normals[v] += twice_area.cast<float>();
    }
    for (Eigen::Vector3f& n : normals) {
        const float length = n.norm();
        n = length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f(0, 0, 1);
    }
    return normals;
}

ShadedSurface shaded_surface(const Field& field, double isovalue, const SurfaceWork& work) {
    if (work.every < 1) throw std::invalid_argument("every 0th sample is none");
    ShadedSurface result;
    result.every = work.every;
    SurfaceOptions options;
    options.progress = [&](double fraction) {
        work.progress(0.7 * fraction);
        return true;
    };
    options.max_vertices = work.most_triangles / 2;  // a closed mesh has half as many, and few more
    Field drawn = result.every > 1 ? coarser(field, result.every) : field;
    for (;;) {
        try {
            result.surface.mesh = extract_surface(drawn, isovalue, options);
            break;
        } catch (const std::length_error&) {
            if (drawn.geometry().size.maxCoeff() < 2) throw;
            drawn = coarser(field, ++result.every);
        }
    }
    work.progress(0.7);
    auto& normals = result.surface.normals;
    normals = mesh_normals(result.surface.mesh);
    const auto& vertices = result.surface.mesh.vertices;
    const auto shade = [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            normals[i] = smooth_normal(drawn, vertices[i], normals[i]);
        }
    };
    const std::size_t parts = std::max(1U, std::thread::hardware_concurrency());
    {
        std::vector<std::jthread> threads;
        for (std::size_t p = 1; p < parts; ++p) {
            threads.emplace_back(shade, p * vertices.size() / parts,
                                 (p + 1) * vertices.size() / parts);
        }
        shade(0, vertices.size() / parts);
    }
    work.progress(1);
    return result;
}

}  // namespace palpate::pictures

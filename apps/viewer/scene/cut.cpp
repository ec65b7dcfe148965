// Turns cuts into planes, moves and outlines them.
#include "apps/viewer/scene/cut.hpp"

#include <vtkNew.h>
#include <vtkPlane.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::viewer {

Vec3 at_parts(const Geometry& geometry, const Vec3& parts) {
    const Vec3 last = (geometry.size - Index3::Ones()).cast<double>();
    return physical_from_index(geometry, parts.cwiseProduct(last));
}

std::vector<CutPlane> planes_of(const Look& look, const Geometry& geometry) {
    if (look.cut == Cut::plane) return {look.cut_plane};
    std::vector<CutPlane> planes;
    if (look.cut == Cut::nothing) return planes;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 along = geometry.direction.col(axis);
        const auto& [low, high] = look.cut_box;
        if (low[axis] > 0) planes.push_back({at_parts(geometry, low), -along});
        if (high[axis] < 1) planes.push_back({at_parts(geometry, high), along});
    }
    return planes;
}

void put_planes(vtkPlaneCollection& collection, const std::vector<CutPlane>& planes,
                const Vec3& origin) {
    const auto same = [&] {
        if (collection.GetNumberOfItems() != static_cast<int>(planes.size())) return false;
        for (std::size_t i = 0; i < planes.size(); ++i) {
            vtkPlane* const plane = collection.GetItem(static_cast<int>(i));
            if (Vec3(plane->GetOrigin()) != planes[i].point - origin ||
                Vec3(plane->GetNormal()) != -planes[i].normal) {
                return false;
            }
        }
        return true;
    };
    if (same()) return;
    collection.RemoveAllItems();
    for (const CutPlane& cut : planes) {
        vtkNew<vtkPlane> plane;  // VTK keeps the side of its normal
        plane->SetOrigin(Vec3(cut.point - origin).data());
        plane->SetNormal(Vec3(-cut.normal).data());
        collection.AddItem(plane);
    }
}

namespace {

constexpr double narrowest = 0.01;  // a box, as a part of the grid

/// Corner `c` of a box, in parts of the grid: bit a is set for the high end of axis a.
Vec3 corner(const CutBox& box, int c) {
    Vec3 parts;
    for (int a = 0; a < 3; ++a) parts[a] = (c >> a & 1) ? box.high[a] : box.low[a];
    return parts;
}

std::vector<std::array<Vec3, 2>> edges_of(const CutBox& box, const Geometry& geometry) {
    std::vector<std::array<Vec3, 2>> edges;
    for (int c = 0; c < 8; ++c) {
        for (int a = 0; a < 3; ++a) {
            if (c >> a & 1) continue;
            edges.push_back(
                {at_parts(geometry, corner(box, c)), at_parts(geometry, corner(box, c | 1 << a))});
        }
    }
    return edges;
}

/// The convex polygon in which the plane meets the grid's bounds.
std::vector<std::array<Vec3, 2>> section(const CutPlane& plane, const Geometry& geometry) {
    std::vector<Vec3> corners;
    for (const auto& [a, b] : edges_of(CutBox(), geometry)) {
        const double da = plane.normal.dot(a - plane.point), db = plane.normal.dot(b - plane.point);
        if ((da < 0) != (db < 0)) corners.push_back(a + da / (da - db) * (b - a));
    }
    Vec3 middle = Vec3::Zero();
    for (const Vec3& c : corners) middle += c / static_cast<double>(corners.size());
    const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.normalized().cross(u);
    std::ranges::sort(corners, {}, [&](const Vec3& c) {
        return std::atan2(v.dot(c - middle), u.dot(c - middle));
    });
    std::vector<std::array<Vec3, 2>> lines;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        lines.push_back({corners[i], corners[(i + 1) % corners.size()]});
    }
    return lines;
}

}  // namespace

std::vector<CutHandle> handles_of(const Look& look, const Geometry& geometry, double arm) {
    if (look.cut == Cut::nothing) return {};
    if (look.cut == Cut::plane) {
        const Vec3 normal = look.cut_plane.normal.normalized();
        return {{look.cut_plane.point, normal},
                {look.cut_plane.point + arm * normal, Vec3::Zero()}};
    }
    std::vector<CutHandle> handles;
    const auto& [low, high] = look.cut_box;
    for (int axis = 0; axis < 3; ++axis) {
        for (const Vec3& end : {low, high}) {
            Vec3 parts = 0.5 * (low + high);
            parts[axis] = end[axis];
            handles.push_back({at_parts(geometry, parts), geometry.direction.col(axis)});
        }
    }
    return handles;
}

Look with_handle_at(const Look& look, const Geometry& geometry, std::size_t handle,
                    const Vec3& to) {
    Look moved = look;
    CutPlane& plane = moved.cut_plane;
    if (look.cut == Cut::plane && handle == 0) {
        const Vec3 normal = plane.normal.normalized();
        plane.point += normal.dot(to - plane.point) * normal;
    } else if (look.cut == Cut::plane) {
        const Vec3 normal = to - plane.point;
        if (normal.norm() > 0) plane.normal = normal.normalized();
    } else if (look.cut == Cut::box) {
        const int axis = static_cast<int>(handle / 2);
        const Vec3 index = index_from_physical(geometry, to);
        const double part = index[axis] / std::max(1, geometry.size[axis] - 1);
        double &low = moved.cut_box.low[axis], &high = moved.cut_box.high[axis];
        if (handle % 2 == 0) {
            low = std::clamp(part, 0.0, std::max(0.0, high - narrowest));
        } else {
            high = std::clamp(part, std::min(1.0, low + narrowest), 1.0);
        }
    }
    return moved;
}

std::vector<std::array<Vec3, 2>> outline_of(const Look& look, const Geometry& geometry) {
    if (look.cut == Cut::nothing) return {};
    return look.cut == Cut::plane ? section(look.cut_plane, geometry)
                                  : edges_of(look.cut_box, geometry);
}

Look with_cut(const Look& look, Cut cut, const Vec3& point, const Vec3& towards_viewer) {
    Look next = look;
    next.cut = cut;
    if (cut == Cut::plane) next.cut_plane = {point, towards_viewer.normalized()};
    if (cut == Cut::box) next.cut_box = {};
    return next;
}

}  // namespace palpate::viewer

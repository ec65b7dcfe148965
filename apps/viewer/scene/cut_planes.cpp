// Turns a cut into planes.
#include "apps/viewer/scene/cut_planes.hpp"

#include <vtkNew.h>
#include <vtkPlane.h>

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

}  // namespace palpate::viewer

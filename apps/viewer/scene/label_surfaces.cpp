// Extracts masks.
#include "apps/viewer/scene/label_surfaces.hpp"

#include <algorithm>

namespace palpate::viewer {
namespace {

/// Moves a mesh from the middle of the mask's grid to that of the overlay's.
MeshBlocks moved(const MeshBlocks& blocks, const Vec3& by) {
    MeshBlocks result;
    const Eigen::Vector3f shift = by.cast<float>();
    for (const auto& block : blocks) {
        if (!block) continue;
        auto mesh = std::make_shared<RenderMesh>(*block);
        for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
            mesh->positions[i] += shift[static_cast<Eigen::Index>(i % 3)];
        }
        result.push_back(std::move(mesh));
    }
    return result;
}

}  // namespace

std::vector<ExtractedSurface> label_surfaces(const Overlay& overlay,
                                             const std::function<void(double)>& progress) {
    constexpr std::size_t most_triangles = 4'000'000, moving_triangles = 20'000;
    std::vector<ExtractedSurface> surfaces;
    for (const Label& label : overlay.labels) {
        progress(double(surfaces.size()) / double(overlay.labels.size()));
        // Linear: what is a sample wide stays whole.
        const Field field(label_mask(overlay, label), Solid::above, 0, Interpolation::linear);
        SurfaceBlocks blocks(field.geometry(), 1, field.interpolation());
        (void)blocks.renew(
            field, 0.5, [] { return true; }, most_triangles);
        const Vec3 by =
            physical_centre(field.geometry()) - physical_centre(overlay.volume.geometry());
        ExtractedSurface surface;
        surface.blocks = moved(blocks.meshes(), by);
        const std::size_t few =
            std::max<std::size_t>(500, moving_triangles / overlay.labels.size());
        if (const auto simple = blocks.simplified(few))
            surface.moving = moved({simple}, by).front();
        surface.finished = true;
        surfaces.push_back(std::move(surface));
    }
    progress(1);
    return surfaces;
}

}  // namespace palpate::viewer

// The widget's part in levels of detail: what is seen, and the finer part of it.
#include <cmath>

#include "apps/viewer/scene/scene_parts.hpp"
#include "apps/viewer/scene/view_space.hpp"

namespace palpate::viewer {
namespace {

constexpr int apart_px = 12;  // points of what is seen

/// On an edge of the grid's outline, which may be drawn there.
bool is_on_outline(const Geometry& geometry, const Vec3& point, double near_mm) {
    const Vec3 index = index_from_physical(geometry, point);
    int ends = 0;
    for (int a = 0; a < 3; ++a) {
        const double near = near_mm / geometry.spacing[a];
        ends += std::abs(index[a]) < near || std::abs(index[a] - geometry.size[a] + 1) < near;
    }
    return ends >= 2;
}

}  // namespace

void Scene::set_patch(const std::optional<ScenePatch>& patch) {
    if (!parts_->background.field()) return;
    parts_->patch_detail = patch ? patch->detail : nullptr;
    parts_->background.set_patch(patch);
    refresh();  // tetrahedra and patches at the proxy are those of the finer data
}

bool Scene::shows_whole() const {
    return parts_->background.shows_whole();
}

const Field& Scene::finest_at_proxy(int hand, const Field& field) const {
    const auto& snapshot = parts_->hands[hand].snapshot;
    if (!parts_->patch_detail || !snapshot) return field;
    constexpr double border = 3;  // [voxel] of other samples
    const Field& finer = parts_->patch_detail->field;
    const Vec3 index = index_from_physical(finer.geometry(), snapshot->session.tick.proxy.scp);
    const Vec3 last = finer.geometry().size.cast<double>().array() - 1 - border;
    const bool inside = (index.array() >= border).all() && (index.array() <= last.array()).all();
    return inside ? finer : field;
}

bool Scene::is_in_view(const Vec3& point) const {
    const Pixel at = pixel_of(camera_, view_size(), point);
    return at.x >= 0 && at.y >= 0 && at.x < width() && at.y < height();
}

std::optional<SeenPoints> Scene::seen_points() const {
    const auto& field = parts_->background.field();
    if (!field || !isVisible()) return std::nullopt;
    SeenPoints seen;
    const double pixel = mm_per_pixel(camera_, view_size());
    seen.half_height = camera_.half_height;
    seen.pixel_mm = pixel / devicePixelRatioF();
    double nearest = HUGE_VAL;
    for (int y = apart_px / 2; y < height(); y += apart_px) {
        for (int x = apart_px / 2; x < width(); x += apart_px) {
            const auto at = surface_at({double(x), double(y)});
            if (!at || is_on_outline(field->geometry(), *at, 2 * pixel)) continue;
            seen.points.push_back(*at);
            const double away = std::hypot(x - 0.5 * width(), y - 0.5 * height());
            if (away < nearest) {
                nearest = away;
                seen.middle = *at;
            }
        }
    }
    return seen;
}

}  // namespace palpate::viewer

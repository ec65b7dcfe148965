// Adds isosurfaces and the path of a hand to a scene.
#include "pictures/levels.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>

#include "pictures/contact.hpp"
#include "pictures/picture.hpp"
#include "pictures/surface.hpp"

namespace palpate::pictures {
namespace {

/// From the outside in, before the innermost, which is bone; lighter than the markers' colours.
constexpr std::array<Colour, most_levels - 1> glass{{
    {0.42, 0.69, 0.87},  // sky blue
    {0.93, 0.68, 0.30},  // orange
    {0.36, 0.72, 0.60},  // bluish green
    {0.85, 0.58, 0.74},  // reddish purple
}};
constexpr double clear = 0.24;

std::string label_of(double isovalue) {
    char text[48];
    std::snprintf(text, sizeof text, "isovalue %.6g", isovalue);
    return text;
}

/// Fewer points than anybody could see apart.
std::vector<Vec3> thinned(const std::vector<Vec3>& points, double least) {
    std::vector<Vec3> kept;
    for (const Vec3& p : points) {
        if (kept.empty() || (p - kept.back()).norm() >= least) kept.push_back(p);
    }
    return kept;
}

}  // namespace

int add_levels(PictureScene& scene, const Field& field, std::span<const double> levels,
               const std::function<void(double)>& progress) {
    if (levels.size() > most_levels) throw std::invalid_argument("too many levels for a picture");
    std::vector<double> inwards(levels.begin(), levels.end());
    std::ranges::sort(inwards, [&](double a, double b) { return field.sign() * (a - b) < 0; });
    int every = 1;
    for (std::size_t i = 0; i < inwards.size(); ++i) {
        SurfaceWork work;
        work.most_triangles = most_triangles / inwards.size();
        work.progress = [&](double fraction) {
            progress((double(i) + fraction) / double(inwards.size()));
        };
        ShadedSurface made = shaded_surface(field, inwards[i], work);
        every = std::max(every, made.every);
        const bool innermost = i + 1 == inwards.size();
        made.surface.colour = innermost ? bone : glass[i];
        made.surface.opacity = innermost ? 1 : clear;
        made.surface.label = label_of(inwards[i]);
        scene.surfaces.push_back(std::move(made.surface));
    }
    return every;
}

void add_path(PictureScene& scene, const std::vector<Vec3>& hip, const std::vector<Vec3>& scp,
              const std::vector<bool>& constrained) {
    const double thin = line_radius(scene, 1.6), thick = line_radius(scene, 3.2);
    if (!hip.empty()) {
        scene.lines.push_back({thinned(hip, 0.5 * thin), thin, hip_colour, "path of the hand"});
    }
    std::vector<Vec3> touch;
    std::string label = "path of the proxy in contact";
    const auto finish = [&] {
        if (!touch.empty()) {
            scene.lines.push_back({thinned(touch, 0.5 * thick), thick, scp_colour, label});
            label.clear();  // in the legend once
        }
        touch.clear();
    };
    for (std::size_t i = 0; i < scp.size(); ++i) {
        if (constrained[i]) {
            touch.push_back(scp[i]);
        } else {
            finish();
        }
    }
    finish();
}

}  // namespace palpate::pictures

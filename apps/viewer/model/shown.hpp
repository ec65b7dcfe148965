// The state that scene and slices show beside the data and the hands: one plain value. A view
// compares it with the last one, and knows by itself when to draw again.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/look.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/model/overlay.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// Grey levels [data units]: up to `low` black, from `high` white. Unless low < high: not chosen.
struct GreyWindow {
    double low = 0, high = 0;
    bool operator==(const GreyWindow&) const = default;
};

struct Shown {
    double isovalue = 0;  ///< [data units] of the surface in the scene
    /// A hand has pressed through that surface to this level [data units]: the surface is shown as
    /// glass, and a patch of this level round the proxy.
    std::optional<double> pressed;
    int pressing = 1;                        ///< that hand
    std::optional<double> next_level;        ///< of the slices' contour, where it is another one
    Look look;                               ///< of scene and slices
    SharedLayers layers;                     ///< seen with the look; null: none
    std::shared_ptr<const Overlay> overlay;  ///< in slices; null: none
    PerHand<std::shared_ptr<const Tool>> tools;  ///< with which the hands feel; null: a point
    Vec3 crosshair = Vec3::Zero();               ///< [mm, physical] where the slices cut
    GreyWindow window;                           ///< of the slices; not chosen: the usual one
    GreyWindow usual_window;  ///< not chosen: from the least sample to the greatest
    double brush = 0;         ///< [mm] radius of the ball that is outlined round proxies; 0: none
    bool probe = false;       ///< the left button moves the probe, where the device is the mouse
    bool measuring = false;   ///< the left button chooses points, and moves nothing
    std::vector<Measurement> measurements;
    LengthUnit unit = LengthUnit::automatic;  ///< of the measurements
    double wheel_px = 15;  ///< a notch of the wheel moves the probe as a drag of so many pixels
    std::size_t most_triangles = 6'000'000;  ///< of the surface that is felt, from the next one on
    bool operator==(const Shown&) const = default;
};

/// Changes one member of what a view shows.
template <class View, class T>
void set(View& view, T Shown::*member, const std::type_identity_t<T>& value) {
    Shown next = view.shown();
    next.*member = value;
    view.set_shown(next);
}

/// With a field in place of another (null: of none): other samples are seen from their middle, in
/// their usual grey levels.
inline Shown with_field(Shown shown, const Field* before, const Field& field, double isovalue) {
    shown.isovalue = isovalue;
    shown.pressed.reset();
    shown.next_level.reset();
    if (before && before->volume().data() == field.volume().data()) return shown;
    shown.crosshair = physical_centre(field.geometry());
    shown.window = shown.usual_window = {};
    return shown;
}

}  // namespace palpate::viewer

// Needle: crossings of the shaft, and Karnopp's friction along it.
#include "layers/needle.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// What rubs on the shaft up to `tip` [N]: the drag of each layer times the length in it.
double drag_up_to(const NeedleState& needle, const Layers& layers, double tip) {
    double sum = 0;
    for (int i = 0; i < needle.crossing_count; ++i) {
        const Crossing& c = needle.crossings[i];
        const double end =
            i + 1 < needle.crossing_count ? std::min(tip, needle.crossings[i + 1].at) : tip;
        if (c.layer < 0 || !(end > c.at)) continue;
        sum += (end - c.at) * property_of(layers, c.layer, HapticProperty::drag,
                                          layers.layers[c.layer].level, 0, 0);
    }
    return sum;
}

}  // namespace

void insert(NeedleState& needle, const Vec3& entry, const Vec3& axis) {
    needle = {};
    needle.inserted = true;
    needle.slipping = true;
    needle.entry = entry;
    needle.axis = axis;
}

double along_line(const NeedleState& needle, const Vec3& point) {
    return needle.axis.dot(point - needle.entry);
}

Vec3 on_line(const NeedleState& needle, double at) {
    return needle.entry + at * needle.axis;
}

void cross(NeedleState& needle, int surface, int layer, const Vec3& point) {
    needle.crossings[needle.crossing_count++] = {along_line(needle, point),
                                                 static_cast<std::int8_t>(surface),
                                                 static_cast<std::int8_t>(layer)};
}

bool is_in_channel(const NeedleState& needle, int surface, const Vec3& tip, double closing) {
    if (needle.crossing_count == 0) return false;
    const Crossing& last = needle.crossings[needle.crossing_count - 1];
    return last.surface == surface && std::abs(along_line(needle, tip) - last.at) <= closing;
}

void withdraw(NeedleState& needle, const Vec3& tip, double closing) {
    const double at = along_line(needle, tip);
    while (needle.crossing_count > 0 &&
           at < needle.crossings[needle.crossing_count - 1].at - closing) {
        --needle.crossing_count;
    }
    needle.inserted = needle.crossing_count > 0;
}

void count_surfaces(NeedleState& needle, int inside, int nested, const Vec3& tip) {
    if (needle.crossing_count == 0) return;
    const Crossing& last = needle.crossings[needle.crossing_count - 1];
    if (!(along_line(needle, tip) > last.at)) return;
    int known = last.layer + 1;  // as the SCP's `inside`
    while (known != inside && has_room(needle)) {
        const bool one_by_one = std::max(known, inside) <= nested;
        const int next = !one_by_one ? inside : known < inside ? known + 1 : known - 1;
        cross(needle, std::max(known, next) - 1, next - 1, tip);
        known = next;
    }
}

double shaft_friction(NeedleState& needle, const Layers& layers, const LayerInput& input,
                      const Vec3& tip, double period) {
    const double hand = along_line(needle, input.hip);
    const double speed =
        period > 0 ? std::abs(hand - needle.hand) * input.device_per_volume / period : 0;
    needle.hand = hand;
    if (speed < layers.needle->stick_speed) needle.slipping = false;
    const double in_motion = drag_up_to(needle, layers, along_line(needle, tip));
    const double most = needle.slipping ? in_motion : in_motion * layers.needle->static_ratio;
    // The tissue that sticks to the shaft gives a little, as stiff as a surface.
    const double stiffness = input.force.stiffness * input.device_per_volume;
    const double force = stiffness * (needle.anchor - hand);
    if (!(std::abs(force) > most)) return force;
    needle.slipping = true;
    const double slides = std::copysign(in_motion, force);
    needle.anchor = stiffness > 0 ? hand + slides / stiffness : hand;
    return slides;
}

}  // namespace palpate

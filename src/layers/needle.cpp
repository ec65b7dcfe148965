// Needle: crossings of the shaft, and Karnopp's friction along it.
#include "layers/needle.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Friction on the shaft up to `tip` [N]: the drag of each layer times the length in it.
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

std::array<double, 2> parts_within(double limit, const Spring& one, const Spring& other) {
    // The hand counts as nearer by `shift` times the force, so that the force is on the limit.
    double shift = 0;
    std::array<double, 2> parts{1, 1};
    const auto length = [](double a, double b) { return std::sqrt(a * a + b * b); };
    if (!(length(one.force, other.force) > limit)) return parts;
    if (!(limit > 0)) return {0, 0};
    // Newton's method comes to it from below, for 1 / force is concave in the shift.
    for (int i = 0; i < 20; ++i) {
        const double a = parts[0] * one.force, b = parts[1] * other.force;
        const double force = length(a, b);
        const double falls =
            (a * a * parts[0] * one.stiffness + b * b * parts[1] * other.stiffness) /
            force;  // with the shift
        if (!(force > limit * (1 + 1e-15)) || !(falls > 0)) break;
        shift += (force / limit - 1) * force / falls;
        parts = {1 / (1 + shift * one.stiffness), 1 / (1 + shift * other.stiffness)};
    }
    return parts;
}

double shaft_friction(NeedleState& needle, const Layers& layers, const LayerInput& input,
                      const Vec3& tip, double period, double least, double greatest) {
    const double hand = along_line(needle, input.hip);
    const double speed =
        period > 0 ? std::abs(hand - needle.hand) * input.device_per_volume / period : 0;
    needle.hand = hand;
    if (speed < layers.needle->stick_speed) needle.slipping = false;
    const double in_motion = drag_up_to(needle, layers, along_line(needle, tip));
    const double most = needle.slipping ? in_motion : in_motion * layers.needle->static_ratio;
    // The tissue that sticks to the shaft gives a little, as stiff as a surface.
    const double stiffness = input.force.stiffness * input.device_per_volume;
    double force = stiffness * (needle.anchor - hand);
    if (!(std::abs(force) > most) && force >= least && force <= greatest) return force;
    needle.slipping = true;
    if (std::abs(force) > most) force = std::copysign(in_motion, force);
    force = std::clamp(force, least, greatest);
    needle.anchor = stiffness > 0 ? hand + force / stiffness : hand;
    return force;
}

}  // namespace palpate

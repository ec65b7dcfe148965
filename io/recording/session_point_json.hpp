// The members of where a session is (SessionPoint), for settings_json.cpp.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <type_traits>

#include "io/json_members.hpp"

namespace palpate::io {

/// Whole numbers of any kind.
template <class T>
static void whole(auto& v, const std::string& name, T& value, double low, double high) {
    auto number = static_cast<double>(value);
    v(name, number);
    if constexpr (!std::is_const_v<T>) {
        if (number != std::floor(number) || !(number >= low && number <= high)) {
            wrong_member(name, "a whole number within its range");
        }
        value = static_cast<T>(number);
    }
}

/// The first `count` values of an array, each under a name that ends with its number.
static void numbered(auto& v, const std::string& name, auto& values, int count) {
    for (int i = 0; i < count; ++i) {
        v(name + std::to_string(i + 1), values[static_cast<std::size_t>(i)]);
    }
}

PALPATE_JSON(HandPast, begun, seen, holding, last_tick, seen_at, hand, frozen_hand, tool,
             frozen_tool, held_hip, held_tool)

static void members(auto& v, Is<Tetrahedron> auto& s) {
    for (int i = 0; i < 3; ++i) {
        const std::string axis(1, "xyz"[i]);
        const auto k = static_cast<std::size_t>(i);
        whole(v, "cell_" + axis, s.cell[i], -farthest_index, farthest_index);
        whole(v, "axis_" + axis, s.axis[k], 0, 2);
        whole(v, "sign_" + axis, s.sign[k], -1, 1);
    }
}

static void members(auto& v, Is<Proxy> auto& s) {
    v("tetrahedron", s.scp.tetrahedron);
    v("folded", s.scp.folded);
    v("scp", s.scp_physical);
    PALPATE_MEMBERS(isovalue, behind, turned)
    whole(v, "mode", s.mode, 0, 1);
    whole(v, "interpolation", s.interpolation, 0, 1);
    PALPATE_MEMBERS(placed, sliding, recovery_reach)
    v("ahead", s.normal_before);
}

PALPATE_JSON(MotorHeat, warmth, time, force)

PALPATE_JSON(ForceState, started, waiting, changed, time, ramp_begin, hand, velocity, force, spring,
             turns, orientation, angular_velocity, torque, turning_spring, motors)

PALPATE_JSON(ContactSpring, touching, stiffness, rest)

static void members(auto& v, Is<Crossing> auto& s) {
    v("at", s.at);
    whole(v, "surface", s.surface, 0, Layers::most_layers);
    whole(v, "layer", s.layer, -1, Layers::most_layers);
}

static void members(auto& v, Is<NeedleState> auto& s) {
    PALPATE_MEMBERS(inserted, entry, axis, hand, anchor, aside, slipping)
    whole(v, "crossing_count", s.crossing_count, 0, NeedleState::most_crossings);
    numbered(v, "crossing_", s.crossings, s.crossing_count);
}

static void members(auto& v, Is<LayerState> auto& s) {
    whole(v, "layer_count", s.layer_count, -1, Layers::most_layers);
    whole(v, "level_count", s.level_count, -1, Layers::most_layers);
    PALPATE_MEMBERS(open, label_opening)
    whole(v, "outer", s.outer, 0, Layers::most_layers);
    whole(v, "inner", s.inner, 0, Layers::most_layers);
    numbered(v, "opening_", s.opening, s.inner);
    whole(v, "touched", s.touched, -1, Layers::most_layers);
    PALPATE_MEMBERS(spring, needle, moved, time, hip)
}

static void members(auto& v, Is<ToolContact> auto& s) {
    whole(v, "point", s.point, 0, static_cast<double>(most_tool_points));
    PALPATE_MEMBERS(place, normal, pressure)
}

static void members(auto& v, Is<SessionPoint> auto& s) {
    PALPATE_MEMBERS(moment, speed, frozen, clutched, starts_inside, past, proxy,
                    isovalue_without_layers, drawn_to, force, layers)
    auto& tool = s.tool;
    v("tool", tool.pose.position);
    v("tool_orientation", tool.pose.orientation);
    whole(v, "tool_mode", tool.mode, 0, 1);
    v("tool_placed", tool.placed);
    v("tool_slides", tool.sliding);
    v("trust", tool.trust);
    v("stride", tool.stride);
    whole(v, "contact_count", tool.contact_count, 0, most_tool_contacts);
    for (int i = 0; i < tool.contact_count; ++i) {
        const std::string number = std::to_string(i + 1);
        v("contact_" + number, tool.contacts[static_cast<std::size_t>(i)]);
        whole(v, "idle_" + number, tool.idle[static_cast<std::size_t>(i)], 0, 1e9);
    }
}

PALPATE_JSON(command::Resume, point)

}  // namespace palpate::io

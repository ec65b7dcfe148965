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

static void members(auto& v, Is<HandPast> auto& s) {
    v("begun", s.begun);
    v("seen", s.seen);
    v("holding", s.holding);
    v("last_tick", s.last_tick);
    v("seen_at", s.seen_at);
    v("hand", s.hand);
    v("frozen_hand", s.frozen_hand);
    v("tool", s.tool);
    v("frozen_tool", s.frozen_tool);
    v("held_hip", s.held_hip);
    v("held_tool", s.held_tool);
}

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
    v("isovalue", s.isovalue);
    v("behind", s.behind);
    v("turned", s.turned);
    whole(v, "mode", s.mode, 0, 1);
    whole(v, "interpolation", s.interpolation, 0, 1);
    v("placed", s.placed);
    v("sliding", s.sliding);
    v("recovery_reach", s.recovery_reach);
    v("ahead", s.normal_before);
}

static void members(auto& v, Is<MotorHeat> auto& s) {
    v("warmth", s.warmth);
    v("time", s.time);
    v("force", s.force);
}

static void members(auto& v, Is<ForceState> auto& s) {
    v("started", s.started);
    v("waiting", s.waiting);
    v("changed", s.changed);
    v("time", s.time);
    v("ramp_begin", s.ramp_begin);
    v("hand", s.hand);
    v("velocity", s.velocity);
    v("force", s.force);
    v("spring", s.spring);
    v("turns", s.turns);
    v("orientation", s.orientation);
    v("angular_velocity", s.angular_velocity);
    v("torque", s.torque);
    v("turning_spring", s.turning_spring);
    v("motors", s.motors);
}

static void members(auto& v, Is<ContactSpring> auto& s) {
    v("touching", s.touching);
    v("stiffness", s.stiffness);
    v("rest", s.rest);
}

static void members(auto& v, Is<Crossing> auto& s) {
    v("at", s.at);
    whole(v, "surface", s.surface, 0, Layers::most_layers);
    whole(v, "layer", s.layer, -1, Layers::most_layers);
}

static void members(auto& v, Is<NeedleState> auto& s) {
    v("inserted", s.inserted);
    v("entry", s.entry);
    v("axis", s.axis);
    v("hand", s.hand);
    v("anchor", s.anchor);
    v("aside", s.aside);
    v("slipping", s.slipping);
    whole(v, "crossing_count", s.crossing_count, 0, NeedleState::most_crossings);
    for (int i = 0; i < s.crossing_count; ++i) {
        v("crossing_" + std::to_string(i + 1), s.crossings[static_cast<std::size_t>(i)]);
    }
}

static void members(auto& v, Is<LayerState> auto& s) {
    whole(v, "layer_count", s.layer_count, -1, Layers::most_layers);
    whole(v, "level_count", s.level_count, -1, Layers::most_layers);
    v("open", s.open);
    v("label_opening", s.label_opening);
    whole(v, "outer", s.outer, 0, Layers::most_layers);
    whole(v, "inner", s.inner, 0, Layers::most_layers);
    for (int i = 0; i < s.inner; ++i) {
        v("opening_" + std::to_string(i + 1), s.opening[static_cast<std::size_t>(i)]);
    }
    whole(v, "touched", s.touched, -1, Layers::most_layers);
    v("spring", s.spring);
    v("needle", s.needle);
    v("moved", s.moved);
    v("time", s.time);
    v("hip", s.hip);
}

static void members(auto& v, Is<ToolContact> auto& s) {
    whole(v, "point", s.point, 0, static_cast<double>(most_tool_points));
    v("place", s.place);
    v("normal", s.normal);
    v("pressure", s.pressure);
}

static void members(auto& v, Is<SessionPoint> auto& s) {
    v("moment", s.moment);
    v("speed", s.speed);
    v("frozen", s.frozen);
    v("clutched", s.clutched);
    v("starts_inside", s.starts_inside);
    v("past", s.past);
    v("proxy", s.proxy);
    v("isovalue_without_layers", s.isovalue_without_layers);
    v("drawn_to", s.drawn_to);
    v("force", s.force);
    v("layers", s.layers);
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

static void members(auto& v, Is<command::Resume> auto& s) {
    v("point", s.point);
}

}  // namespace palpate::io

// Makes sliders for the force settings, from their table.
#include "apps/viewer/panel/force_controls.hpp"

#include <algorithm>

#include "apps/viewer/panel/force_rows.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/section.hpp"
#include "palpate/settings.hpp"

namespace palpate::viewer {
namespace {

/// Damping must stay below its end, not on it.
constexpr double just_below = 1 - 1e-9;

using Settings = RendererSettings;

/// Calls visit(setting, number) for each number that the panel shows.
void for_each_row(Settings& settings, auto&& visit) {
    const auto each = [&](const std::string&, const auto& setting, double& number) {
        visit(setting, number);
    };
    for_each_number("force", settings.force, each);
    for_each_number("friction", settings.proxy.friction, each);
}

std::vector<ForceRow> all_rows() {
    std::vector<ForceRow> rows;
    Settings usual;
    for_each_row(usual, [&](const auto& setting, double number) {
        rows.push_back(row_of({setting.title, setting.unit, setting.about}, setting.range, number));
    });
    std::ranges::stable_sort(rows, {}, &ForceRow::place);
    return rows;
}

}  // namespace

ForceControls::ForceControls(Effect& effect) : effect_(effect) {
    auto *plain = new QWidget, *advanced = new QWidget;
    auto *plain_form = new QFormLayout(plain), *advanced_form = new QFormLayout(advanced);
    for (QFormLayout* form : {plain_form, advanced_form}) {
        form->setContentsMargins(0, 0, 0, 0);
        form->setVerticalSpacing(3);
    }
    for (const ForceRow& row : all_rows()) {
        auto* quantity = new Quantity(row.name, row.unit, row.low, row.high, row.step);
        quantity->set_accessible_name(row.label);
        quantity->box().set_infinite(row.infinite);
        add_row(row.plain ? *plain_form : *advanced_form, row.label, quantity, row.tip);
        rows_[row.name] = quantity;
        connect(quantity, &Quantity::wanted, this,
                [this, name = row.name](double value) { change(name, value); });
    }
    auto* fold = new Section(tr("Advanced"), "force_advanced", advanced);
    fold->set_open(false);
    column_in(this, {plain, fold});
    connect(&effect, &Effect::changed, this, &ForceControls::show);
    for (const auto over : {&Effect::begun, &Effect::ended}) {
        connect(&effect, over, this, [this] {
            for (const auto& row : rows_) row.second->drop();
        });
    }
}

void ForceControls::change(const QString& name, double value) {
    if (!effect_.there()) return;
    Settings next = effect_.settings();
    for_each_row(next, [&](const auto& setting, double& number) {
        if (row_name(setting.title) == name) number = value;
    });
    Friction& friction = next.proxy.friction;
    const bool rubs = name == "static_friction" || name == "dynamic_friction";
    if (name == "static_friction") {  // dynamic friction must not exceed it
        friction.dynamic_coefficient = std::min(friction.dynamic_coefficient, value);
    }
    effect_.request(rubs ? Command(friction) : Command(next.force));
}

void ForceControls::show() {
    Settings settings = effect_.settings();
    set_ends(settings);
    for_each_row(settings, [&](const auto& setting, double number) {
        rows_.at(row_name(setting.title))->set_value(number);
    });
}

/// The limits of check(ForceSettings, DeviceLimits).
void ForceControls::set_ends(const RendererSettings& settings) {
    const ForceSettings& force = settings.force;
    const DeviceLimits& limits = settings.device;
    const auto end = [this](const char* name, double high) {
        rows_.at(name)->set_ends(rows_.at(name)->low(), high);
    };
    const double most = greatest_stiffness(limits, force.damping + force.viscosity);
    end("stiffness", most);
    const double room = limits.physical_damping *
                        (1 - force.stiffness / greatest_stiffness(limits, 0)) * just_below;
    end("damping", room - force.viscosity);
    end("viscosity", room - force.damping);
    end("dynamic_friction", settings.proxy.friction.static_coefficient);
    const double pull =
        force.magnet.distance > 0 ? most * force.magnet.distance / 4 : limits.maximum_force;
    end("magnet_peak", std::min(limits.maximum_force, pull * just_below));
    end("force_limit", limits.maximum_force);
    DeviceLimits turning = limits;
    turning.physical_damping = limits.physical_rotational_damping;
    end("rotational_stiffness", greatest_stiffness(turning, force.rotational_damping));
    end("rotational_damping",
        turning.physical_damping *
            (1 - force.rotational_stiffness / greatest_stiffness(turning, 0)) * just_below);
    if (limits.maximum_torque > 0) end("torque_limit", limits.maximum_torque);
}

}  // namespace palpate::viewer

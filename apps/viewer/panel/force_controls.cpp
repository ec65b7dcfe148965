// Makes sliders for the force settings.
#include "apps/viewer/panel/force_controls.hpp"

#include <QFormLayout>
#include <QLabel>

#include <algorithm>

namespace palpate::viewer {
namespace {

/// Damping must stay below its end, not on it.
constexpr double just_below = 1 - 1e-9;

}  // namespace

Quantity* ForceControls::row(QFormLayout& form, const QString& label, const QString& name,
                             const QString& unit, double high, double step, const QString& tip) {
    auto* quantity = new Quantity(name, unit, 0, high, step);
    quantity->setToolTip(tip);
    quantity->set_accessible_name(label);
    auto* text = new QLabel(label);
    text->setToolTip(tip);
    text->setBuddy(quantity);
    form.addRow(text, quantity);
    return quantity;
}

ForceControls::ForceControls(QWidget* parent) : QWidget(parent) {
    auto* form = new QFormLayout(this);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    stiffness_ = row(*form, "Stiffness", "stiffness", "N/mm", 1, 0.05,
                     "Stiffness k of the spring between hand and proxy [N/mm].\nThe slider ends "
                     "where device and loop can no longer render it stably.");
    damping_ = row(*form, "Damping", "damping", "N s/mm", 1e-3, 1e-4,
                   "Against the hand's motion along the contact normal [N s/mm]; pulls nobody in");
    viscosity_ = row(*form, "Viscosity", "viscosity", "N s/mm", 1e-3, 1e-4,
                     "Of the medium, against all motion, in contact or not [N s/mm]");
    static_friction_ = row(*form, "Static friction", "static_friction", "", 1.5, 0.05,
                           "Coefficient past which the proxy begins to slide (no unit)");
    dynamic_friction_ = row(*form, "Dynamic friction", "dynamic_friction", "", 1.5, 0.05,
                            "Coefficient while the proxy slides, at most the static one (no unit)");
    amplitude_ = row(*form, "Texture height", "texture_amplitude", "mm", 0.5, 0.01,
                     "Height of the bumps [mm in the volume]; 0: smooth");
    wavelength_ = row(*form, "Texture length", "texture_wavelength", "mm", 20, 0.5,
                      "From bump to bump [mm in the volume]");
    distance_ = row(*form, "Magnet reach", "magnet_distance", "mm", 10, 0.5,
                    "From how far a free hand is pulled to the surface [mm of the hand]; 0: off");
    peak_ = row(*form, "Magnet force", "magnet_peak", "N", 1, 0.1,
                "Most that the magnet pulls, half-way to the surface [N]");
    limit_ = row(*form, "Force limit", "force_limit", "N", 3.3, 0.1,
                 "Most force asked of the device [N]; the device's own limit holds besides");
    limit_->box().set_infinite(true);
    connect_force();
}

void ForceControls::connect_force() {
    // `setting` gives the number that the slider sets.
    const auto bind = [this](Quantity* quantity, auto setting) {
        connect(quantity, &Quantity::wanted, this, [this, setting](double value) {
            ForceSettings force = force_;
            setting(force) = value;
            Q_EMIT force_wanted(force);
        });
    };
    bind(stiffness_, [](ForceSettings& f) -> double& { return f.stiffness; });
    bind(damping_, [](ForceSettings& f) -> double& { return f.damping; });
    bind(viscosity_, [](ForceSettings& f) -> double& { return f.viscosity; });
    bind(limit_, [](ForceSettings& f) -> double& { return f.limit; });
    bind(amplitude_, [](ForceSettings& f) -> double& { return f.texture.amplitude; });
    bind(wavelength_, [](ForceSettings& f) -> double& { return f.texture.wavelength; });
    bind(distance_, [](ForceSettings& f) -> double& { return f.magnet.distance; });
    bind(peak_, [](ForceSettings& f) -> double& { return f.magnet.peak; });
    connect(static_friction_, &Quantity::wanted, this, [this](double value) {
        // Dynamic friction must not exceed static friction, so it is lowered with it.
        Q_EMIT friction_wanted({value, std::min(friction_.dynamic_coefficient, value)});
    });
    connect(dynamic_friction_, &Quantity::wanted, this, [this](double value) {
        Q_EMIT friction_wanted({friction_.static_coefficient, value});
    });
}

void ForceControls::set_settings(const ForceSettings& force, const Friction& friction,
                                 const DeviceLimits& limits) {
    force_ = force;
    friction_ = friction;
    limits_ = limits;
    set_ends();
    stiffness_->set_value(force.stiffness);
    damping_->set_value(force.damping);
    viscosity_->set_value(force.viscosity);
    static_friction_->set_value(friction.static_coefficient);
    dynamic_friction_->set_value(friction.dynamic_coefficient);
    amplitude_->set_value(force.texture.amplitude);
    wavelength_->set_value(force.texture.wavelength);
    distance_->set_value(force.magnet.distance);
    peak_->set_value(force.magnet.peak);
    limit_->set_value(force.limit);
}

/// The limits of check(ForceSettings, DeviceLimits).
void ForceControls::set_ends() {
    const double most = greatest_stiffness(limits_, force_.damping + force_.viscosity);
    stiffness_->set_ends(0, most);
    const double room =
        (limits_.physical_damping - force_.stiffness / (2 * limits_.rate)) * just_below;
    damping_->set_ends(0, room - force_.viscosity);
    viscosity_->set_ends(0, room - force_.damping);
    dynamic_friction_->set_ends(0, friction_.static_coefficient);
    wavelength_->set_ends(0.1, 20);
    const double pull =
        force_.magnet.distance > 0 ? most * force_.magnet.distance / 4 : limits_.maximum_force;
    peak_->set_ends(0, std::min(limits_.maximum_force, pull * just_below));
    limit_->set_ends(0, limits_.maximum_force);
}

void ForceControls::drop() {
    for (Quantity* quantity :
         {stiffness_, damping_, viscosity_, static_friction_, dynamic_friction_, amplitude_,
          wavelength_, distance_, peak_, limit_}) {
        quantity->drop();
    }
}

}  // namespace palpate::viewer

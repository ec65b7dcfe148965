// Makes sliders for the force settings.
#include "apps/viewer/panel/force_controls.hpp"

#include <algorithm>
#include <array>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/section.hpp"

namespace palpate::viewer {
namespace {

/// Damping must stay below its end, not on it.
constexpr double just_below = 1 - 1e-9;

using Settings = RendererSettings;

struct ForceRow {
    const char *label, *name, *unit;
    double high, step;  // of the slider, the box
    double& (*number)(Settings&);
    const char* tip;
};

/// Rows that are treated specially, by their number.
namespace force_row {
enum : std::size_t {
    stiffness = 0,
    damping = 1,
    viscosity = 2,
    static_friction = 3,
    dynamic_friction = 4,
    wavelength = 6,
    peak = 8,
    limit = 9
};
/// Those that everybody needs; the others are advanced.
constexpr bool is_plain(std::size_t row) {
    return row == stiffness || row == static_friction || row == limit;
}
}  // namespace force_row

constexpr std::array force_rows{
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Stiffness"), "stiffness", "N/mm",
             1, 0.05, [](Settings& s) -> double& { return s.force.stiffness; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "Stiffness k of the spring between hand and proxy [N/mm].\nThe "
                               "slider ends where device "
                               "and loop can no longer render it stably.")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Damping"), "damping", "N s/mm",
             1e-3, 1e-4, [](Settings& s) -> double& { return s.force.damping; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "Against the hand's motion along the contact normal [N s/mm]; never "
                               "pulls the hand in")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Viscosity"), "viscosity",
             "N s/mm", 1e-3, 1e-4, [](Settings& s) -> double& { return s.force.viscosity; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "Of the medium, against all motion, in contact or not [N s/mm]")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Static friction"),
             "static_friction", "", 1.5, 0.05,
             [](Settings& s) -> double& { return s.proxy.friction.static_coefficient; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "Coefficient past which the proxy begins to slide (no unit)")},
    ForceRow{
        QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Dynamic friction"), "dynamic_friction",
        "", 1.5, 0.05, [](Settings& s) -> double& { return s.proxy.friction.dynamic_coefficient; },
        QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                          "Coefficient while the proxy slides, at most the static one (no unit)")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Texture height"),
             "texture_amplitude", "mm", 0.5, 0.01,
             [](Settings& s) -> double& { return s.force.texture.amplitude; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "Height of the bumps [mm in the volume]; 0: smooth")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Texture length"),
             "texture_wavelength", "mm", 20, 0.5,
             [](Settings& s) -> double& { return s.force.texture.wavelength; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "From bump to bump [mm in the volume]")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Magnet reach"), "magnet_distance",
             "mm", 10, 0.5, [](Settings& s) -> double& { return s.force.magnet.distance; },
             QT_TRANSLATE_NOOP(
                 "palpate::viewer::ForceControls",
                 "From how far a free hand is pulled to the surface [mm of the hand]; 0: off")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Magnet force"), "magnet_peak",
             "N", 1, 0.1, [](Settings& s) -> double& { return s.force.magnet.peak; },
             QT_TRANSLATE_NOOP("palpate::viewer::ForceControls",
                               "Greatest pull of the magnet, half-way to the surface [N]")},
    ForceRow{QT_TRANSLATE_NOOP("palpate::viewer::ForceControls", "Force limit"), "force_limit", "N",
             3.3, 0.1, [](Settings& s) -> double& { return s.force.limit; },
             QT_TRANSLATE_NOOP(
                 "palpate::viewer::ForceControls",
                 "Greatest force asked of the device [N]; the device's own limit holds as well")}};

}  // namespace

ForceControls::ForceControls(Effect& effect) : effect_(effect) {
    auto *plain = new QWidget, *advanced = new QWidget;
    auto *plain_form = new QFormLayout(plain), *advanced_form = new QFormLayout(advanced);
    for (QFormLayout* form : {plain_form, advanced_form}) {
        form->setContentsMargins(0, 0, 0, 0);
        form->setVerticalSpacing(3);
    }
    for (std::size_t i = 0; i < force_rows.size(); ++i) {
        const ForceRow& made = force_rows[i];
        auto* quantity = new Quantity(made.name, made.unit, 0, made.high, made.step);
        quantity->set_accessible_name(tr(made.label));
        add_row(force_row::is_plain(i) ? *plain_form : *advanced_form, tr(made.label), quantity,
                tr(made.tip));
        rows_.push_back(quantity);
        connect(quantity, &Quantity::wanted, this, [this, i](double value) { change(i, value); });
    }
    rows_[force_row::limit]->box().set_infinite(true);
    auto* fold = new Section(tr("Advanced"), "force_advanced", advanced);
    fold->set_open(false);
    column_in(this, {plain, fold});
    connect(&effect, &Effect::changed, this, &ForceControls::show);
    for (const auto over : {&Effect::begun, &Effect::ended}) {
        connect(&effect, over, this, [this] {
            for (Quantity* quantity : rows_) quantity->drop();
        });
    }
}

void ForceControls::change(std::size_t number, double value) {
    if (!effect_.there()) return;
    Settings next = effect_.settings();
    force_rows[number].number(next) = value;
    Friction& friction = next.proxy.friction;
    if (number == force_row::static_friction) {  // dynamic friction must not exceed it
        friction.dynamic_coefficient = std::min(friction.dynamic_coefficient, value);
    }
    const bool rubs = number == force_row::static_friction || number == force_row::dynamic_friction;
    effect_.request(rubs ? Command(friction) : Command(next.force));
}

void ForceControls::show() {
    Settings settings = effect_.settings();
    set_ends(settings);
    for (std::size_t i = 0; i < force_rows.size(); ++i)
        rows_[i]->set_value(force_rows[i].number(settings));
}

/// The limits of check(ForceSettings, DeviceLimits).
void ForceControls::set_ends(const RendererSettings& settings) {
    const ForceSettings& force = settings.force;
    const DeviceLimits& limits = settings.device;
    const double most = greatest_stiffness(limits, force.damping + force.viscosity);
    rows_[force_row::stiffness]->set_ends(0, most);
    const double room = limits.physical_damping *
                        (1 - force.stiffness / greatest_stiffness(limits, 0)) * just_below;
    rows_[force_row::damping]->set_ends(0, room - force.viscosity);
    rows_[force_row::viscosity]->set_ends(0, room - force.damping);
    rows_[force_row::dynamic_friction]->set_ends(0, settings.proxy.friction.static_coefficient);
    rows_[force_row::wavelength]->set_ends(0.1, 20);
    const double pull =
        force.magnet.distance > 0 ? most * force.magnet.distance / 4 : limits.maximum_force;
    rows_[force_row::peak]->set_ends(0, std::min(limits.maximum_force, pull * just_below));
    rows_[force_row::limit]->set_ends(0, limits.maximum_force);
}

}  // namespace palpate::viewer

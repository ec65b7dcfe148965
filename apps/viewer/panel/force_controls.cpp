// Makes sliders for the force settings, from their table and words that only a window needs.
#include "apps/viewer/panel/force_controls.hpp"

#include <QCoreApplication>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/viewer/panel/layout.hpp"
#include "palpate/settings.hpp"

namespace palpate::viewer {
namespace {

/// What the table of settings does not say.
struct RowWords {
    const char* name;   // of the row
    double high, step;  // of the slider, the box
    const char *label, *tip;
    bool plain = false;  // everybody needs it; the others are advanced
};

struct ForceRows {
    Q_DECLARE_TR_FUNCTIONS(ForceRows)
  public:
    /// In the order of the rows.
    static constexpr RowWords all[] = {
        {"stiffness", 1, 0.05, QT_TR_NOOP("Stiffness"),
         QT_TR_NOOP("Stiffness k of the spring between hand and proxy [N/mm].\nThe slider "
                    "ends where device and loop can no longer render it stably."),
         true},
        {"damping", 1e-3, 1e-4, QT_TR_NOOP("Damping"),
         QT_TR_NOOP("Against the hand's motion along the contact normal [N s/mm]; never "
                    "pulls the hand in")},
        {"viscosity", 1e-3, 1e-4, QT_TR_NOOP("Viscosity"),
         QT_TR_NOOP("Of the medium, against all motion, in contact or not [N s/mm]")},
        {"static_friction", 1.5, 0.05, QT_TR_NOOP("Static friction"),
         QT_TR_NOOP("Coefficient past which the proxy begins to slide (no unit)"), true},
        {"dynamic_friction", 1.5, 0.05, QT_TR_NOOP("Dynamic friction"),
         QT_TR_NOOP("Coefficient while the proxy slides, at most the static one (no unit)")},
        {"texture_amplitude", 0.5, 0.01, QT_TR_NOOP("Texture height"),
         QT_TR_NOOP("Height of the bumps [mm in the volume]; 0: smooth")},
        {"texture_wavelength", 20, 0.5, QT_TR_NOOP("Texture length"),
         QT_TR_NOOP("From bump to bump [mm in the volume]")},
        {"magnet_distance", 10, 0.5, QT_TR_NOOP("Magnet reach"),
         QT_TR_NOOP("From how far a free hand is pulled to the surface [mm of the hand]; 0: off")},
        {"magnet_peak", 1, 0.1, QT_TR_NOOP("Magnet force"),
         QT_TR_NOOP("Greatest pull of the magnet, half-way to the surface [N]")},
        {"force_limit", 3.3, 0.1, QT_TR_NOOP("Force limit"),
         QT_TR_NOOP("Greatest force asked of the device [N]; the device's own limit holds as well"),
         true},
        {"force_rate_limit", 5000, 100, QT_TR_NOOP("Force rate"),
         QT_TR_NOOP("Greatest change of the force [N/s]; a stop may drop it at once")},
        {"force_ramp", 2, 0.05, QT_TR_NOOP("Force ramp"),
         QT_TR_NOOP("How long the force rises at the start and after a pause [s]")},
        {"force_to_start_below", 3.3, 0.1, QT_TR_NOOP("Starts below"),
         QT_TR_NOOP("After a start or a pause there is no force until the computed one is "
                    "this small [N]; inf: it begins at any")},
        {"stale_time", 0.1, 0.005, QT_TR_NOOP("Stale after"),
         QT_TR_NOOP("Longest time from one reading of the device to the next [s]; a longer "
                    "one is a pause without force")},
        {"rotational_stiffness", 1000, 10, QT_TR_NOOP("Turning stiffness"),
         QT_TR_NOOP("Stiffness against turning a tool [N mm/rad]; 0: from the stiffness "
                    "and the tool's size")},
        {"rotational_damping", 1, 0.01, QT_TR_NOOP("Turning damping"),
         QT_TR_NOOP("Against the turning of a tool [N mm s/rad]; never turns the hand further")},
        {"torque_limit", 500, 10, QT_TR_NOOP("Torque limit"),
         QT_TR_NOOP(
             "Greatest torque asked of the device [N mm]; the device's own limit holds as well")},
        {"torque_rate_limit", 5e5, 1e4, QT_TR_NOOP("Torque rate"),
         QT_TR_NOOP("Greatest change of the torque [N mm/s]; a stop may drop it at once")}};
};

}  // namespace

QString row_name(const char* title) {
    return QString(title).replace(' ', '_');
}

ForceRow row_of(const SettingWords& setting, const ValueRange& range, double usual) {
    ForceRow row;
    row.name = row_name(setting.title);
    row.unit = QString(setting.unit).remove("device ").remove(", physical");
    row.infinite = range.has(ranges::infinity);
    const auto* said = std::ranges::find_if(
        ForceRows::all, [&](const RowWords& one) { return row.name == one.name; });
    row.place = int(said - std::begin(ForceRows::all));
    if (said != std::end(ForceRows::all)) {
        row.label = ForceRows::tr(said->label);
        row.tip = ForceRows::tr(said->tip);
        row.high = said->high;
        row.step = said->step;
        row.plain = said->plain;
    } else {
        const QString title(setting.title);
        row.label = title.left(1).toUpper() + title.mid(1);
        row.tip = QString(setting.about);
        if (*setting.unit != '\0') row.tip += QString(" [%1]").arg(setting.unit);
        row.high = std::isfinite(usual) && usual > 0 ? 4 * usual : 1;
        row.step = row.high / 50;
    }
    row.low = range.has(0) ? 0 : row.step;
    return row;
}

namespace {

/// Damping must stay below its end, not on it.
constexpr double just_below = 1 - 1e-9;

bool is_shown(const std::string& path) {
    return !path.starts_with("limits.");
}

/// With the paths of their numbers, in the order in which they stand.
std::vector<std::pair<ForceRow, std::string>> all_rows() {
    std::vector<std::pair<ForceRow, std::string>> rows;
    RendererSettings usual;
    for_each_live_number(
        usual, [&](const std::string& path, const auto& one, double number, const auto&) {
            if (!is_shown(path)) return;
            rows.emplace_back(row_of({one.title, one.unit, one.about}, one.range, number), path);
        });
    std::ranges::stable_sort(rows, {}, [](const auto& row) { return row.first.place; });
    return rows;
}

}  // namespace

ForceControls::ForceControls(Effect& effect) : effect_(effect) {
    auto *plain = new QWidget, *advanced = new QWidget;
    auto *plain_form = form_in(plain), *advanced_form = form_in(advanced);
    for (const auto& [row, its_path] : all_rows()) {
        const std::string& path = its_path;
        auto* quantity =
            quantity_in(row.plain ? *plain_form : *advanced_form, {row.name, row.label, row.tip},
                        {row.unit, row.low, row.high, row.step},
                        {[this, path] { return number_at(path); },
                         [this, path](double value) { change(path, value); }});
        quantity->box().set_infinite(row.infinite);
    }
    auto* fold = new Section(tr("Advanced"), "force_advanced", advanced);
    fold->set_open(false);
    column_in(this, {plain, fold});
    connect(&effect, &Effect::changed, this, [this] {
        set_ends();
        refresh();
    });
}

double ForceControls::number_at(const std::string& path) const {
    double found = 0;
    visit_live_number(effect_.settings(), path,
                      [&](double number, const auto&) { found = number; });
    return found;
}

void ForceControls::change(const std::string& path, double value) {
    RendererSettings next = effect_.settings();
    Command command = palpate::change(next, path, value);
    if (auto* friction = std::get_if<Friction>(&command);
        friction && path.ends_with("static_coefficient")) {
        friction->dynamic_coefficient = std::min(friction->dynamic_coefficient, value);
    }
    effect_.request(command);
}

/// The limits of check(ForceSettings, DeviceLimits).
void ForceControls::set_ends() {
    const ForceSettings& force = effect_.settings().force;
    const DeviceLimits& limits = effect_.settings().device;
    const auto end = [this](const char* name, double high) {
        auto* row = findChild<Quantity*>(name);
        row->set_ends(row->low(), high);
    };
    const double most = greatest_stiffness(limits, force.damping + force.viscosity);
    end("stiffness", most);
    const double room = limits.physical_damping *
                        (1 - force.stiffness / greatest_stiffness(limits, 0)) * just_below;
    end("damping", room - force.viscosity);
    end("viscosity", room - force.damping);
    end("dynamic_friction", effect_.settings().proxy.friction.static_coefficient);
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

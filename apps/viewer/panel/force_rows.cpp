// Words, ends and steps of the rows of force settings.
#include "apps/viewer/panel/force_rows.hpp"

#include <QCoreApplication>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::viewer {
namespace {

/// Words of this file.
struct ForceRows {
    Q_DECLARE_TR_FUNCTIONS(ForceRows)
};

/// What the table of settings does not say.
struct Words {
    const char* name;   // of the row
    double high, step;  // of the slider, the box
    const char *label, *tip;
    bool plain = false;  // everybody needs it; the others are advanced
};

/// In the order of the rows.
constexpr std::array words{
    Words{"stiffness", 1, 0.05, QT_TRANSLATE_NOOP("ForceRows", "Stiffness"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Stiffness k of the spring between hand and proxy [N/mm].\nThe slider "
                            "ends where device and loop can no longer render it stably."),
          true},
    Words{"damping", 1e-3, 1e-4, QT_TRANSLATE_NOOP("ForceRows", "Damping"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Against the hand's motion along the contact normal [N s/mm]; never "
                            "pulls the hand in")},
    Words{"viscosity", 1e-3, 1e-4, QT_TRANSLATE_NOOP("ForceRows", "Viscosity"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Of the medium, against all motion, in contact or not [N s/mm]")},
    Words{"static_friction", 1.5, 0.05, QT_TRANSLATE_NOOP("ForceRows", "Static friction"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Coefficient past which the proxy begins to slide (no unit)"),
          true},
    Words{"dynamic_friction", 1.5, 0.05, QT_TRANSLATE_NOOP("ForceRows", "Dynamic friction"),
          QT_TRANSLATE_NOOP(
              "ForceRows", "Coefficient while the proxy slides, at most the static one (no unit)")},
    Words{"texture_amplitude", 0.5, 0.01, QT_TRANSLATE_NOOP("ForceRows", "Texture height"),
          QT_TRANSLATE_NOOP("ForceRows", "Height of the bumps [mm in the volume]; 0: smooth")},
    Words{"texture_wavelength", 20, 0.5, QT_TRANSLATE_NOOP("ForceRows", "Texture length"),
          QT_TRANSLATE_NOOP("ForceRows", "From bump to bump [mm in the volume]")},
    Words{"magnet_distance", 10, 0.5, QT_TRANSLATE_NOOP("ForceRows", "Magnet reach"),
          QT_TRANSLATE_NOOP(
              "ForceRows",
              "From how far a free hand is pulled to the surface [mm of the hand]; 0: off")},
    Words{
        "magnet_peak", 1, 0.1, QT_TRANSLATE_NOOP("ForceRows", "Magnet force"),
        QT_TRANSLATE_NOOP("ForceRows", "Greatest pull of the magnet, half-way to the surface [N]")},
    Words{"force_limit", 3.3, 0.1, QT_TRANSLATE_NOOP("ForceRows", "Force limit"),
          QT_TRANSLATE_NOOP(
              "ForceRows",
              "Greatest force asked of the device [N]; the device's own limit holds as well"),
          true},
    Words{"force_rate_limit", 5000, 100, QT_TRANSLATE_NOOP("ForceRows", "Force rate"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Greatest change of the force [N/s]; a stop may drop it at once")},
    Words{"force_ramp", 2, 0.05, QT_TRANSLATE_NOOP("ForceRows", "Force ramp"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "How long the force rises at the start and after a pause [s]")},
    Words{"force_to_start_below", 3.3, 0.1, QT_TRANSLATE_NOOP("ForceRows", "Starts below"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "After a start or a pause there is no force until the computed one is "
                            "this small [N]; inf: it begins at any")},
    Words{"stale_time", 0.1, 0.005, QT_TRANSLATE_NOOP("ForceRows", "Stale after"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Longest time from one reading of the device to the next [s]; a longer "
                            "one is a pause without force")},
    Words{"rotational_stiffness", 1000, 10, QT_TRANSLATE_NOOP("ForceRows", "Turning stiffness"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Stiffness against turning a tool [N mm/rad]; 0: from the stiffness "
                            "and the tool's size")},
    Words{"rotational_damping", 1, 0.01, QT_TRANSLATE_NOOP("ForceRows", "Turning damping"),
          QT_TRANSLATE_NOOP(
              "ForceRows",
              "Against the turning of a tool [N mm s/rad]; never turns the hand further")},
    Words{"torque_limit", 500, 10, QT_TRANSLATE_NOOP("ForceRows", "Torque limit"),
          QT_TRANSLATE_NOOP(
              "ForceRows",
              "Greatest torque asked of the device [N mm]; the device's own limit holds as well")},
    Words{"torque_rate_limit", 5e5, 1e4, QT_TRANSLATE_NOOP("ForceRows", "Torque rate"),
          QT_TRANSLATE_NOOP("ForceRows",
                            "Greatest change of the torque [N mm/s]; a stop may drop it at once")}};

}  // namespace

QString row_name(const char* title) {
    return QString(title).replace(' ', '_');
}

ForceRow row_of(const SettingWords& setting, const ValueRange& range, double usual) {
    ForceRow row;
    row.name = row_name(setting.title);
    row.unit = QString(setting.unit).remove("device ").remove(", physical");
    row.infinite = range.has(ranges::infinity);
    const auto* said = std::find_if(words.begin(), words.end(),
                                    [&](const Words& one) { return row.name == one.name; });
    row.place = int(said - words.begin());
    if (said != words.end()) {
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

}  // namespace palpate::viewer

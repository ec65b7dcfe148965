// The section of the force: sliders for the numbers in the tables of force and friction, with words
// that only a window needs.
#include <QCoreApplication>

#include <algorithm>
#include <map>
#include <string>
#include <variant>

#include "apps/viewer/panel/form.hpp"
#include "palpate/settings.hpp"

namespace palpate::viewer {
namespace {

/// Words that the table of settings does not contain.
struct RowWords {
    const char* name;   // of the row: "force_limit" for the title "force limit"
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
         QT_TR_NOOP("Height of the bumps in the volume; 0: smooth")},
        {"texture_wavelength", 20, 0.5, QT_TR_NOOP("Texture length"),
         QT_TR_NOOP("From bump to bump in the volume")},
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

/// The facts of the table about a number.
struct TableNumber {
    std::string path;  // "force.limit"
    const char* unit;
    ValueRange range;
};

/// By the names of the rows.
std::map<QString, TableNumber> described_numbers() {
    std::map<QString, TableNumber> numbers;
    const RendererSettings usual;
    for_each_live_number(usual, [&](const std::string& path, const auto& one, double, const auto&) {
        numbers[QString(one.title).replace(' ', '_')] = {path, one.unit, one.range};
    });
    return numbers;
}

class ForceControls : public EffectForm {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::ForceControls)

  public:
    explicit ForceControls(Effect& effect) : EffectForm(effect) {
        auto *plain = new QWidget, *advanced = new QWidget;
        auto *plain_form = form_in(plain), *advanced_form = form_in(advanced);
        const auto numbers = described_numbers();
        each_time(this, [this](QWidget&) { set_ends(); });
        for (const RowWords& words : ForceRows::all) {
            const auto& [path, unit, range] = numbers.at(words.name);
            QFormLayout& form = words.plain ? *plain_form : *advanced_form;
            const Words shown{words.name, ForceRows::tr(words.label), ForceRows::tr(words.tip)};
            const Span span{QString(unit).remove("device ").remove(", physical"),
                            range.has(0) ? 0 : words.step, words.high, words.step};
            const Value<double> value{[this, path = path] { return number_at(path); },
                                      [this, path = path](double to) { change(path, to); }};
            auto* row = QString(unit).endsWith(", physical")
                            ? length_in(form, shown, span, value)
                            : quantity_in(form, shown, span, value);
            row->box().set_infinite(range.has(ranges::infinity));
        }
        auto* fold = new Section(tr("Advanced"), "force_advanced", advanced);
        fold->set_open(false);
        column_in(this, {plain, fold});
    }

  private:
    double number_at(const std::string& path) const {
        double found = 0;
        visit_live_number(effect_.settings(), path,
                          [&](double number, const auto&) { found = number; });
        return found;
    }

    void change(const std::string& path, double value) {
        RendererSettings next = effect_.settings();
        Command command = palpate::change(next, path, value);
        if (auto* friction = std::get_if<Friction>(&command);
            friction && path.ends_with("static_coefficient")) {
            friction->dynamic_coefficient = std::min(friction->dynamic_coefficient, value);
        }
        effect_.request(command);
    }

    /// The limits of check(ForceSettings, DeviceLimits).
    void set_ends() {
        constexpr double just_below = 1 - 1e-9;  // damping must not be on its end
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
};

}  // namespace

Form* force_section(Effect& effect) {
    return new ForceControls(effect);
}

}  // namespace palpate::viewer

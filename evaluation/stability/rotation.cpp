// A light hand turns the handle of a simulated device against the force stage's rotational spring,
// which holds it straight. The theory: at rest while k (T / 2 + delay) < damping.
#include "evaluation/stability/rotation.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numbers>

#include "devices/simulated/profiles.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/renderer.hpp"

namespace palpate::evaluation {
namespace {

constexpr double held_for = 4;        // [s] the last second counts
constexpr double least_angle = 0.02;  // [degrees] the least that a step of angle counts for
constexpr double surely_rests = 0.9, delayed_rests = 0.8;  // of the theory's bound
constexpr double surely_shakes = 1.25;
constexpr double degrees = 180 / std::numbers::pi;

/// How much of the device's imperfection counts.
enum Kind { ideal, delayed, whole };
constexpr std::array<const char*, 3> rotation_parts{"rotation, ideal", "rotation, delayed",
                                                    "rotation"};
constexpr std::array<const char*, 3> rotation_titles{"no delay, friction, steps", "delay alone",
                                                     "as they are"};

struct TurnCase {
    std::string profile;
    Kind kind = ideal;
    double rate = 1000;  // [Hz]
    double part = 1;     // of the theory's bound
};

struct TurnHeld {
    double bound = 0;     // [N mm/rad] of the theory
    double checked = 0;   // [N mm/rad] the largest that check() accepts
    double movement = 0;  // [degrees] peak to peak in the last second
    double torque = 0;    // [N mm] at the end
    bool at_rest = false;
};

TurnHeld hold_straight(const TurnCase& c, const Subject& subject) {
    const devices::DeviceProfile& profile = devices::profile(c.profile);
    std::string text =
        fmt::format("simulated:{},grip=light,hand=hold,depth=0,seconds={},turn=20,turn_time=0.5",
                    c.profile, held_for);
    if (c.kind != whole) text += ",friction=no,angle_step=0,torque_step=0";
    if (c.kind == ideal) text += ",delay=0";
    const auto device = devices::open_device(
        devices::parse_device(text),
        {subject.field, subject.isovalue, c.rate,
         [&](const DeviceInfo& info) { return fit_workspace(subject.field.geometry(), info); }});
    DeviceLimits limits = device->info().limits;
    const double damping = limits.physical_rotational_damping;
    TurnHeld held;
    held.checked = 2 * c.rate * damping;
    held.bound = damping / (0.5 / c.rate + (c.kind == ideal ? 0 : profile.delay));
    ForceSettings settings;
    settings.rotational_stiffness = c.part * held.bound;
    limits.physical_rotational_damping = 1e6;  // check() would refuse what is to be shown
    ForceState state;
    Eigen::AlignedBox3d turns;
    for (int i = 0; i < static_cast<int>(held_for * c.rate); ++i) {
        const double time = i / c.rate;
        const DeviceReading reading = device->read(time);
        ForceInput input;
        input.time = time;
        input.constrained = true;
        input.rotational_stiffness = settings.rotational_stiffness;
        input.orientation = Quaternion(reading.orientation);
        input.turn = rotation_between(input.orientation, Quaternion::Identity());
        const ForceResult result = render_force(state, settings, limits, input);
        device->write({result.force, result.torque}, time);
        held.torque = result.torque.norm();
        if (time >= held_for - 1) turns.extend(degrees * input.turn);
    }
    held.movement = turns.sizes().maxCoeff();
    const double step = c.kind == whole ? degrees * profile.angle_step : 0;
    held.at_rest = held.movement <= 2.01 * std::max(least_angle, step);
    return held;
}

void add_turn_case(const TurnCase& c, const Subject& subject, Table& table) {
    const TurnHeld held = hold_straight(c, subject);
    table.add({{"part", rotation_parts[c.kind]},
               {"profile", c.profile},
               {"friction", c.kind == whole ? "yes" : "no"},
               {"rate_hz", c.rate},
               {"at_rest", held.at_rest ? "yes" : "no"},
               {"part_of_bound", c.part},
               {"rotational_stiffness_N_mm_rad", c.part * held.bound},
               {"checked_N_mm_rad", held.checked},
               {"turn_peak_to_peak_deg", held.movement},
               {"torque_N_mm", held.torque}});
}

std::vector<std::string> profiles_with_torque() {
    std::vector<std::string> names;
    for (const std::string& name : devices::profile_names()) {
        if (devices::profile(name).maximum_torque > 0) names.push_back(name);
    }
    return names;
}

/// Whether all cases of a part at most (at least) so near the bound are (are not) at rest.
Claim bound_claim(const Table& table, const char* part, double from, double to, bool rests,
                  std::string statement) {
    Claim claim{std::move(statement), true, ""};
    const Table rows = table.where("part", part);
    int cases = 0;
    double extreme = rests ? 0 : 1e9;
    for (std::size_t i = 0; i < rows.rows().size(); ++i) {
        const double near = rows.number(i, "part_of_bound");
        if (near < from || near > to) continue;
        ++cases;
        const double movement = rows.number(i, "turn_peak_to_peak_deg");
        extreme = rests ? std::max(extreme, movement) : std::min(extreme, movement);
        claim.held = claim.held && (rows.text(i, "at_rest") == "yes") == rests;
    }
    claim.held = claim.held && cases > 0;
    claim.measured = fmt::format("{} {:.3g} degrees peak to peak in {} cases",
                                 rests ? "at most" : "at least", extreme, cases);
    return claim;
}

/// The largest stiffness [N mm/rad] up to which every one tried comes to rest; 0 if none does.
double largest_at_rest(const Table& rows) {
    double largest = 0;
    for (std::size_t i = 0; i < rows.rows().size(); ++i) {
        if (rows.text(i, "at_rest") == "no") break;
        largest = rows.number(i, "rotational_stiffness_N_mm_rad");
    }
    return largest;
}

Figure rotation_figure(const Table& table, const std::vector<double>& rates) {
    Figure figure;
    figure.suffix = "rotation";
    figure.caption =
        "The largest rotational stiffness at which a simulated device with torque in a light hand "
        "comes to rest, of those tried up to 2.5 times the bound of the theory. Left: without "
        "delay, friction and steps; there the bound is that of check(). Middle: with their delay "
        "alone. "
        "Right: as they are; friction stills every case that was tried.";
    figure.height = 460;
    figure.columns = rotation_parts.size();
    for (const Kind kind : {ideal, delayed, whole}) {
        const char* part = rotation_parts[kind];
        Panel panel;
        panel.title = rotation_titles[kind];
        panel.x = {.title = "update rate [kHz]",
                   .is_logarithmic = true,
                   .low = 0.2,
                   .high = 5,
                   .ticks = ticks_at({0.25, 0.5, 1, 2, 4})};
        panel.y = {
            .title = "stiffness [N mm/rad]", .is_logarithmic = true, .low = 100, .high = 1e5};
        const Table of_part = table.where("part", part);
        Rows checked;
        for (const std::string& profile : profiles_with_torque()) {
            const Table rows = of_part.where("profile", profile);
            Series& line = panel.add(Draw::line_points, profile, look_of(panel.series.size()), {});
            for (const double rate : rates) {
                const double k = largest_at_rest(rows.where("rate_hz", rate));
                if (k > 0) line.rows.push_back({rate / 1000, k});
            }
        }
        for (const double rate : rates) {
            checked.push_back(
                {rate / 1000, of_part.where("rate_hz", rate).number(0, "checked_N_mm_rad")});
        }
        panel.add(Draw::line, "check()", {.colour = colours::grey, .width = 3}, std::move(checked));
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace

void add_rotation(const Options& options, const Subject& subject, Result& result) {
    const std::vector<double> rates = options.quick
                                          ? std::vector<double>{250, 1000}
                                          : std::vector<double>{250, 500, 1000, 2000, 4000};
    std::vector<double> parts{0.5, delayed_rests, surely_rests, surely_shakes, 2};
    if (!options.quick) {
        parts.clear();
        for (int i = 2; i <= 50; ++i) parts.push_back(0.05 * i);
    }
    for (const Kind kind : {ideal, delayed, whole}) {
        for (const std::string& profile : profiles_with_torque()) {
            for (const double rate : rates) {
                for (const double part : parts) {
                    add_turn_case({profile, kind, rate, part}, subject, result.table);
                }
            }
        }
    }
    constexpr double rounding = 1e-9;
    result.claims.push_back(bound_claim(
        result.table, rotation_parts[ideal], 0, surely_rests + rounding, true,
        "without delay, friction and steps a handle comes to rest at 0.9 of the rotational "
        "stiffness that check() accepts, and below"));
    result.claims.push_back(bound_claim(result.table, rotation_parts[ideal],
                                        surely_shakes - rounding, 1e9, false,
                                        "and shakes at 1.25 of it, and above"));
    result.claims.push_back(
        bound_claim(result.table, rotation_parts[delayed], 0, delayed_rests + rounding, true,
                    "with its delay alone it comes to rest up to 0.8 of damping / "
                    "(period / 2 + delay)"));
    result.claims.push_back(bound_claim(result.table, rotation_parts[delayed],
                                        surely_shakes - rounding, 1e9, false,
                                        "and shakes at 1.25 of that, and above"));
    result.claims.push_back(
        bound_claim(result.table, rotation_parts[whole], 0, delayed_rests + rounding, true,
                    "as it is, with friction, it comes to rest up to 0.8 of that"));
    result.figures.push_back(rotation_figure(result.table, rates));
    result.paragraph += fmt::format(
        " Rotation: the light hand turns the handle by 20 degrees against a rotational spring that "
        "holds it straight, for {:g} s; at rest is as above, a step of angle counting for {:g} "
        "degrees at least. check() accepts 2 x rate x damping, which is where a handle without "
        "delay begins to shake, because its inertia is large against damping times period. A delay "
        "lowers that to damping / (period / 2 + delay), of which check() knows nothing: to be "
        "stable without friction a device with a delay of half a period takes half of what check() "
        "accepts. Friction of the wrist, which is assumed, stills what would shake.",
        held_for, least_angle);
}

}  // namespace palpate::evaluation

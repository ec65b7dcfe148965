// stability: the simulated device and hand in a closed loop with the renderer, pressed into a
// surface and held there. A loop that does not come to rest is in a limit cycle, felt as buzzing.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "devices/simulated/profiles.hpp"
#include "evaluation/experiment.hpp"
#include "evaluation/stability/rotation.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/renderer.hpp"

namespace palpate::evaluation {
namespace {

constexpr double seconds = 4;            ///< held for; the last second counts
constexpr double largest_stiffness = 3;  ///< [N/mm] that is tried
constexpr double least_step = 0.01;      ///< [mm] the least that an encoder step counts for

/// Whether a position that moves so much [mm] keeps to a number of encoder steps.
bool moves_within(double steps, double position, double encoder) {
    return position <= (steps + 0.01) * std::max(least_step, encoder);
}

struct Case {
    std::string profile;
    bool friction = false;  ///< of the device's mechanics
    double encoder = 0;     ///< [mm] step
    double rate = 1000;     ///< [Hz]
    double stiffness = 0;   ///< [N/mm]
    Interpolation interpolation = Interpolation::linear;
};

struct Held {
    double position = 0;  ///< [mm] peak to peak, as the encoders say
    double along = 0;     ///< [mm] the same along the force at the end
    double force = 0;     ///< [N] peak to peak, as rendered
    double push = 0;      ///< [N] at the end
    bool in_contact = false;
    bool at_rest = false;
};

std::string device_text(const Case& c) {
    return fmt::format(
        "simulated:{},grip=light,friction={},encoder={},hand=hold,depth=6,seconds={}", c.profile,
        c.friction ? "yes" : "no", c.encoder, seconds);
}

Held press(const Case& c, Subject subject) {
    subject.field.set_interpolation(c.interpolation);
    const auto device = devices::open_device(
        devices::parse_device(device_text(c)),
        {subject.field, subject.isovalue, c.rate,
         [&](const DeviceInfo& info) { return fit_workspace(subject.field.geometry(), info); }});
    const DeviceInfo info = device->info();
    RendererSettings settings;
    settings.transform = fit_workspace(subject.field.geometry(), info);
    settings.device = info.limits;
    settings.device.physical_damping = 1;  // check() would refuse what is to be shown
    settings.force.stiffness = c.stiffness;
    settings.force.limit = info.limits.maximum_force;
    Renderer renderer = make_renderer(subject.field, subject.isovalue, settings);
    Held held;
    Vec3 last_force = Vec3::Zero();
    Eigen::AlignedBox3d position, force;
    std::vector<Vec3> positions;
    const int ticks = static_cast<int>(seconds * c.rate);
    for (int i = 0; i < ticks; ++i) {
        const double time = i / c.rate;
        const DeviceReading reading = device->read(time);
        const bool ready = reading.status == DeviceStatus::ready;
        const Tick tick =
            render(renderer, {.time = time, .position = reading.position, .valid = ready});
        device->write({tick.force, tick.torque}, time);
        if (time < seconds - 1) continue;
        position.extend(reading.position);
        positions.push_back(reading.position);
        force.extend(tick.force);
        last_force = tick.force;
        held.in_contact = held.in_contact || tick.proxy.mode == Mode::constrained;
    }
    held.push = last_force.norm();
    Eigen::AlignedBox1d along;
    for (const Vec3& p : positions) {
        along.extend(Eigen::AlignedBox1d::VectorType(p.dot(last_force.normalized())));
    }
    held.along = along.sizes()[0];
    held.position = position.sizes().maxCoeff();
    held.force = force.sizes().maxCoeff();
    held.at_rest = moves_within(2, held.position, c.encoder);
    return held;
}

struct Plan {
    std::vector<double> rates, encoders, stiffnesses;
    std::vector<std::string> profiles;
};

Plan plan_of(bool quick) {
    if (quick) return {{250, 1000}, {0, 0.1}, {0.5, largest_stiffness}, devices::profile_names()};
    Plan plan{{250, 500, 1000, 2000, 4000}, {0, 0.01, 0.03, 0.1}, {}, devices::profile_names()};
    for (int i = 1; i < 30; ++i) plan.stiffnesses.push_back(0.1 * i);
    plan.stiffnesses.push_back(largest_stiffness);
    return plan;
}

constexpr const char* map_profile = "touch";

/// Runs a case and adds its row.
Held add_case(const Case& c, const Subject& subject, const char* part, Table& table) {
    const Held held = press(c, subject);
    table.add({{"part", part},
               {"profile", c.profile},
               {"friction", c.friction ? "yes" : "no"},
               {"field", std::string(name_of(c.interpolation))},
               {"encoder_step_mm", c.encoder},
               {"rate_hz", c.rate},
               {"stiffness_N_mm", c.stiffness},
               {"position_peak_to_peak_mm", held.position},
               {"along_force_peak_to_peak_mm", held.along},
               {"force_peak_to_peak_N", held.force},
               {"push_N", held.push},
               {"in_contact", held.in_contact ? "yes" : "no"},
               {"at_rest", held.at_rest ? "yes" : "no"}});
    return held;
}

/// The largest stiffness up to which every one tried moves by so many encoder steps at most, which
/// is at rest for two; 0 if none does.
double largest_stable(const Table& table, double rate, double steps = 2) {
    double largest = 0;
    const Table at_rate = table.where("rate_hz", rate);  // rows rise in stiffness
    for (std::size_t i = 0; i < at_rate.rows().size(); ++i) {
        if (!moves_within(steps, at_rate.number(i, "position_peak_to_peak_mm"),
                          at_rate.number(i, "encoder_step_mm"))) {
            break;
        }
        largest = at_rate.number(i, "stiffness_N_mm");
    }
    return largest;
}

/// Stiffness over rate, the colour the movement at rest; a line where it ends.
Panel map_panel(const Table& table, const Plan& plan, double encoder) {
    const Table map = table.where("part", "map").where("encoder_step_mm", encoder);
    Rows cells, limit;
    std::vector<std::string> kilohertz;
    for (std::size_t r = 0; r < plan.rates.size(); ++r) {
        const double stable = largest_stable(map, plan.rates[r]);
        limit.push_back({double(r) - 0.5, stable + 0.05});
        limit.push_back({double(r) + 0.5, stable + 0.05});
        for (const auto& row : map.where("rate_hz", plan.rates[r])
                                   .rows_of({"stiffness_N_mm", "position_peak_to_peak_mm"})) {
            cells.push_back({double(r), row[0], std::max(1e-3, row[1])});
        }
        kilohertz.push_back(fmt::format("{:g}", plan.rates[r] / 1000));
    }
    Panel panel;
    panel.add(Draw::cells, "", {}, std::move(cells));
    panel.add(Draw::line, "", {.colour = colours::vermilion, .width = 3}, std::move(limit));
    panel.title = fmt::format("encoder step {:g} mm", encoder);
    panel.x = axis_named(kilohertz);
    panel.x.title = "update rate [kHz]";
    panel.y = {.low = 0, .high = 3.05};
    panel.has_grid = false;
    panel.scale = ColourScale{"peak to peak [mm]", 0.001, 10, true};
    return panel;
}

Figure map_figure(const Table& table, const Plan& plan) {
    Figure figure;
    figure.caption = fmt::format(
        "How far the device goes on moving when a light hand presses and holds (simulated {}, no "
        "friction in its mechanics): white is rest, dark a limit cycle. Below the vermilion line "
        "it moves by two encoder steps at most.",
        map_profile);
    figure.height = 460;
    figure.columns = plan.encoders.size();
    for (const double encoder : plan.encoders) {
        figure.panels.push_back(map_panel(table, plan, encoder));
        figure.panels.back().y.has_labels = figure.panels.size() == 1;
    }
    figure.panels.front().y.title = "stiffness [N/mm]";
    return figure;
}

struct Part {
    const char *name, *title;
    bool friction;
    Interpolation interpolation;
};
constexpr std::array<Part, 4> profile_parts{
    {{"profiles", "as they are", true, Interpolation::linear},
     {"profiles, smooth field", "as they are, smooth field", true, Interpolation::cubic},
     {"profiles without friction", "without friction", false, Interpolation::linear},
     {"profiles without friction, smooth field", "without friction, smooth field", false,
      Interpolation::cubic}}};

/// The largest stable stiffness of every profile over the rate, on both fields, as it is and
/// without friction.
Figure profile_figure(const Table& table, const Plan& plan) {
    Figure figure;
    figure.suffix = "profiles";
    figure.caption =
        "The largest stiffness up to 3 N/mm at which a simulated device in a light hand comes to "
        "rest, with its own encoders, delay and (above) friction. Below: without the friction, "
        "which stills small limit cycles. Right: on the smooth field.";
    figure.height = 900;
    figure.columns = 2;
    for (const Part& part : profile_parts) {
        Panel panel;
        panel.title = part.title;
        panel.x = {.title = "update rate [kHz]",
                   .is_logarithmic = true,
                   .low = 0.2,
                   .high = 5,
                   .ticks = ticks_at({0.25, 0.5, 1, 2, 4})};
        panel.y = {.title = "largest stable stiffness [N/mm]", .low = 0, .high = 3.1};
        for (const std::string& profile : plan.profiles) {
            const Table rows = table.where("part", part.name).where("profile", profile);
            const Look look = look_of(panel.series.size());
            Series& line = panel.add(Draw::line_points, profile, look, {});
            for (const double rate : plan.rates) {
                line.rows.push_back({rate / 1000, largest_stable(rows, rate)});
            }
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

/// Each profile at its rated stiffness, in the light grip, at 1 kHz.
Claim rated_claim(const Subject& subject, Table& table) {
    Claim claim{"every profile comes to rest at its rated stiffness at 1 kHz, to two encoder steps",
                true, ""};
    for (const std::string& name : devices::profile_names()) {
        const devices::DeviceProfile& device = devices::profile(name);
        const Held held = add_case({name, true, device.encoder_step, 1000, device.stiffness},
                                   subject, "rated", table);
        claim.held = claim.held && held.at_rest && held.in_contact;
        claim.measured += fmt::format("{}{} {:g} N/mm: {:g} mm", claim.measured.empty() ? "" : ", ",
                                      name, device.stiffness, held.position);
    }
    return claim;
}

/// The largest stiffnesses on the smooth field, of every profile at every rate, beside those on the
/// linear one.
struct Comparison {
    int lower = 0, same = 0, higher = 0;
    double most_lower = 0;  ///< [N/mm]
    std::string losses;
};

Comparison compare(const Table& table, const Plan& plan, const Part& on_linear,
                   const Part& on_smooth, double steps) {
    Comparison result;
    for (const std::string& profile : plan.profiles) {
        const auto largest = [&](const Part& part, double rate) {
            return largest_stable(table.where("part", part.name).where("profile", profile), rate,
                                  steps);
        };
        for (const double rate : plan.rates) {
            const double linear = largest(on_linear, rate), smooth = largest(on_smooth, rate);
            result.same += smooth == linear;
            result.higher += smooth > linear;
            if (smooth >= linear) continue;
            ++result.lower;
            result.most_lower = std::max(result.most_lower, linear - smooth);
            result.losses += fmt::format("{} at {:g} Hz: {:.1f} against {:.1f} N/mm; ", profile,
                                         rate, smooth, linear);
        }
    }
    return result;
}

Claim smooth_claim(const Table& table, const Plan& plan) {
    const Comparison found = compare(table, plan, profile_parts[0], profile_parts[1], 2);
    return {
        "on the smooth field every profile comes to rest at least as stiff as on the linear "
        "one, at every rate",
        found.lower == 0,
        fmt::format("{}as stiff in {} cases, stiffer in {}", found.losses, found.same,
                    found.higher)};
}

std::string frictionless_paragraph(const Table& table, const Plan& plan) {
    constexpr double wide = 10;  // encoder steps
    const auto compared = [&](double steps) {
        return compare(table, plan, profile_parts[2], profile_parts[3], steps);
    };
    const Comparison rest = compared(2), moves = compared(wide);
    return fmt::format(
        " Without friction nothing holds a hand sideways, and the smooth field has no facets to "
        "rest in: of {} cases (a profile at a rate) it comes to rest up to a larger stiffness "
        "than on the linear field in {}, up to a smaller one in {}. Movement by more than {:g} "
        "steps begins at the same stiffness in {} of them, later in {}, and in {} earlier, by "
        "{:.1f} "
        "N/mm at most.",
        rest.lower + rest.same + rest.higher, rest.higher, rest.lower, wide, moves.same,
        moves.higher, moves.lower, moves.most_lower);
}

/// That the map can tell: the worst corner does not rest.
Claim control_claim(const Table& table) {
    Claim claim{
        fmt::format("a loop that must buzz does: {}, 3 N/mm at 250 Hz, no friction", map_profile),
        false, "not run"};
    const Table corner = table.where("part", "map")
                             .where("rate_hz", 250.0)
                             .where("stiffness_N_mm", largest_stiffness)
                             .where("encoder_step_mm", 0.0);
    if (corner.rows().empty()) return claim;
    claim.held = corner.text(0, "at_rest") == "no";
    claim.measured =
        fmt::format("{:.3g} mm peak to peak", corner.number(0, "position_peak_to_peak_mm"));
    return claim;
}

std::string paragraph_of(const Table& table, const Plan& plan, const Subject& subject) {
    std::string text = fmt::format(
        "A simulated device in a light hand is pressed into {} and held; the last of {:g} s "
        "counts. It is at rest if its position, as the encoders tell it, moves by two encoder "
        "steps "
        "at most (a step counts for {:g} mm at least). Of {}, without friction in its mechanics, "
        "the "
        "largest stiffness that comes to rest, of those tried up to 3 N/mm, is",
        subject.name, seconds, least_step, map_profile);
    for (const double encoder : plan.encoders) {
        text += fmt::format("{} with encoder steps of {:g} mm", encoder > 0 ? ";" : "", encoder);
        const Table map = table.where("part", "map").where("encoder_step_mm", encoder);
        for (const double rate : plan.rates) {
            text += fmt::format(" {:.1f} N/mm at {:g} Hz,", largest_stable(map, rate), rate);
        }
        text.pop_back();
    }
    return text +
           ". All of it is simulated: the profiles' masses, frictions and delays are partly "
           "assumed "
           "(docs/devices/simulated.md), so the shape of the map is worth more than its numbers.";
}

}  // namespace

Result stability(const Options& options) {
    const Plan plan = plan_of(options.quick);
    const Subject subject =
        options.subjects.empty() ? synthetic("sphere") : options.subjects.front();
    Result result;
    std::vector<std::pair<const char*, Case>> cases;
    const auto add = [&](const Part& part, const std::string& profile, double encoder) {
        for (const double rate : plan.rates) {
            for (const double k : plan.stiffnesses) {
                cases.push_back(
                    {part.name, {profile, part.friction, encoder, rate, k, part.interpolation}});
            }
        }
    };
    for (const double encoder : plan.encoders) {
        add({"map", "", false, Interpolation::linear}, map_profile, encoder);
    }
    for (const Part& part : profile_parts) {
        for (const std::string& name : plan.profiles) {
            add(part, name, devices::profile(name).encoder_step);
        }
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
        options.progress(double(i) / double(cases.size()));
        add_case(cases[i].second, subject, cases[i].first, result.table);
    }
    result.claims = {rated_claim(subject, result.table), smooth_claim(result.table, plan),
                     control_claim(result.table)};
    result.figures = {map_figure(result.table, plan), profile_figure(result.table, plan)};
    result.paragraph =
        paragraph_of(result.table, plan, subject) + frictionless_paragraph(result.table, plan);
    add_rotation(options, subject, result);
    return result;
}

}  // namespace palpate::evaluation

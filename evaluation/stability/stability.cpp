// stability: the simulated device and hand in a closed loop with the renderer, pressed into a
// surface and held there. What does not come to rest is a limit cycle, and is felt as buzzing.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "devices/simulated/profiles.hpp"
#include "evaluation/experiment.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/renderer.hpp"

namespace palpate::evaluation {
namespace {

constexpr double seconds = 4;        ///< held for; the last second counts
constexpr double least_step = 0.01;  ///< [mm] the least that an encoder step counts for

struct Case {
    std::string profile;
    bool friction = false;  ///< of the device's mechanics
    double encoder = 0;     ///< [mm] step
    double rate = 1000;     ///< [Hz]
    double stiffness = 0;   ///< [N/mm]
};

/// From the least to the greatest of each coordinate.
struct Extent {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    void add(const Vec3& v) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    double largest() const { return (high - low).maxCoeff(); }
};

struct Held {
    double position = 0;  ///< [mm] peak to peak, as the encoders say
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

Held press(const Case& c, const Subject& subject) {
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
    Extent position, force;
    const int ticks = static_cast<int>(seconds * c.rate);
    for (int i = 0; i < ticks; ++i) {
        const double time = i / c.rate;
        const DeviceReading reading = device->read(time);
        const bool ready = reading.status == DeviceStatus::ready;
        const Tick tick =
            render(renderer, {.time = time, .position = reading.position, .valid = ready});
        device->write(tick.force, time);
        if (time < seconds - 1) continue;
        position.add(reading.position);
        force.add(tick.force);
        held.push = tick.force.norm();
        held.in_contact = held.in_contact || tick.proxy.mode == Mode::constrained;
    }
    held.position = position.largest();
    held.force = force.largest();
    held.at_rest = held.position <= 2.01 * std::max(least_step, c.encoder);
    return held;
}

struct Plan {
    std::vector<double> rates, encoders, stiffnesses;
    std::vector<std::string> profiles;
};

std::vector<double> stiffnesses(double step) {
    std::vector<double> all;
    for (int i = 1; i * step <= 3 + 1e-9; ++i) all.push_back(i * step);
    return all;
}

Plan plan_of(bool quick) {
    Plan plan;
    plan.profiles = devices::profile_names();
    if (quick) {
        plan.rates = {250, 1000};
        plan.encoders = {0, 0.1};
        plan.stiffnesses = {0.5, 3};
        return plan;
    }
    plan.rates = {250, 500, 1000, 2000, 4000};
    plan.encoders = {0, 0.01, 0.03, 0.1};
    plan.stiffnesses = stiffnesses(0.1);
    return plan;
}

constexpr const char* map_profile = "touch";

/// Runs a case and adds its row.
Held add_case(const Case& c, const Subject& subject, const char* part, Table& table) {
    const Held held = press(c, subject);
    table.add({part, c.profile, c.friction ? "yes" : "no", c.encoder, c.rate, c.stiffness,
               held.position, held.force, held.push, held.in_contact ? "yes" : "no",
               held.at_rest ? "yes" : "no"});
    return held;
}

/// The largest stiffness up to which every one tried comes to rest; 0 if none does.
double largest_stable(const Table& table, const std::string& part, const std::string& profile,
                      double encoder, double rate) {
    double largest = 0;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") != part || table.text(i, "profile") != profile ||
            table.number(i, "rate_hz") != rate) {
            continue;
        }
        if (part == "map" && table.number(i, "encoder_step_mm") != encoder) continue;
        if (table.text(i, "at_rest") == "no") break;  // rows rise in stiffness
        largest = table.number(i, "stiffness_N_mm");
    }
    return largest;
}

/// One panel: stiffness over rate, the colour the movement at rest; a line where it ends.
std::string map_panel(const Table& table, const Plan& plan, double encoder, std::size_t number) {
    std::vector<std::vector<double>> cells, limit;
    for (std::size_t r = 0; r < plan.rates.size(); ++r) {
        const double stable = largest_stable(table, "map", map_profile, encoder, plan.rates[r]);
        limit.push_back({double(r) - 0.5, stable + 0.05});
        limit.push_back({double(r) + 0.5, stable + 0.05});
        for (std::size_t i = 0; i < table.rows().size(); ++i) {
            if (table.text(i, "part") != "map" || table.number(i, "rate_hz") != plan.rates[r] ||
                table.number(i, "encoder_step_mm") != encoder) {
                continue;
            }
            cells.push_back({double(r), table.number(i, "stiffness_N_mm"),
                             std::max(1e-3, table.number(i, "position_peak_to_peak_mm"))});
        }
    }
    std::string tics;
    for (std::size_t r = 0; r < plan.rates.size(); ++r) {
        tics += fmt::format("{}'{:g}' {}", r ? ", " : "", plan.rates[r] / 1000, r);
    }
    return block(fmt::format("cells{}", number), cells) +
           block(fmt::format("limit{}", number), limit) +
           fmt::format(
               "set title 'encoder step {:g} mm'\nset xtics ({})\n"
               "plot $cells{} using 1:2:3 with image notitle, $limit{} with lines lw 3 lc rgb "
               "'#D55E00'\n",
               encoder, tics, number, number);
}

Figure map_figure(const Table& table, const Plan& plan) {
    Figure figure;
    figure.caption = fmt::format(
        "How far the device goes on moving when a light hand presses and holds (simulated {}, no "
        "friction in its mechanics): white is rest, dark a limit cycle. Below the vermilion line "
        "it moves by two encoder steps at most.",
        map_profile);
    figure.size = {1200, 460};
    figure.script = fmt::format(
        "set multiplot layout 1,{} margins 0.07,0.9,0.16,0.86 spacing 0.035,0.1\n"
        "set palette defined (0 '#ffffff', 0.35 '#9ecae1', 0.7 '#3182bd', 1 '#08306b')\n"
        "set logscale cb\nset cbrange [0.001:10]\nset format cb '%g'\nunset colorbox\n"
        "set cblabel 'peak to peak [mm]'\nset xlabel 'update rate [kHz]'\n"
        "set yrange [0:3.05]\nset xrange [-0.5:{}]\nunset key\n"
        "set ylabel 'stiffness [N/mm]'\nunset grid\n",
        plan.encoders.size(), double(plan.rates.size()) - 0.5);
    for (std::size_t i = 0; i < plan.encoders.size(); ++i) {
        if (i == 1) figure.script += "unset ylabel\nset format y ''\n";
        if (i + 1 == plan.encoders.size()) {
            figure.script += "set colorbox user origin 0.92,0.16 size 0.015,0.7\n";
        }
        figure.script += map_panel(table, plan, plan.encoders[i], i);
    }
    figure.script += "unset multiplot\n";
    return figure;
}

/// The largest stable stiffness of every profile over the rate, as it is and without friction.
Figure profile_figure(const Table& table, const Plan& plan) {
    Figure figure;
    figure.suffix = "profiles";
    figure.caption =
        "The largest stiffness up to 3 N/mm at which a simulated device in a light hand comes to "
        "rest, with its own encoders, delay and (left) friction. Right: without the friction, "
        "which stills small limit cycles.";
    figure.size = {1200, 520};
    figure.script =
        "set multiplot layout 1,2\nset logscale x\nset xlabel 'update rate [kHz]'\n"
        "set xrange [0.2:5]\nset xtics (0.25, 0.5, 1, 2, 4)\nset bmargin 7\n"
        "set ylabel 'largest stable stiffness [N/mm]'\nset yrange [0:3.1]\n"
        "set key outside below horizontal\n";
    for (const char* part : {"profiles", "profiles without friction"}) {
        std::string plots = "plot ", blocks;
        for (std::size_t p = 0; p < plan.profiles.size(); ++p) {
            std::vector<std::vector<double>> rows;
            for (const double rate : plan.rates) {
                rows.push_back(
                    {rate / 1000, largest_stable(table, part, plan.profiles[p], 0, rate)});
            }
            const std::string name = fmt::format("p{}{}", part == std::string("profiles"), p);
            blocks += block(name, rows);
            plots += fmt::format("{}${} with linespoints lt {} title '{}'", p ? ", " : "", name,
                                 p + 1, plan.profiles[p]);
        }
        figure.script +=
            fmt::format("set title '{}'\n",
                        part == std::string("profiles") ? "as they are" : "without friction") +
            blocks + plots + "\n";
    }
    figure.script += "unset multiplot\n";
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

/// That the map can tell: the worst corner does not rest.
Claim control_claim(const Table& table) {
    Claim claim{
        fmt::format("a loop that must buzz does: {}, 3 N/mm at 250 Hz, no friction", map_profile),
        false, "not run"};
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") != "map" || table.number(i, "rate_hz") != 250 ||
            std::abs(table.number(i, "stiffness_N_mm") - 3) > 1e-9 ||
            table.number(i, "encoder_step_mm") != 0) {
            continue;
        }
        claim.held = table.text(i, "at_rest") == "no";
        claim.measured =
            fmt::format("{:.3g} mm peak to peak", table.number(i, "position_peak_to_peak_mm"));
    }
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
        for (const double rate : plan.rates) {
            text += fmt::format(" {:.1f} N/mm at {:g} Hz,",
                                largest_stable(table, "map", map_profile, encoder, rate), rate);
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
    result.table = Table({"part", "profile", "friction", "encoder_step_mm", "rate_hz",
                          "stiffness_N_mm", "position_peak_to_peak_mm", "force_peak_to_peak_N",
                          "push_N", "in_contact", "at_rest"});
    std::vector<std::pair<const char*, Case>> cases;
    for (const double encoder : plan.encoders) {
        for (const double rate : plan.rates) {
            for (const double k : plan.stiffnesses) {
                cases.push_back({"map", {map_profile, false, encoder, rate, k}});
            }
        }
    }
    for (const bool friction : {true, false}) {
        for (const std::string& name : plan.profiles) {
            const double encoder = devices::profile(name).encoder_step;
            for (const double rate : plan.rates) {
                for (const double k : plan.stiffnesses) {
                    cases.push_back({friction ? "profiles" : "profiles without friction",
                                     {name, friction, encoder, rate, k}});
                }
            }
        }
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
        options.progress(double(i) / double(cases.size()));
        add_case(cases[i].second, subject, cases[i].first, result.table);
    }
    result.claims = {rated_claim(subject, result.table), control_claim(result.table)};
    result.figures = {map_figure(result.table, plan), profile_figure(result.table, plan)};
    result.paragraph = paragraph_of(result.table, plan, subject);
    return result;
}

}  // namespace palpate::evaluation

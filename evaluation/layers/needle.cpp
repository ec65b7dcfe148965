// A needle's force over depth, against drag times length and the tip's spring.
#include "evaluation/layers/needle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace palpate::evaluation {
namespace {

constexpr double rest_time = 0.5;  // [s]
constexpr double start = 5.3037;   // [mm of depth]
constexpr double turn = 61;        // [mm] a millimetre into the bone's spring

enum Phase : std::uint8_t { inserting, resting, withdrawing };
constexpr std::array<const char*, 3> phase_names{"insertion", "rest", "withdrawal"};

/// The closed form of a stroke: what resists the hand [N], positive outwards.
class NeedleForce {
  public:
    NeedleForce(const Layers& layers, double stiffness) : layers_(layers), stiffness_(stiffness) {}

    double operator()(double depth, Phase phase) {
        if (phase == inserting) return drag_at(layers_, depth) + spring_at(layers_, depth);
        // No surface is felt on the way out: the tip goes back through its channel.
        const Layer& bone = layers_.layers.back();
        const double tip = std::max(0.0, stiffness_of(bone) * (depth - bone.level));
        if (phase == resting) return drag_at(layers_, turn) + tip;
        return withdrawn(depth) + tip;
    }

  private:
    /// The tissue sticks to the shaft and pulls back until it slips, then rubs the other way.
    double withdrawn(double depth) {
        const double in_motion = drag_out(depth);
        const double sticks = drag_at(layers_, turn) - stiffness_ * (turn - depth);
        slips_ = slips_ || sticks < -layers_.needle->static_ratio * in_motion;
        return slips_ ? -in_motion : sticks;
    }
    /// Every surface but the bone is open now.
    double drag_out(double depth) const {
        double sum = 0;
        for (std::size_t i = 0; i + 1 < layers_.layers.size(); ++i) {
            const double begin = layers_.layers[i].level;
            const double end = std::min(depth, layers_.layers[i + 1].level);
            sum += std::max(0.0, end - begin) * *layers_.layers[i][HapticProperty::drag];
        }
        return sum;
    }

    const Layers& layers_;
    double stiffness_;  // of the tissue that sticks to the shaft [N/mm]
    bool slips_ = false;
};

struct Errors {
    std::int64_t ticks = 0;
    double squares = 0, worst = 0;

    double rms() const { return std::sqrt(squares / double(ticks)); }
};

/// In, rest and out again, at a constant speed.
template <class Visit>
void stroke(double speed, Visit&& visit) {
    const double step = speed / layers_rate;
    const int way = static_cast<int>((turn - start) / step);
    for (int i = 0; i < way; ++i) visit(start + i * step, inserting);
    for (int i = 0; i < rest_time * layers_rate; ++i) visit(turn, resting);
    for (int i = 1; i <= way; ++i) visit(turn - i * step, withdrawing);
}

}  // namespace

void add_needles(Table& table, const LayeredPhantom& phantom, Interpolation interpolation,
                 std::uint64_t seed) {
    Field field = phantom.field;
    field.set_interpolation(interpolation);
    const bool has_curve = phantom.name == "flat" && interpolation == Interpolation::linear;
    for (const double speed : {needle_speed, needle_fast_speed}) {
        scenes::Random random(seed);
        const HandLine line = phantom.line(random);
        const auto layers = std::make_shared<Layers>(needle_tissues());
        Renderer renderer = layered_renderer(field, layers);
        NeedleForce closed_form(*layers, renderer.settings.force.stiffness);
        std::array<Errors, 3> errors;
        int tick_number = 0, punctures = 0;
        std::optional<Phase> last;
        double written = -1;
        stroke(speed, [&](double depth, Phase phase) {
            const Tick tick = render(renderer, {.time = ++tick_number / layers_rate,
                                                .position = line.at(depth),
                                                .pointing = line.inward});
            const double wanted = closed_form(depth, phase);
            const double off = (tick.force + wanted * line.inward).norm();
            punctures += tick.layers.punctured;
            Errors& e = errors[phase];
            ++e.ticks;
            e.squares += off * off;
            e.worst = std::max(e.worst, off);
            const bool is_shown = has_curve && speed == needle_speed;
            if (!is_shown || (last == phase && std::abs(depth - written) < curve_resolution)) {
                return;
            }
            written = depth;
            last = phase;
            table.add({{"part", "needle curve"},
                       {"body", phantom.name},
                       {"field", std::string(name_of(interpolation))},
                       {"speed_mm_s", speed},
                       {"phase", phase_names[phase]},
                       {"depth_mm", depth},
                       {"force_n", -tick.force.dot(line.inward)},
                       {"closed_form_n", wanted}});
        });
        for (const Phase phase : {inserting, resting, withdrawing}) {
            table.add({{"part", "needle"},
                       {"body", phantom.name},
                       {"field", std::string(name_of(interpolation))},
                       {"speed_mm_s", speed},
                       {"phase", phase_names[phase]},
                       {"ticks", double(errors[phase].ticks)},
                       {"punctures", double(punctures)},
                       {"rms_n", errors[phase].rms()},
                       {"worst_n", errors[phase].worst}});
        }
    }
}

std::vector<Claim> needle_claims(const Table& table) {
    const Table in = table.where("part", "needle").where("phase", phase_names[inserting]);
    const double rms = largest(in.numbers("rms_n"));
    return {{fmt::format("a needle going in feels drag times length in each layer and the spring "
                         "at its tip, to {:g} N RMS",
                         most_force_error),
             !in.rows().empty() && rms <= most_force_error, fmt::format("largest {:.2g} N", rms)}};
}

std::string needle_sentences(const Table& table) {
    const Table needles = table.where("part", "needle");
    const auto rms = [&](Phase phase) {
        return largest(needles.where("phase", phase_names[phase]).numbers("rms_n"));
    };
    return fmt::format(
        " A needle that goes in at {:g} and {:g} mm/s, rests half a second on the bone and comes "
        "out again feels the drag of each layer times the shaft's length in it, and at its tip "
        "the surface that holds it: off the closed form by at most {:.2g} N RMS going in, {:.2g} "
        "N at rest and {:.2g} N coming out, where friction first sticks, then rubs the other way.",
        needle_speed, needle_fast_speed, rms(inserting), rms(resting), rms(withdrawing));
}

}  // namespace palpate::evaluation

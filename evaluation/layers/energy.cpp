// Closed random loops without friction: a spring gives back what it took, a surface that gives way
// does not.
#include "evaluation/layers/energy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "evaluation/layers/phantom.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/io/volume_file.hpp"

namespace palpate::evaluation {
namespace {

constexpr double most_gained = 1e-6;  // [J] claimed
constexpr double boundless = std::numeric_limits<double>::infinity();

/// A closed path round a place, as a sum of a few waves.
class Loop {
  public:
    Loop(scenes::Random& random, const Vec3& begin, double reach) : begin_(begin) {
        const auto amplitude = [&](int wave) -> Vec3 {
            const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            return reach / (1 + wave) * v;
        };
        for (int i = 0; i < waves; ++i) {
            sines_[i] = amplitude(i);
            cosines_[i] = amplitude(i);
        }
    }
    Vec3 operator()(double part) const {
        Vec3 at = begin_;
        for (int i = 0; i < waves; ++i) {
            const double phase = 2 * std::numbers::pi * (i + 1) * part;
            at += std::sin(phase) * sines_[i] + (std::cos(phase) - 1) * cosines_[i];
        }
        return at;
    }

  private:
    static constexpr int waves = 4;
    Vec3 begin_;
    std::array<Vec3, waves> sines_, cosines_;
};

struct Round {
    double gained = 0;  // [J]
    int punctures = 0, contacts = 0;
};

/// The work of the force on the hand round the loop, less what the spring held at its begin. What
/// the spring holds at its end counts as lost.
Round go_round(Renderer renderer, const Loop& loop, int ticks) {
    Vec3 from = loop(0);
    Tick last = render(renderer, {.time = 0, .position = from});
    const double stored = 0.5 * last.force.dot(last.proxy.scp - from);  // [N mm]
    double work = 0;                                                    // [N mm]
    Round round;
    for (int i = 1; i <= ticks; ++i) {
        const Vec3 to = loop(double(i) / ticks);
        const Tick tick = render(renderer, {.time = i / layers_rate, .position = to});
        work += 0.5 * (last.force + tick.force).dot(to - from);
        round.punctures += tick.layers.punctured;
        round.contacts += tick.layers.touched >= 0;
        last = tick;
        from = to;
    }
    round.gained = (work - stored) / 1000;
    return round;
}

struct LoopBody {
    std::string name;
    Field field;
    double isovalue = 0;
    double spread = 0;  ///< of the levels [data units]
    double reach = 3;   ///< of the loops [mm]
};

std::vector<LoopBody> loop_bodies() {
    Subject ripples = synthetic("marschner-lobb:40x40x40");
    const double range = ripples.field.range();
    const double between = io::sample_volume_bone - io::sample_volume_skin;
    return {{"ripples", std::move(ripples.field), ripples.isovalue, 0.3 * range, 3},
            {"head", Field(io::read_volume(io::sample_volume_path()).volume),
             io::sample_volume_skin + 0.5 * between, between, 12}};
}

Layers loop_layers(const LoopBody& body, double gives_way) {
    constexpr std::array<double, 4> stiffnesses{0.4, 1.5, 0.3, 0.8};
    Layers layers;
    for (std::size_t i = 0; i < stiffnesses.size(); ++i) {
        Layer layer;
        layer.name = fmt::format("layer {}", i + 1);
        layer.level = body.isovalue + body.spread * (double(i) / 3 - 0.5);
        layer[HapticProperty::stiffness] = stiffnesses[i];
        layer[HapticProperty::puncture_force] = gives_way;
        layers.layers.push_back(layer);
    }
    return layers;
}

void add_energy(Table& table, const LoopBody& body, double gives_way, const EnergyPlan& plan) {
    const auto layers = std::make_shared<Layers>(loop_layers(body, gives_way));
    const Renderer renderer = layered_renderer(body.field, layers);
    const Vec3 size = body.field.geometry().size.cast<double>();
    scenes::Random random(plan.seed);
    double gained = -boundless, least_lost = boundless, lost = 0;
    int punctures = 0, contacts = 0, punctured_loops = 0, loops = 0;
    // Loops far from every surface say nothing and do not count.
    for (int tries = 0; loops < plan.loops && tries < 50 * plan.loops; ++tries) {
        const Vec3 share(random.uniform(), random.uniform(), random.uniform());
        const Vec3 begin = physical_from_index(body.field.geometry(), size.cwiseProduct(share));
        const Loop loop(random, begin, body.reach);
        if (std::abs(value_at(body.field, begin) - body.isovalue) > body.spread) continue;
        const Round round = go_round(renderer, loop, plan.ticks);
        if (round.contacts == 0) continue;
        ++loops;
        contacts += round.contacts;
        punctures += round.punctures;
        lost -= round.gained;
        gained = std::max(gained, round.gained);
        if (round.punctures == 0) continue;
        ++punctured_loops;
        least_lost = std::min(least_lost, -round.gained);
    }
    table.add({{"part", "energy"},
               {"body", body.name},
               {"field", std::string(name_of(body.field.interpolation()))},
               {"surfaces", std::isfinite(gives_way) ? "give way" : "hold"},
               {"runs", double(loops)},
               {"ticks", double(loops) * plan.ticks},
               {"contacts", double(contacts)},
               {"punctures", double(punctures)},
               {"loops_with_punctures", double(punctured_loops)},
               {"most_gained_j", gained},
               {"lost_mean_j", lost / loops},
               {"least_lost_with_puncture_j", punctured_loops > 0 ? least_lost : std::nan("")}});
}

}  // namespace

void add_energies(Table& table, const EnergyPlan& plan,
                  const std::function<void(double)>& progress) {
    double done = 0;
    for (LoopBody& body : loop_bodies()) {
        for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
            body.field.set_interpolation(interpolation);
            for (const double gives_way : {boundless, 0.6}) {
                progress(done++ / 8);
                add_energy(table, body, gives_way, plan);
            }
        }
    }
}

std::vector<Claim> energy_claims(const Table& table) {
    const Table energies = table.where("part", "energy");
    const double gained = largest(energies.numbers("most_gained_j"), -boundless);
    const double lost = smallest(energies.numbers("least_lost_with_puncture_j"), boundless);
    double loops = 0, punctured = 0;
    for (const double n : energies.numbers("runs")) loops += n;
    for (const double n : energies.numbers("loops_with_punctures")) punctured += n;
    return {{fmt::format("round a closed loop without friction no hand gains more than {:g} J",
                         most_gained),
             loops > 0 && gained <= most_gained,
             fmt::format("at most {:.2g} J in {:.0f} loops", gained, loops)},
            {"every loop on which a surface gives way loses energy", punctured > 0 && lost > 0,
             fmt::format("at least {:.2g} J in {:.0f} loops", lost, punctured)}};
}

std::string energy_sentences(const Table& table) {
    const Table energies = table.where("part", "energy");
    double loops = 0, punctures = 0;
    for (const double n : energies.numbers("runs")) loops += n;
    for (const double n : energies.numbers("punctures")) punctures += n;
    return fmt::format(
        " Round {:.0f} closed random loops through ripples and a head, without friction, the force "
        "gives the hand at most {:.2g} J; on those with punctures ({:.0f} in all) the hand loses "
        "at least {:.2g} J.",
        loops, largest(energies.numbers("most_gained_j"), -boundless), punctures,
        smallest(energies.numbers("least_lost_with_puncture_j"), boundless));
}

}  // namespace palpate::evaluation

// The time of render() for the same hand, with five surfaces, with one and without layers.
#include "evaluation/layers/cost.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

namespace palpate::evaluation {
namespace {

constexpr std::array<const char*, 3> feels{"one level, no layers", "one surface", "five surfaces"};
constexpr std::array<const char*, 2> hands{"slides on the skin", "goes in and out"};

/// Round and round on the skin, pressing by a millimetre, which it stands.
std::vector<Vec3> sliding_hand(int ticks) {
    std::vector<Vec3> hand;
    const double skin = five_tissues().layers.front().level;
    for (int i = 0; i < ticks; ++i) {
        const double turn = 2 * std::numbers::pi * i / 1000;  // [s] a turn: 25 mm/s
        const Vec3 aside(4 * std::cos(turn), 4 * std::sin(turn), 0);
        const double radius = ball_radius - (skin + 1);
        hand.push_back((Vec3(0, 0, radius) + aside).normalized() * radius);
    }
    return hand;
}

/// From outside onto the bone and out again, at 100 mm/s.
std::vector<Vec3> stroking_hand(int ticks) {
    std::vector<Vec3> hand;
    const HandLine line{Vec3(2, 3, ball_radius), Vec3(0, 0, -1)};
    for (int i = 0; i < ticks; ++i) {
        const double way = std::fmod(0.1 * i, 112);
        hand.push_back(line.at(5 + (way < 56 ? way : 112 - way)));
    }
    return hand;
}

/// The renderer of one of `feels`.
Renderer renderer_that_feels(std::size_t what, const Field& field) {
    const Layers five = five_tissues();
    Renderer renderer =
        layered_renderer(field, std::make_shared<Layers>(what == 2 ? five : outermost_of(five)));
    if (what == 0) renderer.settings.layers = nullptr;
    return renderer;
}

/// Of each batch of ticks the times of all passes [ns].
using BatchTimes = std::vector<std::vector<double>>;

/// Goes round once, without a clock inside a batch.
void time_pass(Renderer renderer, const std::vector<Vec3>& hand, BatchTimes& times) {
    constexpr std::size_t batch = 40;
    using Clock = std::chrono::steady_clock;
    times.resize(hand.size() / batch);
    render(renderer, {.time = 0, .position = hand.front()});
    std::size_t i = 0;
    for (std::vector<double>& of_batch : times) {
        const auto begin = Clock::now();
        for (const std::size_t end = i + batch; i < end; ++i) {
            render(renderer, {.time = double(i + 1) / layers_rate, .position = hand[i]});
        }
        const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
        of_batch.push_back(taken.count() / batch);
    }
}

/// [ns] a tick: of each batch the median of its passes.
double mean_of(const BatchTimes& times) {
    double sum = 0;
    for (const auto& of_batch : times) sum += quantile(of_batch, 0.5);
    return sum / double(times.size());
}

}  // namespace

void add_costs(Table& table, LayeredPhantom phantom, int passes, bool quick) {
    const int ticks = quick ? 1120 : 11200;
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        phantom.field.set_interpolation(interpolation);
        for (const bool slides : {true, false}) {
            const std::vector<Vec3> hand = slides ? sliding_hand(ticks) : stroking_hand(ticks);
            // Without layers nothing gives way, and a hand that went in would be another one.
            const std::size_t first = slides ? 0 : 1;
            // The passes of all alternate, so that others' work on the machine meets all.
            std::array<BatchTimes, feels.size()> times;
            for (int pass = 0; pass < passes; ++pass) {
                for (std::size_t what = first; what < feels.size(); ++what) {
                    time_pass(renderer_that_feels(what, phantom.field), hand, times[what]);
                }
            }
            for (std::size_t what = first; what < feels.size(); ++what) {
                table.add({{"part", "cost"},
                           {"body", phantom.name},
                           {"field", std::string(name_of(interpolation))},
                           {"surfaces", feels[what]},
                           {"hand", slides ? hands[0] : hands[1]},
                           {"ticks", double(ticks)},
                           {"tick_ns", mean_of(times[what])}});
            }
        }
    }
}

std::string cost_sentences(const Table& table) {
    std::string text =
        " The cost of a tick with five surfaces, with one and, where the hand stays on the skin, "
        "without layers (median of several passes, the same hand on the balls):";
    const Table costs = table.where("part", "cost");
    for (const char* const field : {"linear", "cubic"}) {
        for (const char* const hand : hands) {
            const Table rows = costs.where("field", field).where("hand", hand);
            const auto ns = [&](const char* surfaces) {
                return rows.where("surfaces", surfaces).number(0, "tick_ns");
            };
            text += fmt::format(" {:.0f}, {:.0f}", ns(feels[2]), ns(feels[1]));
            if (hand == hands[0]) text += fmt::format(" and {:.0f}", ns(feels[0]));
            text += fmt::format(" ns where it {}, {} field;", hand, field);
        }
    }
    text.back() = '.';
    return text;
}

}  // namespace palpate::evaluation

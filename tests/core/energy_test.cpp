// Energy over closed paths of the hand, for every combination of field, surfaces, tool and samples:
// without friction no force gives back more than it took. An evaluation of the field of the test's
// own judges the proxy's place.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>

#include "support/combinations.hpp"

using namespace palpate;
using namespace palpate::support;

namespace energy {
using namespace support::combinations;
namespace {

/// The work of force and torque on the hand, beyond what springs had stored where it began [N mm].
class Meter {
  public:
    void step(const Tick& tick, const DeviceReading& reading) {
        const Quaternion turn(reading.orientation);
        if (tick.proxy.status == UpdateStatus::waiting ||
            tick.proxy.status == UpdateStatus::recovering) {
            // Another contact follows.
            running_ = false;
        } else if (!running_) {
            running_ = true;
            gained_ = -stored(tick);
        } else {
            gained_ += 0.5 * (last_.force + tick.force).dot(reading.position - from_) +
                       0.5 * (last_.torque + tick.torque).dot(rotation_between(turn_, turn));
        }
        last_ = tick;
        from_ = reading.position;
        turn_ = turn;
        if (running_) most_ = std::max(most_, gained_);
    }
    double most() const { return most_; }

  private:
    /// At most, where springs have a rest length.
    static double stored(const Tick& tick) {
        const Vec3 turn = rotation_between(tick.tool.hand, tick.tool.proxy);
        return 0.5 * (tick.force.dot(tick.proxy.scp - tick.proxy.hip) + tick.torque.dot(turn));
    }
    bool running_ = false;
    double gained_ = 0, most_ = 0;
    Tick last_;
    Vec3 from_ = Vec3::Zero();
    Quaternion turn_ = Quaternion::Identity();
};

struct Tally {
    int contacts = 0, free = 0, waits = 0, punctures = 0, judged = 0;
    int unfinished = 0;        // updates that ended with their budget
    double most_gained = 0;    // [N mm]
    double worst = -HUGE_VAL;  // how far a point was where it may not be [range]
};

/// How far the proxy, or the deepest point of the tool, is where it may not be.
double beyond(const Renderer& renderer, const Layers& of_level, const Tick& tick) {
    const RendererSettings& settings = renderer.settings;
    const TouchedField touched = touched_by(renderer, of_level);
    if (!settings.tool) return touched.beyond(tick.proxy.scp);
    double worst = -HUGE_VAL;
    for (const Vec3& point : settings.tool->points()) {
        const Pose pose{tick.proxy.scp, tick.tool.proxy};
        worst = std::max(worst, touched.beyond(physical_from_tool(pose, point)));
    }
    return worst;
}

void go_round(const Combination& of, std::uint64_t seed, int steps, int budget, Tally& tally) {
    Random random(seed);
    Source source(of.data, seed);
    const Layers of_level = level_alone(of.tool);
    RendererSettings settings = settings_for(of);
    settings.proxy.step_budget = budget;
    Session session = session_on(source, of, settings);
    const Loop loop(random, source_middle + random.uniform(0, 4) * random.direction());
    Meter meter;
    for (int i = 0; i <= 2 * steps; ++i) {
        source.come_and_go(session);
        const DeviceReading reading = loop.at(double(i) / steps);
        const Tick tick = advance(session, (i + 1) * period, reading).tick;
        meter.step(tick, reading);
        tally.contacts += tick.proxy.mode == Mode::constrained;
        tally.free += tick.proxy.status == UpdateStatus::done && tick.proxy.mode == Mode::free;
        tally.waits += tick.proxy.status == UpdateStatus::waiting;
        tally.punctures += tick.layers.punctured;
        tally.unfinished += tick.proxy.status == UpdateStatus::out_of_budget;
        if (tick.proxy.status != UpdateStatus::done || i % 16 != 0) continue;
        ++tally.judged;
        tally.worst = std::max(tally.worst, beyond(session.renderer, of_level, tick));
    }
    tally.most_gained = std::max(tally.most_gained, meter.most());
}

class Energy : public testing::TestWithParam<Combination> {};

/// Loops with this budget of a tick.
Tally go_round(const Combination& of, int loops, int budget) {
    Tally tally;
    for (int i = 0; i < loops; ++i) go_round(of, std::uint64_t(100 + i), 3000, budget, tally);
    std::ostringstream name;
    name << of;
    std::printf(
        "[ evidence ] %-36s contacts %d  free %d  waits %d  unfinished %d  punctures %d  gained "
        "%.1e J  worst %.1e\n",
        name.str().c_str(), tally.contacts, tally.free, tally.waits, tally.unfinished,
        tally.punctures, tally.most_gained / 1000, tally.worst);
    EXPECT_LE(tally.most_gained / 1000, 1e-6);
    EXPECT_LE(tally.worst, 1e-9);
    EXPECT_GT(tally.contacts, loops * 100);
    EXPECT_GT(tally.judged, loops * 20);
    return tally;
}

TEST_P(Energy, is_not_made_over_closed_paths_of_the_hand) {
    const int loops = scaled_or_asked(4) + 1;
    const Tally tally = go_round(GetParam(), loops, ProxySettings{}.step_budget);
    EXPECT_GT(tally.free, loops * 100);
    EXPECT_EQ(tally.waits > 0, GetParam().data == Data::resident);
}

/// The proxy lags behind the hand, in contact and in free space.
TEST_P(Energy, is_not_made_where_updates_end_with_their_budget) {
    constexpr std::array<int, 3> budget{8, 40, 100};  // of a point, a rod and a box
    const int loops = scaled_or_asked(4) + 1;
    const Tally tally = go_round(GetParam(), loops, budget[std::size_t(GetParam().tool)]);
    EXPECT_GT(tally.unfinished, loops * 2);
}

INSTANTIATE_TEST_SUITE_P(Every, Energy, testing::ValuesIn(all_combinations()),
                         testing::PrintToStringParamName());

/// A block on a plane, where nothing is lost. Loops begin in free space.
TEST(EnergyAtTheLimit, is_not_made_by_the_two_springs_of_a_tool) {
    const Field field(volume_of<float>(grid({48, 48, 48}), [](const Index3& i) { return i[2]; }),
                      Solid::above, 0, Interpolation::cubic);
    RendererSettings settings =
        settings_for({Interpolation::cubic, Surfaces::level, Touching::point, Data::plain});
    settings.tool = std::make_shared<const Tool>(box_tool({20, 10, 5}, 2.5));
    constexpr int steps = 4000;
    std::array<double, 2> most{};  // by which limit it is [N mm]
    std::array<int, 2> limited{};
    for (std::size_t i = 0; i < 40; ++i) {
        settings.force.limit = i % 2 == 0 ? 0.4 : 1e6;
        settings.force.torque_limit = i % 2 == 0 ? 1e6 : 2;
        Random random(i / 2);
        const Loop loop(random, Vec3(24, 24, 19));
        Session session{make_renderer(field, 24, settings), {.fastest_hand = infinity}};
        Meter meter;
        for (int k = 0; k <= 2 * steps; ++k) {
            const DeviceReading reading = loop.at(double(k) / steps);
            const Tick tick = advance(session, (k + 1) * period, reading).tick;
            meter.step(tick, reading);
            limited[i % 2] += tick.force_flags & force_limited;
        }
        most[i % 2] = std::max(most[i % 2], meter.most());
    }
    std::printf("[ evidence ] at the limit of force %d, of torque %d; gained %.1e and %.1e J\n",
                limited[0], limited[1], most[0] / 1000, most[1] / 1000);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_LE(most[i] / 1000, 1e-6);
        EXPECT_GT(limited[i], 10000);
    }
}

/// Surfaces of all kinds round (24, 24, 24), at level 88.
std::array<Volume, 4> bodies() {
    const auto made = [](auto&& distance) {
        return volume_of<float>(grid(cube(48)), [&](const Index3& i) {
            return 100 - distance(Vec3(i.cast<double>() - Vec3::Constant(24)));
        });
    };
    return {made([](const Vec3& at) { return at.norm(); }),
            made([](const Vec3& at) { return Vec3(0.5 * at[0], at[1], at[2]).norm(); }),
            made([](const Vec3& at) { return at.cwiseAbs().maxCoeff(); }),
            noise_volume<float>(grid(cube(48)), 3, 60, 110)};
}

/// The first time round, the hand comes to where the magnet holds it.
TEST(EnergyOfTheMagnet, is_not_made_over_closed_paths_of_the_hand) {
    for (const Volume& body : bodies()) {
        for (const auto interpolation : {Interpolation::linear, Interpolation::cubic}) {
            double most = -HUGE_VAL;
            int drawn = 0;
            for (int seed = 0; seed < scaled(20); ++seed) {
                Random random(std::uint64_t(seed) + 1);
                RendererSettings settings =
                    settings_for({interpolation, Surfaces::level, Touching::point, Data::plain});
                settings.force.magnet = {2, 0.5};
                Session session{
                    make_renderer(Field(body, Solid::above, 0, interpolation), 88, settings),
                    {.fastest_hand = infinity}};
                const Loop loop(random, Vec3::Constant(24) + 13 * random.direction());
                constexpr int steps = 6000;
                double work = 0;
                Tick last;
                for (int i = 0; i <= 3 * steps; ++i) {
                    const DeviceReading reading = loop.at(double(i) / steps);
                    const Tick tick = advance(session, (i + 1) * period, reading).tick;
                    const Vec3 way = reading.position - loop.at(double(i - 1) / steps).position;
                    if (i > steps) work += 0.5 * (last.force + tick.force).dot(way);
                    drawn += tick.proxy.mode == Mode::free && !tick.force.isZero(0);
                    last = tick;
                }
                most = std::max(most, work / 2);
            }
            std::printf("[ evidence ] magnet, %s: drawn in %d ticks, gained %.1e J\n",
                        std::string(name_of(interpolation)).c_str(), drawn, most / 1000);
            EXPECT_LE(most / 1000, 1e-6);
            EXPECT_GT(drawn, scaled(2000));
        }
    }
}

}  // namespace
}  // namespace energy

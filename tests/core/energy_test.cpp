// Energy over closed paths of the hand, for every combination of field, surfaces, tool and samples:
// without friction no force gives back more than it took. An evaluation of the field of the test's
// own judges the proxy's place.
#include <gtest/gtest.h>

#include <numbers>

#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/labelled.hpp"
#include "support/layer.hpp"
#include "support/press.hpp"
#include "support/resident.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace energy {
namespace {

enum class Surfaces { level, levels, labels, both };
enum class Touching { point, rod, box };
enum class Data { plain, edited, between_frames, resident };

struct Combination {
    Interpolation field;
    Surfaces surfaces;
    Touching tool;
    Data data;
};

std::vector<Combination> all_combinations() {
    std::vector<Combination> all;
    for (const Data data : {Data::plain, Data::edited, Data::between_frames, Data::resident}) {
        for (const auto field : {Interpolation::linear, Interpolation::cubic}) {
            for (const Surfaces surfaces :
                 {Surfaces::level, Surfaces::levels, Surfaces::labels, Surfaces::both}) {
                all.push_back({field, surfaces, Touching::point, data});
            }
        }
        for (const Touching tool : {Touching::rod, Touching::box}) {
            all.push_back({Interpolation::cubic, Surfaces::level, tool, data});
        }
    }
    return all;
}

std::ostream& operator<<(std::ostream& out, const Combination& of) {
    const std::array<const char*, 4> surfaces{"level", "levels", "labels", "both"};
    const std::array<const char*, 3> tools{"point", "rod", "box"};
    const std::array<const char*, 4> data{"plain", "edited", "between_frames", "resident"};
    return out << name_of(of.field) << '_' << surfaces[std::size_t(of.surfaces)] << '_'
               << tools[std::size_t(of.tool)] << '_' << data[std::size_t(of.data)];
}

/// In noise a body has room above a higher level only.
double level_of(Touching tool) {
    return tool == Touching::point ? 128.5 : 165.5;
}

/// Samples of two bricks of a large grid, the border between which lies at x = 64.
const Index3 size(80, 24, 24);
const Vec3 middle(64, 12, 12);

/// The samples of a combination; of resident ones, bricks come and go.
class Source {
  public:
    Source(Data data, std::uint64_t seed)
        : random_(seed),
          volume_(noise_volume<std::uint8_t>(grid(size), seed, 0, 256)),
          part_(volume_) {
        samples_ = std::make_shared<const Samples>(volume_);
        if (data == Data::between_frames) {
            samples_ = std::make_shared<const Samples>(std::vector<Frame>{
                {0, volume_}, {1, noise_volume<std::uint8_t>(grid(size), seed + 1, 0, 256)}});
        }
        for (int i = 0; data == Data::edited && i < 8; ++i) {
            samples_ =
                edited(samples_, random_edit(random_, grid(size), SampleType::uint8)).samples;
        }
        part_.add_all();
        if (data == Data::resident) samples_ = part_.samples();
    }
    const std::shared_ptr<const Samples>& samples() const { return samples_; }
    void come_and_go(Session& session) {
        if (!samples_->resident() || !random_.chance(0.003)) return;
        part_.change(random_, 0.2);
        samples_ = part_.samples();
        apply(session, command::Samples{samples_});
    }

  private:
    Random random_;
    Volume volume_;
    PartOf part_;
    std::shared_ptr<const Samples> samples_;
};

std::shared_ptr<const Layers> layers_of(Surfaces surfaces) {
    auto layers = std::make_shared<Layers>();
    const int levels = surfaces == Surfaces::labels ? 0 : 3;
    for (int i = 0; i < levels; ++i) {
        layers->layers.push_back(layer_of("level " + std::to_string(i), 100.5 + 25 * i,
                                          0.4 + 0.5 * i, i == 2 ? infinity : 0.5));
    }
    if (surfaces == Surfaces::levels) return layers;
    for (int i = 1; i <= 3; ++i) {
        layers->layers.push_back(
            layer_of("label " + std::to_string(i), i, 0.4 * i, i == 3 ? infinity : 0.4));
    }
    layers->by_label = true;
    layers->levels_beside_labels = std::size_t(levels);
    const Geometry geometry = grid({54, 16, 16}, Vec3::Constant(1.5), {-0.5, 0.5, 0.2});
    layers->labels = numbered_labels(random_labels(9, 3, geometry), layers->layers,
                                     layers->levels_beside_labels);
    return layers;
}

RendererSettings settings_of(const Combination& of) {
    RendererSettings settings = at_once();
    settings.force.limit = settings.device.maximum_force = 1e6;
    settings.device.physical_damping = 1;
    settings.device.maximum_torque = 1e6;
    settings.device.physical_rotational_damping = 1e3;
    settings.force.torque_rate_limit = infinity;
    if (of.surfaces != Surfaces::level) settings.layers = layers_of(of.surfaces);
    if (of.tool == Touching::rod) settings.tool = std::make_shared<const Tool>(rod_tool(3, 1));
    if (of.tool == Touching::box) {
        settings.tool = std::make_shared<const Tool>(box_tool({2, 2, 1}, 1));
    }
    return settings;
}

/// A closed path, of which the turn is closed as well.
struct Loop {
    Vec3 centre;
    std::array<Vec3, 4> sines, cosines, turns;

    Loop(Random& random, const Vec3& at) : centre(at) {
        for (int i = 0; i < 4; ++i) {
            sines[i] = 3.0 / (1 + i) * random.uniform(0, 1) * random.direction();
            cosines[i] = 3.0 / (1 + i) * random.uniform(0, 1) * random.direction();
            turns[i] = 0.6 / (1 + i) * random.uniform(0, 1) * random.direction();
        }
    }
    DeviceReading at(double part) const {
        DeviceReading reading = ready_at(centre);
        Vec3 turn = Vec3::Zero();
        for (int i = 0; i < 4; ++i) {
            const double phase = 2 * std::numbers::pi * (i + 1) * part;
            reading.position += std::sin(phase) * sines[i] + (std::cos(phase) - 1) * cosines[i];
            turn += std::sin(phase) * turns[i];
        }
        reading.orientation = turned(Quaternion::Identity(), turn).toRotationMatrix();
        return reading;
    }
};

/// The work of force and torque on the hand, beyond what springs had stored where it began [N mm].
class Meter {
  public:
    void step(const Tick& tick, const DeviceReading& reading) {
        const Quaternion turn(reading.orientation);
        if (tick.proxy.status == UpdateStatus::waiting ||
            tick.proxy.status == UpdateStatus::recovering) {
            running_ = false;  // what comes next is another contact
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
    const TouchedField touched{renderer.field, settings.layers ? *settings.layers : of_level,
                               renderer.layers};
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
    Layers of_level;
    of_level.layers.push_back(layer_of("level", level_of(of.tool), 1, infinity));
    Field field(source.samples(), Solid::above, 0, of.field);
    field.set_time(0.4);
    RendererSettings settings = settings_of(of);
    settings.proxy.step_budget = budget;
    Session session{make_renderer(field, level_of(of.tool), settings), {.fastest_hand = infinity}};
    const Loop loop(random, middle + random.uniform(0, 4) * random.direction());
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
        settings_of({Interpolation::cubic, Surfaces::level, Touching::point, Data::plain});
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

}  // namespace
}  // namespace energy

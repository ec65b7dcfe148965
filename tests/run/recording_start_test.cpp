// A recording that begins in the middle of a run: the hand feels nothing of it, and the recording
// renders again with the same bits, whatever the session was doing.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "palpate/io/volume_file.hpp"
#include "palpate/run/labels.hpp"
#include "run/run_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

/// Two shells of the ball that give way at a small force, with a needle.
Layers soft_shells() {
    Layers layers;
    for (const double level : {40.0, 70.0}) {
        Layer layer;
        layer.name = "shell " + std::to_string(layers.layers.size());
        layer.level = level;
        layer[HapticProperty::puncture_force] = 0.3;
        layer[HapticProperty::stiffness] = 0.3;
        layers.layers.push_back(layer);
    }
    layers.needle.emplace();
    return layers;
}

/// A ball in a ball, as a label volume in a file.
Layers labels_in(const Geometry& geometry, const std::filesystem::path& file) {
    std::vector<std::uint8_t> labels;
    const Vec3 centre = (geometry.size.cast<double>() - Vec3::Ones()) / 2;
    for (int z = 0; z < geometry.size[2]; ++z) {
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) {
                const double share = (Vec3(x, y, z) - centre).norm() / centre[0];
                labels.push_back(share < 0.3 ? 2 : share < 0.9 ? 1 : 0);
            }
        }
    }
    io::write_volume(Volume(geometry, std::move(labels)), file);
    Layers layers = layers_by_label(load(source_named(file.string()))).layers;
    for (Layer& layer : layers.layers) layer[HapticProperty::puncture_force] = 0.3;
    return layers;
}

void use_layers(Run& live, Layers layers) {
    live.send(command::UseLayers{std::make_shared<const Layers>(std::move(layers))});
}

using Folder = std::filesystem::path;
// Each brings a run to where the recording begins.
namespace from {
void before_the_first_tick(Run&, const Folder&) {}
void in_the_ramp(Run& live, const Folder&) {
    test::step(live, 60);
}
void pressing(Run& live, const Folder&) {
    test::step(live, 400);
}
void on_the_linear_field(Run& live, const Folder&) {
    live.use_field(Solid::above, Interpolation::linear);
    test::step(live, 400);
}
void pressed_through(Run& live, const Folder&) {
    live.send(penetrability_threshold(0.2, live.isovalue()));
    test::step(live, 700);
}
void with_the_clutch(Run& live, const Folder&) {
    test::step(live, 400);
    live.send(command::Clutch{true});
    test::step(live, 30);
}
void frozen_with_other_forces(Run& live, const Folder&) {
    test::step(live, 400);
    ForceSettings force = live.settings().force;
    force.stiffness = 0.2;
    live.send(force);
    live.send(command::Freeze{true});
    test::step(live, 3);
}
void in_layers_with_a_needle(Run& live, const Folder&) {
    use_layers(live, soft_shells());
    test::step(live, 900);
    EXPECT_GT(live.snapshot()->session.tick.layers.inside, 0);
}
void in_a_label(Run& live, const Folder& folder) {
    use_layers(live, labels_in(live.field().geometry(), folder / "labels.nrrd"));
    test::step(live, 900);
    EXPECT_GT(live.snapshot()->session.tick.layers.inside, 0);
}
void with_a_tool(Run& live, const Folder&) {
    live.send(command::UseTool{std::make_shared<const Tool>(sphere_tool(2, 0.5))});
    test::step(live, 900);
    EXPECT_GT(live.snapshot()->session.tick.force.norm(), 0.1);
}
void after_edits(Run& live, const Folder&) {
    VolumeEditor& editor = live.data().editor();
    test::step(live, 400);
    editor.apply(edit::Fill{{{5, 5, 5}, {20, 20, 20}}, 0});
    editor.apply(edit::Fill{{{5, 5, 5}, {9, 9, 9}}, 200});
    test::step(live, 100);
    EXPECT_TRUE(editor.undo());
}
void playing(Run& live, const Folder&) {
    test::steps_until(live, [&] { return live.data().player().is_settled(); });
    live.data().player().play(1);
    test::step(live, 700);
}

}  // namespace from

const std::string a_ball = "synthetic:sphere:32x32x32";
const std::string a_heart = "synthetic:beating:24x24x24";
const std::string a_hand = "simulated:hand=hold,depth=5,seconds=60";
const std::string a_turning_hand = "simulated:touchx,hand=hold,depth=8,turn=20,seconds=60";

struct Case {
    const char* name;
    void (*begin)(Run& live, const Folder& folder);
    const std::string& volume = a_ball;
    const std::string& device = a_hand;
    /// [N] How much the forces of two runs may differ: frames come when they have been read.
    double apart = 0;
};
std::ostream& operator<<(std::ostream& out, const Case& one) {
    return out << one.name;
}

/// A run that is brought to where a recording begins.
struct Begun {
    Run live;

    Begun(const Case& one, const std::filesystem::path& folder)
        : live(test::stepped_data(test::loaded(one.volume)), test::with_device(one.device)) {
        live.start();
        one.begin(live, folder);
    }
    std::vector<Vec3> forces(int ticks) {
        std::vector<Vec3> forces;
        for (int i = 0; i < ticks; ++i) {
            live.step();
            forces.push_back(live.snapshot()->session.tick.force);
        }
        return forces;
    }
};

/// Renders a recording again.
void expect_the_same(const std::filesystem::path& path, const LoadedVolume& loaded) {
    io::RecordingReader reader(path);
    Replay replay(reader, loaded, path.string());
    test::expect_same_again(replay);
    EXPECT_TRUE(reader.complete());
    EXPECT_EQ(reader.lost(), 0);
}

class RecordingStart : public testing::TestWithParam<Case> {};

TEST_P(RecordingStart, is_not_felt_and_the_recording_comes_out_the_same) {
    const support::ScratchFolder folder;
    Begun recorded(GetParam(), folder.path()), other(GetParam(), folder.path());
    const std::filesystem::path path = folder / "a.csv";
    recorded.live.record(path);
    const std::vector<Vec3> forces = recorded.forces(300), without = other.forces(300);
    EXPECT_EQ(recorded.live.stop_recording(), 300);
    for (std::size_t i = 0; i < forces.size(); ++i) {
        ASSERT_LE((forces[i] - without[i]).norm(), GetParam().apart) << "tick " << i;
    }

    expect_the_same(path, load(recorded_source(io::RecordingReader(path).head(), path)));
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, RecordingStart,
    testing::Values(
        Case{"before_the_first_tick", from::before_the_first_tick},
        Case{"in_the_ramp", from::in_the_ramp}, Case{"pressing", from::pressing},
        Case{"on_the_linear_field", from::on_the_linear_field},
        Case{"pressed_through", from::pressed_through},
        Case{"with_the_clutch", from::with_the_clutch, a_ball, a_turning_hand},
        Case{"frozen_with_other_forces", from::frozen_with_other_forces},
        Case{"in_layers_with_a_needle", from::in_layers_with_a_needle, a_ball, a_turning_hand},
        Case{"in_a_label", from::in_a_label}, Case{"after_edits", from::after_edits},
        Case{"with_a_tool", from::with_a_tool, a_ball, a_turning_hand},
        Case{"playing", from::playing, a_heart, a_hand, std::numeric_limits<double>::infinity()}),
    [](const auto& info) { return info.param.name; });

/// A servo alone does not refuse layers beside a tool: they wait until it is put down.
TEST(Recordings, of_a_servo_with_a_tool_beside_layers_come_out_the_same) {
    const support::ScratchFolder folder;
    Begun begun({"pressing", from::pressing}, folder.path());
    const LoadedVolume loaded = load(source_named(a_ball));
    begun.live.record(folder / "head.csv");
    begun.live.stop();
    io::RecordingHead head = io::RecordingReader(folder / "head.csv").head();
    head.settings.transform = {};
    Session session = recorded_session(head, loaded, "head.csv");

    const auto layers = std::make_shared<const Layers>(soft_shells());
    const auto tool = std::make_shared<const Tool>(sphere_tool(2, 0.5));
    support::ScriptedDevice device([](double time) {
        return support::ready_at({15 - 30 * time, 0.3, 0.2});
    });
    Servo servo(session, device, {.real_time = false});
    std::int64_t now = 0;  // [ns]
    const auto step = [&](int ticks) {
        for (int i = 0; i < ticks; ++i) ASSERT_TRUE(servo.step(now += 1'000'000));
    };
    ASSERT_TRUE(servo.send(command::UseLayers{layers}));
    ASSERT_TRUE(servo.send(command::UseTool{tool}));
    step(100);
    head.settings.layers = layers;
    head.settings.tool = tool;
    io::RecordingWriter writer(folder / "a.csv", head, Pace::by_steps);
    ASSERT_TRUE(servo.record(writer.queue()));
    step(50);
    ASSERT_TRUE(servo.send(command::UseTool{nullptr}));
    step(300);
    EXPECT_GT(servo.snapshot()->session.tick.layers.inside, 0);
    servo.stop_recording();
    writer.finish(servo.report().unrecorded);
    expect_the_same(folder / "a.csv", loaded);
}

/// One that ends at once, with the next in its place: each has its own ticks.
TEST(Recordings, follow_each_other_while_the_session_goes_on) {
    const support::ScratchFolder folder;
    Begun begun({"pressing", from::pressing}, folder.path());
    begun.live.record(folder / "a.csv");
    begun.live.record(folder / "b.csv");
    begun.forces(5);
    begun.live.record(folder / "c.csv");
    begun.forces(7);
    begun.live.stop();
    begun.live.stop_recording();
    for (const auto& [name, ticks] : {std::pair("a.csv", 0), {"b.csv", 5}, {"c.csv", 7}}) {
        io::RecordingReader reader(folder / name);
        int count = 0;
        while (const auto event = reader.next())
            count += std::holds_alternative<SessionTick>(*event);
        EXPECT_EQ(count, ticks) << name;
        EXPECT_TRUE(reader.complete()) << name;
    }
}

}  // namespace
}  // namespace palpate::run

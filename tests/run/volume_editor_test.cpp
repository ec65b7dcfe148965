// A brush in the hand of a running session, and edits beside it.
#include "apps/live/sculptor.hpp"

#include <cmath>
#include <cstring>

#include "live/living_support.hpp"

namespace palpate::app {
namespace {

using test::comes_true;

/// A ball (its middle at 0), and a hand some millimetres deep in it.
struct Pressing {
    LoadedVolume ball = test::loaded("synthetic:sphere");
    Field field{ball.volume};
    double isovalue = *ball.isovalue;
    support::ScriptedDevice device{[](double) { return support::ready_at({-15, 0, 0}); }};
    Sculptor sculptor{field};
    Servo servo;

    Pressing()
        : servo({make_renderer(field, isovalue, {}), {}}, device,
                {.rate = 1000, .real_time = false}) {
        servo.start();
        sculptor.attach(&servo);
    }
    ~Pressing() {
        sculptor.attach(nullptr);
        servo.stop();
    }

    Vec3 scp() const {
        const auto now = servo.snapshot();
        return now ? now->session.tick.proxy.scp : Vec3(Vec3::Constant(-1000));
    }
    bool touches() const {
        return comes_true([&] {
            const auto now = servo.snapshot();
            return now && now->session.tick.proxy.mode == Mode::constrained &&
                   now->session.tick.proxy.status == UpdateStatus::done && scp()[0] < -16;
        });
    }
    bool felt(std::uint64_t version) const {
        return comes_true([&] {
            const auto now = servo.snapshot();
            return now && now->session.version == version;
        });
    }
};

TEST(Sculptor, a_brush_that_carves_lets_the_hand_through_and_leaves_what_it_does_not_touch) {
    Pressing p;
    ASSERT_TRUE(p.touches());
    p.sculptor.set_brush(HandBrush{.radius = 6, .rate = 30});
    // The way is free once all in front of the hand is gone.
    EXPECT_TRUE(comes_true([&] { return (p.scp() - Vec3(-15, 0, 0)).norm() < 1e-9; }));
    p.sculptor.set_brush({});
    const Work work = p.sculptor.work();
    EXPECT_TRUE(work.changed);
    EXPECT_GT(work.version, 0U);
    EXPECT_EQ(work.samples->sample({48, 32, 32}), p.ball.volume.sample({48, 32, 32}));
    EXPECT_LT(work.samples->sample({16, 32, 32}), p.isovalue);
}

TEST(Sculptor, one_that_adds_pushes_the_hand_out) {
    Pressing p;
    ASSERT_TRUE(p.touches());
    const double before = p.scp()[0];
    p.sculptor.set_brush(HandBrush{.kind = BrushKind::add, .radius = 4, .rate = 30});
    EXPECT_TRUE(comes_true([&] { return p.scp()[0] < before - 2; }));
}

TEST(Sculptor, works_only_in_contact) {
    Pressing p;
    p.sculptor.apply(edit::Fill{whole_box(p.field.geometry()), 0});
    ASSERT_TRUE(p.felt(1));
    p.sculptor.set_brush(HandBrush{.kind = BrushKind::add, .radius = 4, .rate = 1000});
    const auto now = p.servo.snapshot();
    ASSERT_TRUE(comes_true([&] { return p.servo.snapshot()->number > now->number + 50; }));
    EXPECT_EQ(p.sculptor.work().version, 1U);
}

TEST(Sculptor, undo_and_redo_go_through_versions_that_the_servo_feels) {
    Pressing p;
    const auto start = p.sculptor.work().samples;
    p.sculptor.apply(edit::Fill{{{20, 20, 20}, {40, 40, 40}}, 200});
    p.sculptor.apply(edit::Fill{{{20, 20, 20}, {30, 30, 30}}, 0});
    ASSERT_TRUE(p.felt(2));
    EXPECT_EQ(p.sculptor.work().undo_steps, 2U);
    EXPECT_TRUE(p.sculptor.undo());
    EXPECT_TRUE(p.felt(1));
    EXPECT_TRUE(p.sculptor.undo());
    EXPECT_TRUE(p.felt(0));
    EXPECT_EQ(p.sculptor.work().samples, start);
    EXPECT_FALSE(p.sculptor.work().changed);
    EXPECT_FALSE(p.sculptor.undo());
    EXPECT_TRUE(p.sculptor.redo());
    EXPECT_TRUE(p.felt(1));
    // An edit after an undo: the version that was taken back does not come again.
    p.sculptor.apply(edit::Fill{{{1, 1, 1}, {2, 2, 2}}, 9});
    EXPECT_TRUE(p.felt(3));
    EXPECT_FALSE(p.sculptor.redo());
}

TEST(Sculptor, a_stroke_is_one_step_for_undo) {
    Pressing p;
    ASSERT_TRUE(p.touches());
    p.sculptor.set_brush(HandBrush{.radius = 3, .rate = 5});
    ASSERT_TRUE(comes_true([&] { return p.sculptor.work().version > 20; }));
    p.sculptor.set_brush({});
    EXPECT_EQ(p.sculptor.work().undo_steps, 1U);
    EXPECT_TRUE(p.sculptor.undo());
    EXPECT_TRUE(p.felt(0));
}

TEST(Sculptor, after_an_undo_the_brush_rests_until_it_is_taken_up_again) {
    Pressing p;
    ASSERT_TRUE(p.touches());
    p.sculptor.set_brush(HandBrush{.radius = 3, .rate = 5});
    ASSERT_TRUE(comes_true([&] { return p.sculptor.work().version > 20; }));
    EXPECT_TRUE(p.sculptor.undo());
    EXPECT_TRUE(p.felt(0));
    const std::int64_t then = p.servo.snapshot()->number;
    ASSERT_TRUE(comes_true([&] { return p.servo.snapshot()->number > then + 50; }));
    EXPECT_EQ(p.sculptor.work().version, 0U);
    EXPECT_EQ(p.sculptor.work().redo_steps, 1U) << "what was undone can come back";
    p.sculptor.set_brush({});
    p.sculptor.set_brush(HandBrush{.radius = 3, .rate = 5});
    EXPECT_TRUE(comes_true([&] { return p.sculptor.work().version > 0; }));
}

TEST(Sculptor, a_brush_that_can_do_nothing_says_why) {
    Pressing p;
    ASSERT_TRUE(p.touches());
    p.sculptor.set_brush(
        HandBrush{.radius = 3, .rate = 5, .value = 200});  // solid: not to carve to
    EXPECT_TRUE(comes_true([&] { return !p.sculptor.work().problem.empty(); }));
    EXPECT_EQ(p.sculptor.work().version, 0U);
    p.sculptor.set_brush(HandBrush{.radius = 3, .rate = 5});
    EXPECT_TRUE(comes_true([&] { return p.sculptor.work().version > 0; }));
    EXPECT_EQ(p.sculptor.work().problem, "");
}

TEST(Sculptor, its_history_makes_the_same_samples_again) {
    Pressing p;
    p.sculptor.apply(edit::Fill{{{20, 20, 20}, {40, 40, 40}}, 200});
    p.sculptor.apply(
        edit::Stroke{brush_for(BrushKind::carve, p.field, p.isovalue, 5), {-20, 0, 0}, {0, 3, 5}});
    p.sculptor.undo();
    Session again{make_renderer(p.field, p.isovalue, {}), {}};
    RecordedSamples samples(p.field.shared_samples());
    for (const command::Samples& told : p.sculptor.history()) {
        EXPECT_EQ(told.samples, nullptr);
        palpate::apply(again, samples.whole(told));
    }
    EXPECT_EQ(again.version, p.sculptor.work().version);
    const Volume felt = flattened(*p.sculptor.work().samples);
    const Volume made = flattened(again.renderer.field.samples());
    EXPECT_EQ(std::memcmp(felt.data(), made.data(), felt.bytes()), 0);
}

TEST(Sculptor, refuses_brushes_that_cannot_work_and_says_why) {
    Pressing p;
    const double nan = std::nan("");
    EXPECT_THROW(p.sculptor.set_brush(HandBrush{.radius = 0}), std::invalid_argument);
    EXPECT_THROW(p.sculptor.set_brush(HandBrush{.radius = nan}), std::invalid_argument);
    EXPECT_THROW(p.sculptor.set_brush(HandBrush{.hardness = 2}), std::invalid_argument);
    EXPECT_THROW(p.sculptor.set_brush(HandBrush{.rate = 0}), std::invalid_argument);
    EXPECT_THROW(p.sculptor.set_brush(HandBrush{.kind = BrushKind::paint}), std::invalid_argument);
    EXPECT_THROW(p.sculptor.apply(edit::Fill{{{0, 0, 0}, {1, 1, 1}}, nan}), std::invalid_argument);
    EXPECT_EQ(p.sculptor.work().version, 0U);
}

}  // namespace
}  // namespace palpate::app

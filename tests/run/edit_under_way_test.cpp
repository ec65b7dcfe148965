// Functions of the editor that come while an edit is computed: they do not wait for it.
#include <functional>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "palpate/run/volume_editor.hpp"
#include "palpate/stream/store.hpp"
#include "run/run_support.hpp"

namespace palpate::run {
namespace {

/// A ball that a hand presses into, and an edit of it that takes long.
struct LongEdit {
    LoadedVolume ball;
    Field field = linear_field(ball.volume);
    // On the heap: the thread sanitizer does not notice that a mutex on the stack has ended, and
    // takes another one at its place for the same.
    const std::unique_ptr<VolumeEditor> owned =
        std::make_unique<VolumeEditor>(field.shared_samples(), Pace::by_steps);
    VolumeEditor& editor = *owned;
    support::ScriptedDevice device{[](double) { return support::ready_at({-15, 0, 0}); }};
    test::Time time;
    std::unique_ptr<Servo> servo =
        editor.attach({make_renderer(field, *ball.isovalue, {}), {}}, test::servo_on(device));

    explicit LongEdit(const std::string& name = "synthetic:sphere:200x200x200")
        : ball(test::loaded(name)) {
        time.step({servo.get()}, [](auto) {});  // by the thread that stops it
    }
    ~LongEdit() {
        servo->stop();
        editor.detach(*servo);
    }

    /// Begins the long edit, calls `call` while it is computed, and then cancels it.
    void during_edit(const std::function<void()>& call) {
        Brush all = brush_for(BrushKind::smooth, field, *ball.isovalue, 500);
        const edit::Stroke stroke{all, Vec3(-50, 0, 0), Vec3(50, 30, 0)};
        bool called = false;
        while (!called) {  // again if it was done too soon
            const auto undone = editor.state().undo_steps;
            const auto progress = [&](double made) {
                if (!(made > 0 && made < 1)) return;
                call();
                called = true;
                throw stream::Cancelled{};
            };
            try {
                editor.apply(stroke, progress);
                ASSERT_EQ(editor.state().undo_steps, undone + 1);
                ASSERT_TRUE(editor.undo());
            } catch (const stream::Cancelled&) {
            }
        }
    }
};

TEST(EditUnderWay, undo_and_redo_come_before_it) {
    LongEdit p;
    p.editor.apply(edit::Fill{{{1, 1, 1}, {5, 5, 5}}, 90});
    const std::uint64_t first = p.editor.state().version;
    p.during_edit([&] {
        EXPECT_TRUE(p.editor.undo());
        EXPECT_EQ(p.editor.state().version, 0U) << "it has undone the edit that was under way";
        EXPECT_TRUE(p.editor.redo());
        EXPECT_EQ(p.editor.state().version, first);
        EXPECT_TRUE(p.editor.undo());
    });
    EXPECT_EQ(p.editor.state().version, 0U);
}

TEST(EditUnderWay, everything_that_a_window_calls_returns_before_its_end) {
    LongEdit p;
    p.during_edit([&] {
        p.editor.set_brush(HandBrush{});
        p.editor.rest_brush(*p.servo, nullptr);
        p.editor.set_brush(std::nullopt);
        p.editor.record(*p.servo, [](const std::vector<Command>&) {});
        EXPECT_TRUE(p.editor.knows_history());
        p.editor.set_saved(p.editor.state().samples);
        p.editor.detach(*p.servo);
        EXPECT_EQ(p.editor.state().version, 0U) << "one of them has waited for the edit";
    });
    EXPECT_EQ(p.editor.state().version, 0U);
}

TEST(EditUnderWay, an_edit_is_computed_again_for_what_has_come_before_it) {
    LongEdit p;
    const auto fill = [](int value) {
        return edit::Fill{{{1, 1, 1}, {150, 150, 150}}, 1.0 * value};
    };
    bool undone = false;
    p.editor.apply(edit::Fill{{{0, 0, 0}, {199, 199, 199}}, 77});
    p.editor.apply(fill(90), [&](double) {
        if (!std::exchange(undone, true)) p.editor.undo();
    });
    EXPECT_EQ(p.editor.state().samples->sample({100, 100, 100}), 90);
    EXPECT_EQ(p.editor.state().samples->sample({199, 199, 199}),
              p.ball.volume.sample({199, 199, 199}));
    EXPECT_EQ(p.editor.state().undo_steps, 1U);
}

/// Steps the servo and the editor on a thread, with a brush that is always at work.
void while_brushing(LongEdit& p, int round, const std::function<void()>& call) {
    const auto changes = [&] { return p.editor.state().version; };
    const auto before = changes();
    // Both values are solid, so that the hand goes on touching.
    const double value = *p.ball.isovalue + (round % 2 == 0 ? 20 : 90);
    p.editor.set_brush(
        HandBrush{.kind = BrushKind::paint, .radius = 12, .rate = 5, .value = value});
    std::jthread hand([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            p.time.step({p.servo.get()}, [&](auto now) { p.editor.step(now); });
        }
    });
    ASSERT_TRUE(support::comes_true([&] { return changes() > before; }))
        << p.editor.state().problem;
    call();
}

TEST(EditUnderWay, a_stroke_that_is_computed_while_the_brush_is_put_down_is_dropped) {
    LongEdit p("synthetic:sphere:64x64x64");
    for (int i = 0; i < 20; ++i) {
        std::uint64_t put_down = 0;
        while_brushing(p, i, [&] {
            p.editor.set_brush(std::nullopt);
            put_down = p.editor.state().version;
        });
        ASSERT_EQ(p.editor.state().version, put_down);
    }
}

TEST(EditUnderWay, a_stroke_that_is_computed_during_undo_is_dropped) {
    LongEdit p("synthetic:sphere:64x64x64");
    for (int i = 0; i < 20; ++i) {
        while_brushing(p, i, [&] {
            EXPECT_TRUE(p.editor.undo());
            std::this_thread::yield();
        });
        ASSERT_EQ(p.editor.state().version, 0U);
        ASSERT_EQ(p.editor.state().redo_steps, 1U) << "what was undone can come back";
        p.editor.set_brush(std::nullopt);
    }
}

TEST(EditUnderWay, edits_of_several_threads_are_all_made) {
    LongEdit p("synthetic:sphere:64x64x64");
    constexpr int threads = 4, each = 10;
    {
        std::vector<std::jthread> others;
        for (int t = 0; t < threads; ++t) {
            others.emplace_back([&p, t] {
                for (int i = 0; i < each; ++i) {
                    p.editor.apply(edit::Fill{{{t, i, 0}, {t, i, 63}}, 100.0 + i});
                }
            });
        }
    }
    const EditState now = p.editor.state();
    EXPECT_EQ(now.version, std::uint64_t{threads * each});
    EXPECT_EQ(now.undo_steps, std::size_t{threads * each});
    for (int t = 0; t < threads; ++t) {
        for (int i = 0; i < each; ++i) EXPECT_EQ(now.samples->sample({t, i, 40}), 100 + i);
    }
}

TEST(EditUnderWay, a_servo_that_takes_no_commands_gets_its_edits_later_and_in_order) {
    LongEdit p("synthetic:sphere:32x32x32");
    constexpr int many = 2000;  // more than a servo queues
    for (int i = 0; i < many; ++i) {
        p.editor.apply(edit::Fill{{{1, 1, 1}, {1, 1, 1}}, 1.0 + i % 2});
    }
    EXPECT_THROW(p.editor.record(*p.servo, [](const std::vector<Command>&) {}), std::runtime_error);
    std::uint64_t last = 0;
    EXPECT_TRUE(test::steps_until(
        [&] {
            p.time.step({p.servo.get()}, [&](auto now) { p.editor.step(now); });
            const std::uint64_t version = p.servo->snapshot()->session.version;
            EXPECT_GE(version, last);
            last = version;
        },
        [] { return true; }, [&] { return last == many; }));
    EXPECT_NO_THROW(p.editor.record(*p.servo, [](const std::vector<Command>&) {}));
}

}  // namespace
}  // namespace palpate::run

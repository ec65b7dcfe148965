// A brush that follows the proxy of a servo, and single edits.
#include "palpate/run/volume_editor.hpp"

#include <cmath>
#include <cstring>
#include <functional>
#include <future>
#include <optional>

#include "palpate/run/streamer.hpp"
#include "palpate/stream/store.hpp"
#include "run/run_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

/// A ball (its middle at 0), and a hand some millimetres deep in it.
struct Pressing {
    LoadedVolume ball = test::loaded("synthetic:sphere");
    Field field = linear_field(ball.volume);
    double isovalue = *ball.isovalue;
    std::optional<double> opening = std::nullopt;  // [rad] of a gripper
    support::ScriptedDevice device{[this](double) {
        DeviceReading reading = support::ready_at({-15, 0, 0});
        reading.opening = opening;
        return reading;
    }};
    VolumeEditor editor{field.shared_samples(), Pace::by_steps};
    test::Time time;
    std::unique_ptr<Servo> servo =
        editor.attach({make_renderer(field, isovalue, {}), {}}, test::servo_on(device));

    ~Pressing() {
        servo->stop();
        editor.detach(*servo);
    }

    void step(int ticks = 1) {
        for (int i = 0; i < ticks; ++i) {
            time.step({servo.get()}, [&](auto now) { editor.step(now); });
        }
    }
    template <class Condition>
    bool until(Condition&& holds) {
        return test::steps_until([&] { step(); }, [] { return true; }, holds);
    }
    Vec3 scp() const {
        const auto now = servo->snapshot();
        return now ? now->session.tick.proxy.scp : Vec3(Vec3::Constant(-1000));
    }
    bool touches() {
        return until([&] {
            const auto now = servo->snapshot();
            return now && now->session.tick.proxy.mode == Mode::constrained &&
                   now->session.tick.proxy.status == UpdateStatus::done && scp()[0] < -16;
        });
    }
    bool felt(std::uint64_t version) {
        return until([&] {
            const auto now = servo->snapshot();
            return now && now->session.version == version;
        });
    }
};
struct Touching : Pressing {
    Touching() { EXPECT_TRUE(touches()); }
};

TEST(VolumeEditor, a_brush_that_carves_lets_the_hand_through_and_leaves_what_it_does_not_touch) {
    Touching p;
    p.editor.set_brush(HandBrush{.radius = 6, .rate = 30});
    // The way is free once all in front of the hand is gone.
    EXPECT_TRUE(p.until([&] { return (p.scp() - Vec3(-15, 0, 0)).norm() < 1e-9; }));
    p.editor.set_brush({});
    const EditState work = p.editor.state();
    EXPECT_TRUE(work.changed);
    EXPECT_GT(work.version, 0U);
    EXPECT_EQ(work.samples->sample({48, 32, 32}), p.ball.volume.sample({48, 32, 32}));
    EXPECT_LT(work.samples->sample({16, 32, 32}), p.isovalue);
}

TEST(VolumeEditor, a_brush_rests_while_a_gripper_is_open) {
    Pressing p;
    p.opening = 0.4;
    ASSERT_TRUE(p.touches());
    p.editor.set_brush(HandBrush{.radius = 6, .rate = 30});
    p.step(500);
    EXPECT_EQ(p.editor.state().version, 0U);
    p.opening = 0.05;
    EXPECT_TRUE(p.until([&] { return p.editor.state().version > 0; }));
    p.opening = 0.4;
    p.step(20);
    const std::uint64_t version = p.editor.state().version;
    p.step(500);
    EXPECT_EQ(p.editor.state().version, version);
}

TEST(VolumeEditor, one_with_the_tools_shape_lets_the_tool_through_and_cuts_nothing_beside_it) {
    const LoadedVolume ball = test::loaded("synthetic:sphere");
    const Field field(ball.volume, Solid::above, {}, Interpolation::cubic);
    support::ScriptedDevice device{[](double) { return support::ready_at({-12, 0, 0}); }};
    VolumeEditor editor(field.shared_samples(), Pace::by_steps);
    test::Time time;
    const auto step = [&](Servo& servo) {
        time.step({&servo}, [&](auto now) { editor.step(now); });
    };
    RendererSettings settings;
    settings.tool = std::make_shared<const Tool>(box_tool({6, 10, 4}, 0.5));
    Session session{make_renderer(field, *ball.isovalue, settings), {}};
    const auto servo = editor.attach(std::move(session), test::servo_on(device));
    HandBrush brush = tool_brush(field.geometry());
    brush.rate = 60;
    editor.set_brush(brush);
    // The hand begins inside: recovery brings the tool out, then it works its way to the hand.
    EXPECT_TRUE(
        test::steps_until([&] { step(*servo); }, [] { return true; },
                          [&] {
                              const auto now = servo->snapshot();
                              return now && editor.state().version > 0 &&
                                     (now->session.tick.proxy.scp - Vec3(-12, 0, 0)).norm() < 1e-6;
                          }))
        << editor.state().problem << " version " << editor.state().version << ", "
        << servo->snapshot()->session.tick.proxy.scp.transpose() << ", status "
        << int(servo->snapshot()->session.tick.proxy.status);
    editor.set_brush({});
    servo->stop();
    editor.detach(*servo);
    const Volume after = flattened(*editor.state().samples);
    EXPECT_LT(value_at(linear_field(after), Vec3(-12, 0, 0)), *ball.isovalue);
    for (const Vec3& beside : {Vec3(-12, 8, 0), Vec3(-12, 0, 6), Vec3(-4, 0, 0)}) {
        EXPECT_GT(value_at(linear_field(after), beside), *ball.isovalue) << beside.transpose();
    }
}

TEST(VolumeEditor, one_that_adds_pushes_the_hand_out) {
    Touching p;
    const double before = p.scp()[0];
    p.editor.set_brush(HandBrush{.kind = BrushKind::add, .radius = 4, .rate = 30});
    EXPECT_TRUE(p.until([&] { return p.scp()[0] < before - 2; }));
}

TEST(VolumeEditor, one_that_paints_without_a_value_takes_what_adding_leaves) {
    Touching p;
    const double before = p.scp()[0];
    p.editor.set_brush(HandBrush{.kind = BrushKind::paint, .radius = 4, .rate = 30});
    EXPECT_TRUE(p.until([&] { return p.scp()[0] < before - 2; }));
    EXPECT_EQ(p.editor.state().problem, "");
}

TEST(VolumeEditor, works_only_in_contact) {
    Pressing p;
    p.editor.apply(edit::Fill{whole_box(p.field.geometry()), 0});
    ASSERT_TRUE(p.felt(1));
    p.editor.set_brush(HandBrush{.kind = BrushKind::add, .radius = 4, .rate = 1000});
    p.step(50);
    EXPECT_EQ(p.editor.state().version, 1U);
}

TEST(VolumeEditor, undo_and_redo_go_through_versions_that_the_servo_feels) {
    Pressing p;
    const auto start = p.editor.state().samples;
    p.editor.apply(edit::Fill{{{20, 20, 20}, {40, 40, 40}}, 200});
    p.editor.apply(edit::Fill{{{20, 20, 20}, {30, 30, 30}}, 0});
    ASSERT_TRUE(p.felt(2));
    EXPECT_EQ(p.editor.state().undo_steps, 2U);
    EXPECT_TRUE(p.editor.undo());
    EXPECT_TRUE(p.felt(1));
    EXPECT_TRUE(p.editor.undo());
    EXPECT_TRUE(p.felt(0));
    EXPECT_EQ(p.editor.state().samples, start);
    EXPECT_FALSE(p.editor.state().changed);
    EXPECT_FALSE(p.editor.undo());
    EXPECT_TRUE(p.editor.redo());
    EXPECT_TRUE(p.felt(1));
    // An edit after an undo: the version that was taken back does not come again.
    p.editor.apply(edit::Fill{{{1, 1, 1}, {2, 2, 2}}, 9});
    EXPECT_TRUE(p.felt(3));
    EXPECT_FALSE(p.editor.redo());
}

TEST(VolumeEditor, a_stroke_is_one_step_for_undo) {
    Touching p;
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    ASSERT_TRUE(p.until([&] { return p.editor.state().version > 20; }));
    p.editor.set_brush({});
    EXPECT_EQ(p.editor.state().undo_steps, 1U);
    EXPECT_TRUE(p.editor.undo());
    EXPECT_TRUE(p.felt(0));
}

TEST(VolumeEditor, a_brush_that_changed_nothing_for_half_a_second_begins_another_step_for_undo) {
    for (const auto& [pause, steps] : {std::pair{400, 1U}, std::pair{600, 2U}}) {
        Touching p;
        const HandBrush carving{.radius = 3, .rate = 5};
        p.editor.set_brush(carving);
        ASSERT_TRUE(p.until([&] { return p.editor.state().version > 5; }));
        p.editor.set_brush(HandBrush{.radius = 3, .rate = 5, .value = 200});  // changes nothing
        p.step(pause);
        p.editor.set_brush(carving);
        const auto before = p.editor.state().version;
        ASSERT_TRUE(p.until([&] { return p.editor.state().version > before; }));
        EXPECT_EQ(p.editor.state().undo_steps, steps) << pause << " ms";
    }
}

TEST(VolumeEditor, after_an_undo_the_brush_rests_until_it_is_taken_up_again) {
    Touching p;
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    ASSERT_TRUE(p.until([&] { return p.editor.state().version > 20; }));
    EXPECT_TRUE(p.editor.undo());
    EXPECT_TRUE(p.felt(0));
    p.step(50);
    EXPECT_EQ(p.editor.state().version, 0U);
    EXPECT_EQ(p.editor.state().redo_steps, 1U) << "what was undone can come back";
    p.editor.set_brush({});
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    EXPECT_TRUE(p.until([&] { return p.editor.state().version > 0; }));
}

TEST(VolumeEditor, after_a_change_of_the_tool_the_brush_rests_until_it_is_taken_up_again) {
    Touching p;
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    ASSERT_TRUE(p.until([&] { return p.editor.state().version > 20; }));
    EXPECT_TRUE(p.editor.undo());
    p.editor.set_brush({});
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    p.editor.rest_brush(*p.servo, std::make_shared<const Tool>(box_tool({6, 10, 4}, 0.5)));
    p.step(50);
    EXPECT_EQ(p.editor.state().undo_steps, 0U) << "a larger tool has edited what no hand touched";
    p.editor.set_brush({});
    p.editor.rest_brush(*p.servo, nullptr);
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    EXPECT_TRUE(p.until([&] { return p.editor.state().undo_steps > 0; }));
}

TEST(VolumeEditor, a_brush_that_can_do_nothing_says_why) {
    Touching p;
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5, .value = 200});  // solid: not to carve to
    EXPECT_TRUE(p.until([&] { return !p.editor.state().problem.empty(); }));
    EXPECT_EQ(p.editor.state().version, 0U);
    p.editor.set_brush(HandBrush{.radius = 3, .rate = 5});
    EXPECT_TRUE(p.until([&] { return p.editor.state().version > 0; }));
    EXPECT_EQ(p.editor.state().problem, "");
}

TEST(VolumeEditor, its_history_makes_the_same_samples_again) {
    Pressing p;
    p.editor.apply(edit::Fill{{{20, 20, 20}, {40, 40, 40}}, 200});
    p.editor.apply(
        edit::Stroke{brush_for(BrushKind::carve, p.field, p.isovalue, 5), {-20, 0, 0}, {0, 3, 5}});
    p.editor.undo();
    std::vector<Command> history;
    support::ScriptedDevice other{[](double) { return support::ready_at({-15, 0, 0}); }};
    const auto second = p.editor.attach({make_renderer(p.field, p.isovalue, {}), {}},
                                        test::servo_on(other, &history));
    second->stop();
    p.editor.detach(*second);
    Session again{make_renderer(p.field, p.isovalue, {}), {}};
    RecordedSamples samples(p.field.shared_samples());
    for (const Command& told : history) {
        EXPECT_EQ(std::get<command::Samples>(told).samples, nullptr);
        palpate::apply(again, samples.whole(told));
    }
    EXPECT_EQ(again.version, p.editor.state().version);
    const Volume felt = flattened(*p.editor.state().samples);
    const Volume made = flattened(again.renderer.field.samples());
    EXPECT_EQ(std::memcmp(felt.data(), made.data(), felt.bytes()), 0);
}

/// The history that a servo which is attached now gets.
std::vector<Command> history_of(VolumeEditor& editor, const Field& field) {
    support::ScriptedDevice device{[](double) { return support::ready_at({-15, 0, 0}); }};
    std::vector<Command> history;
    const auto servo =
        editor.attach({make_renderer(field, 0.5, {}), {}}, test::servo_on(device, &history));
    servo->stop();
    editor.detach(*servo);
    return history;
}

TEST(VolumeEditor, versions_that_nothing_leads_to_any_more_are_forgotten) {
    const Field field = linear_field(test::loaded("synthetic:sphere:32x32x32").volume);
    VolumeEditor editor(field.shared_samples(), Pace::by_steps);
    editor.apply(edit::Fill{{{1, 1, 1}, {2, 2, 2}}, 7});
    for (int i = 0; i < 5000; ++i) {
        editor.apply(edit::Fill{{{1, 1, 1}, {1, 1, 1}}, 8.0 + i % 2});
        EXPECT_TRUE(editor.undo());
    }
    const auto history = history_of(editor, field);
    EXPECT_LT(history.size(), 2500U);
    EXPECT_TRUE(editor.knows_history());
    RecordedSamples samples(field.shared_samples());
    for (const Command& told : history) (void)samples.whole(told);
    EXPECT_EQ(samples.of(editor.state().version)->sample({2, 2, 2}), 7);
    EXPECT_EQ(samples.of(editor.state().version)->sample({1, 1, 1}), 7);
}

TEST(VolumeEditor, of_too_many_edits_it_keeps_those_of_undo_and_says_that_it_forgot_the_others) {
    const Field field = linear_field(test::loaded("synthetic:sphere:32x32x32").volume);
    VolumeEditor editor(field.shared_samples(), Pace::by_steps, 100);
    for (int i = 0; i < 3000; ++i) {
        EXPECT_EQ(editor.knows_history(), i < 100);
        editor.apply(edit::Fill{{{1, 1, 1}, {1, 1, 1}}, 8.0 + i % 2});
    }
    EXPECT_EQ(editor.state().samples->sample({1, 1, 1}), 9);
    EXPECT_TRUE(editor.undo());
    EXPECT_EQ(editor.state().samples->sample({1, 1, 1}), 8);
    EXPECT_EQ(editor.state().version, 2999U);
}

TEST(VolumeEditor, edits_that_wait_for_their_turn_stop_when_asked_to) {
    Pressing p;
    p.editor.apply(edit::Fill{{{1, 1, 1}, {2, 2, 2}}, 50});
    const auto edits = [&] {
        const auto stop_at_second = [] {
            return [calls = 0](double) mutable {
                if (++calls > 1) throw stream::Cancelled{};
            };
        };
        const edit::Fill fill{{{5, 5, 5}, {6, 6, 6}}, 60};
        EXPECT_THROW(p.editor.apply(fill, stop_at_second()), stream::Cancelled);
        EXPECT_THROW(p.editor.undo(stop_at_second()), stream::Cancelled);
        EXPECT_THROW(p.editor.redo(stop_at_second()), stream::Cancelled);
    };
    const auto start = [&](const Session&, const auto&) -> std::unique_ptr<Servo> {
        std::thread(edits).join();  // which wait until this returns
        throw std::runtime_error("not started");
    };
    EXPECT_THROW(p.editor.attach({make_renderer(p.field, p.isovalue, {}), {}}, start),
                 std::runtime_error);
    EXPECT_EQ(p.editor.state().version, 1U);
}

/// A store with an editor that has room for one step of undo().
struct LittleHistory {
    support::ScratchFolder folder;
    std::optional<Streamer> streamer;
    std::unique_ptr<VolumeEditor> editor;  // on the heap, as that of LongEdit

    /// `free` deletes the first version.
    explicit LittleHistory(const std::function<void(const Samples*)>& free) {
        const std::string path = (folder / "ball.nrrd").string();
        io::write_volume(test::loaded("synthetic:sphere:64x64x64").volume, path);
        const LoadedVolume ball = load(source_from({{"volume", path}, {"level", "0"}}));
        streamer.emplace(ball, Pace::by_steps);
        std::shared_ptr<const Samples> first(new Samples(*start_samples(ball)), free);
        editor =
            std::make_unique<VolumeEditor>(std::move(first), *streamer, 480'000, Pace::by_steps);
    }
    void fill(double value) { editor->apply(edit::Fill{{{0, 0, 0}, {30, 30, 30}}, value}); }
};

TEST(VolumeEditor, frees_versions_that_undo_no_longer_leads_to_without_its_lock) {
    bool is_freed = false, was_locked = false;
    VolumeEditor* editor = nullptr;
    std::future<void> asked;
    LittleHistory p([&](const Samples* version) {
        is_freed = true;
        asked = std::async(std::launch::async, [&] { (void)editor->knows_history(); });
        was_locked = asked.wait_for(std::chrono::seconds(10)) != std::future_status::ready;
        delete version;
    });
    editor = &*p.editor;
    p.fill(11);
    editor->set_saved(editor->state().samples);
    EXPECT_FALSE(is_freed) << "undo leads to it";
    p.fill(12);
    EXPECT_EQ(editor->state().undo_steps, 1U);
    EXPECT_TRUE(is_freed);
    EXPECT_FALSE(was_locked);
}

TEST(VolumeEditor, refuses_brushes_that_cannot_work_and_says_why) {
    Pressing p;
    const double nan = std::nan("");
    EXPECT_THROW(p.editor.set_brush(HandBrush{.radius = 0}), std::invalid_argument);
    EXPECT_THROW(p.editor.set_brush(HandBrush{.radius = nan}), std::invalid_argument);
    EXPECT_THROW(p.editor.set_brush(HandBrush{.hardness = 2}), std::invalid_argument);
    EXPECT_THROW(p.editor.set_brush(HandBrush{.rate = 0}), std::invalid_argument);
    EXPECT_THROW(p.editor.apply(edit::Fill{{{0, 0, 0}, {1, 1, 1}}, nan}), std::invalid_argument);
    EXPECT_EQ(p.editor.state().version, 0U);
}

}  // namespace
}  // namespace palpate::run

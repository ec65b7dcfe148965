// Sequences that play while a servo feels them.
#include "palpate/run/player.hpp"

#include "run/run_support.hpp"
#include "support/allocation_counter.hpp"

namespace palpate::run {
namespace {

constexpr double period = 1;

/// Five frames, 0.2 s apart, each of one value: 0, 10, 20, 30, 40.
io::Sequence steps() {
    return io::made_sequence(5, 0.2, [](int frame, const io::Progress&) {
        return Volume({Index3::Constant(8)},
                      std::vector<float>(512, static_cast<float>(10 * frame)));
    });
}

struct Playing {
    io::Sequence sequence = steps();
    Field field = linear_field(io::read_frame(sequence, 0));
    support::ScriptedDevice device{[](double) { return support::ready_at({3, 3, 3}); }};
    Player player;
    std::unique_ptr<Servo> servo, second;
    test::Time time;

    explicit Playing(const io::LoaderSettings& settings = {})
        : player(sequence, settings, Pace::by_steps) {}
    ~Playing() {
        servo->stop();
        player.detach(*servo);
    }

    void start(double speed) {
        player.play(speed);
        servo = player.attach({make_renderer(field, 1000, {}), {}}, test::servo_on(device));
    }
    SessionTick now() const {
        const auto snapshot = servo->snapshot();
        return snapshot ? snapshot->session : SessionTick{};
    }
    void step() {
        const auto follow = [&](auto now) { player.step(now); };
        time.step({servo.get()}, follow);
        if (second) second->step(std::int64_t{1'000'000} * second_ticks++);
    }
    template <class Condition>
    bool until(Condition&& holds) {
        return test::steps_until([&] { step(); }, [&] { return player.is_settled(); }, holds);
    }
    bool all_loaded() {
        return until([&] { return player.state().loaded_to == player.state().end; });
    }

    int second_ticks = 0;
};

TEST(Player, plays_round_and_the_field_lies_between_the_frames) {
    Playing p;
    p.start(1);
    ASSERT_TRUE(p.all_loaded());
    ASSERT_TRUE(p.until([&] { return p.now().moment > 1.5 * period; }));
    for (int i = 0; i < 200; ++i) {
        for (int tick = 0; tick < 7; ++tick) p.step();
        const SessionTick now = p.now();
        const double into = std::fmod(now.moment, period);
        const double want = into < 0.8 ? 50 * into : 40 * (1 - (into - 0.8) / 0.2);
        EXPECT_NEAR(now.tick.proxy.density, want, 1e-4) << now.moment;
    }
    const PlayState view = p.player.state();
    EXPECT_EQ(view.frames, p.sequence.times);
    EXPECT_EQ(view.end, period);
    EXPECT_GE(view.time, 0);
    EXPECT_LT(view.time, period);
}

TEST(Player, pauses_steps_and_seeks) {
    Playing p;
    p.start(0);
    ASSERT_TRUE(p.all_loaded());
    const auto shows = [&](double density) {
        return p.until([&] { return std::abs(p.now().tick.proxy.density - density) < 1e-4; });
    };
    EXPECT_TRUE(shows(0));
    p.player.seek(0.3);
    EXPECT_TRUE(shows(15));
    p.player.step(1);
    EXPECT_TRUE(shows(20));
    p.player.step(1);
    EXPECT_TRUE(shows(30));
    p.player.step(-2);
    EXPECT_TRUE(shows(10));
    p.player.seek(0.3);
    EXPECT_TRUE(shows(15));
    p.player.step(-1);
    EXPECT_TRUE(shows(10));
    p.player.step(-2);  // round the beginning
    EXPECT_TRUE(shows(40));
    p.player.play(-1);
    EXPECT_TRUE(p.until([&] { return p.now().tick.proxy.density < 35; }));
    p.player.step(0);
    EXPECT_EQ(p.player.state().speed, 0);
    EXPECT_THROW(p.player.play(2000), std::invalid_argument);
    EXPECT_THROW(p.player.seek(std::nan("")), std::invalid_argument);
}

TEST(Player, without_a_loop_it_stops_at_the_end_and_with_one_it_goes_on) {
    Playing p({.loop = false});
    p.start(20);
    ASSERT_TRUE(p.until([&] { return p.now().moment == 0.8; }));
    EXPECT_NEAR(p.now().tick.proxy.density, 40, 1e-4);
    p.player.set_loop(true);
    EXPECT_TRUE(p.until([&] { return p.now().moment > 5; }));
    EXPECT_TRUE(p.player.state().loop);
}

TEST(Player, plays_on_as_soon_as_there_is_memory_for_the_loader) {
    Playing p({.loop = false});
    p.start(20);
    ASSERT_TRUE(p.until([&] { return p.now().moment == 0.8; }));
    {
        const support::DeniedAllocations denied(sizeof(io::FrameLoader),
                                                sizeof(io::FrameLoader) + 1);
        EXPECT_THROW(p.player.set_loop(true), std::bad_alloc);
        for (int i = 0; i < 20; ++i) p.step();
        EXPECT_FALSE(p.player.is_settled());
        p.player.seek(0.4);
        EXPECT_TRUE(p.player.state().loop);
    }
    EXPECT_TRUE(p.until([&] { return p.now().moment > 5; }));
}

TEST(Player, a_sequence_that_does_not_fit_plays_on_over_its_seam) {
    // Three of the five frames fit.
    Playing p({.memory_bytes = 3 * 512 * sizeof(float)});
    p.start(1);
    double last = 0;
    ASSERT_TRUE(p.until([&] {
        last = std::max(last, p.now().moment);
        return last > 2.5 * period;
    }));
    EXPECT_LE(p.player.state().time, period);
    p.player.seek(0.6);
    EXPECT_TRUE(p.until([&] {
        const double time = p.player.state().time;
        return time >= 0.6 && time < 0.8;
    }));
}

TEST(Player, a_session_that_begins_anew_begins_where_play_was) {
    Playing p;
    p.start(0);
    ASSERT_TRUE(p.all_loaded());
    p.player.seek(0.5);
    ASSERT_TRUE(p.until([&] { return p.now().moment == 0.5; }));
    p.servo->stop();
    p.player.detach(*p.servo);
    std::vector<Command> history;
    std::optional<Session> next;
    const auto start = test::servo_on(p.device, &history);
    p.servo = p.player.attach({make_renderer(p.field, 1000, {}), {}},
                              [&](Session session, const std::vector<Command>& told) {
                                  next = session;
                                  return start(std::move(session), told);
                              });
    EXPECT_EQ(next->renderer.field.time(), 0.5);
    // And so does one that is rendered from its recording.
    Session again{make_renderer(p.field, 1000, {}), {}};
    RecordedSamples samples(p.field.shared_samples(),
                            [&](int frame) { return io::read_frame(p.sequence, frame); });
    for (const Command& told : history) palpate::apply(again, samples.whole(told));
    EXPECT_EQ(again.renderer.field.time(), 0.5);
    EXPECT_EQ(again.renderer.field.cell({1, 1, 1}), next->renderer.field.cell({1, 1, 1}));
    EXPECT_EQ(again.version, next->version);
}

TEST(Player, two_servos_get_the_same_frames_and_moments) {
    Playing p;
    p.start(0);
    ASSERT_TRUE(p.all_loaded());
    support::ScriptedDevice other{[](double) { return support::ready_at({5, 5, 5}); }};
    p.second = p.player.attach({make_renderer(p.field, 1000, {}), {}}, test::servo_on(other));
    const auto both_at = [&](double moment, double density) {
        return p.until([&] {
            const auto now = p.second->snapshot();
            return now && now->session.moment == moment && p.now().moment == moment &&
                   std::abs(now->session.tick.proxy.density - density) < 1e-4;
        });
    };
    EXPECT_TRUE(both_at(0, 0));
    p.player.seek(0.3);
    EXPECT_TRUE(both_at(0.3, 15));
    p.second->stop();
    p.player.detach(*p.second);
    p.second.reset();
    p.player.seek(0.6);
    EXPECT_TRUE(p.until([&] { return p.now().moment == 0.6; })) << "the first goes on alone";
}

TEST(Player, goes_on_with_the_other_servo_when_the_device_of_the_first_fails) {
    bool fails = false;
    const auto still = [](double) { return support::ready_at({3, 3, 3}); };
    test::Failing device(std::make_unique<support::ScriptedDevice>(still), fails);
    support::ScriptedDevice other{still};
    Playing p;
    p.player.play(0);
    p.servo = p.player.attach({make_renderer(p.field, 1000, {}), {}}, test::servo_on(device));
    ASSERT_TRUE(p.all_loaded());
    p.second = p.player.attach({make_renderer(p.field, 1000, {}), {}}, test::servo_on(other));
    p.player.play(0.5);
    fails = true;
    const auto second_at = [&](double moment) {
        return p.until([&] {
            const auto now = p.second->snapshot();
            return now && now->session.moment >= moment && p.player.state().time >= moment;
        });
    };
    EXPECT_TRUE(second_at(0.2));
    EXPECT_EQ(p.servo->device_failure(), DeviceFailure::threw);
    for (int i = 0; i < 2000; ++i) {  // more than a servo has room for that carries out nothing
        p.player.play(0);
        if (i % 10 == 0) p.step();
    }
    p.player.play(0.5);
    EXPECT_TRUE(second_at(0.5));
    p.player.seek(0.1);
    EXPECT_TRUE(p.until([&] { return p.second->snapshot()->session.moment < 0.2; }));
    p.second->stop();
    p.player.detach(*p.second);
}

TEST(PacedPlayer, follows_a_servo_at_its_real_pace_by_itself) {
    const io::Sequence sequence = steps();
    const Field field = linear_field(io::read_frame(sequence, 0));
    support::ScriptedDevice device([](double) { return support::ready_at({3, 3, 3}); });
    Player player(sequence, {});
    player.play(5);
    const auto start = test::servo_on(device);
    const auto servo =
        player.attach({make_renderer(field, 1000, {}), {}}, [&](Session session, const auto& told) {
            auto started = start(std::move(session), told);
            started->start();
            return started;
        });
    EXPECT_TRUE(test::comes_true([&] {
        const auto now = servo->snapshot();
        return now && now->session.moment > 2 * period && player.state().loaded_to == period;
    }));
    servo->stop();
    player.detach(*servo);
}

}  // namespace
}  // namespace palpate::run

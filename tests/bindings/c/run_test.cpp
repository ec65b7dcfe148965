// Live runs through the C interface: the caller's own device, commands, edits, recordings, threads.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "palpate/io/recording.hpp"
#include "support/scratch_folder.hpp"
#include "tests/bindings/c/hand.hpp"

namespace palpate::c::test {
namespace {

TEST_F(CRun, an_own_device_serves_one_run_at_a_time) {
    const palpate_own_device own = device_of(hand_);
    ASSERT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
    palpate_run* const first = std::exchange(run_, nullptr);
    EXPECT_EQ(create(&own), PALPATE_NO_DEVICE);
    const std::string refusal = palpate_last_error();
    EXPECT_NE(refusal.find("the device 'own'"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("serves another hand"), std::string::npos) << refusal;
    EXPECT_EQ(hand_.closes, 0);
    Hand other;
    const palpate_own_device second = device_of(other);
    EXPECT_EQ(create(&second), PALPATE_OK) << palpate_last_error();
    palpate_run_destroy(std::exchange(run_, nullptr));
    palpate_run_destroy(first);
    EXPECT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
}

TEST_F(CRun, a_button_that_cannot_be_is_refused_by_name) {
    PALPATE_STRUCT(palpate_run_options, options);
    options.no_real_time = 1;
    const auto refused = [&](const std::string& words) {
        EXPECT_EQ(palpate_run_create(data_, &options, &run_), PALPATE_INVALID) << words;
        EXPECT_NE(std::string(palpate_last_error()).find(words), std::string::npos)
            << palpate_last_error();
    };
    options.clutch_button = -2;
    refused("clutch_button: a button is");
    options.clutch_button = 1;
    refused("clutch button 1: the device has 0 buttons");
    options.clutch_button = -1;  // none
    options.deadman_button = 33;
    refused("deadman_button: a button is");
    options.deadman_button = 0;
    EXPECT_EQ(palpate_run_create(data_, &options, &run_), PALPATE_OK) << palpate_last_error();
}

TEST_F(CRun, an_own_device_feels_the_ball_within_its_limit_on_a_thread_of_its_own) {
    start(device_of(hand_));
    EXPECT_TRUE(comes_true([&] { return hand_.force > 1.5; }));
    EXPECT_LE(hand_.largest, 2.0 + 1e-9);
    EXPECT_NE(hand_.thread.load(), std::this_thread::get_id());
    const palpate_snapshot felt = now();
    EXPECT_EQ(felt.felt.mode, PALPATE_CONSTRAINED);
    EXPECT_NEAR(std::hypot(felt.felt.scp[0], felt.felt.scp[1], felt.felt.scp[2]), 20, 0.2);
    ASSERT_EQ(palpate_run_stop(run_), PALPATE_OK);
    EXPECT_TRUE(comes_true([&] { return hand_.force == 0; }));
    palpate_run_destroy(run_);
    run_ = nullptr;
    EXPECT_EQ(hand_.closes, 1);
    EXPECT_EQ(hand_.force, 0);
}

TEST_F(CRun, the_opening_of_an_own_gripper_shows_in_snapshots) {
    for (const bool has : {false, true}) {
        palpate_own_device own = device_of(hand_);
        own.has_gripper = has;
        start(own);
        EXPECT_TRUE(shows([&](const palpate_snapshot& now) {
            return now.device_status == PALPATE_DEVICE_READY &&
                   (has ? now.opening == 0.25 : std::isnan(now.opening));
        }));
        palpate_run_destroy(run_);
        run_ = nullptr;
    }
}

TEST_F(CRun, stopping_returns_when_a_slow_device_has_the_zero) {
    palpate_own_device own = device_of(hand_);
    own.rate = 100;
    hand_.step = -0.25;
    start(own);
    EXPECT_TRUE(comes_true([&] { return hand_.force > 0.5; }));
    ASSERT_EQ(palpate_run_stop(run_), PALPATE_OK);
    EXPECT_EQ(hand_.force, 0);
    EXPECT_EQ(palpate_run_stop(run_), PALPATE_OK);
    EXPECT_EQ(palpate_run_use_device(run_, "simulated:hand=press"), PALPATE_WRONG_STATE);
    EXPECT_NE(std::string(palpate_last_error()).find("stopped for good"), std::string::npos);
}

TEST_F(CRun, a_stop_that_comes_before_the_start_holds) {
    const palpate_own_device own = device_of(hand_);
    ASSERT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_stop(run_), PALPATE_OK);
    EXPECT_EQ(palpate_run_start(run_), PALPATE_WRONG_STATE);
    EXPECT_EQ(hand_.force, 0);
}

TEST_F(CRun, stopping_waits_for_no_callback_that_asks_for_the_run) {
    start(device_of(hand_));
    EXPECT_TRUE(comes_true([&] { return hand_.force > 0.5; }));
    hand_.asked = run_;
    ASSERT_EQ(palpate_run_stop(run_), PALPATE_OK);
    hand_.asked = nullptr;
    EXPECT_TRUE(hand_.refused) << "it would wait for the stop, which waits for it";
    EXPECT_EQ(hand_.force, 0);
}

TEST_F(CRun, the_progress_of_a_call_does_not_wait_for_the_run_of_that_call) {
    start(device_of(hand_));
    const auto ask = [](double, void* context) {
        PALPATE_STRUCT(palpate_snapshot, snapshot);
        auto* const run = static_cast<palpate_run*>(context);
        EXPECT_EQ(palpate_run_snapshot(run, &snapshot), PALPATE_WRONG_STATE);
        return 0;
    };
    palpate_set_progress(ask, run_);
    EXPECT_EQ(palpate_run_use_device(run_, "mouse"), PALPATE_CANCELLED);
    palpate_set_progress(nullptr, nullptr);
}

TEST_F(CRun, what_is_set_by_any_name_is_what_the_run_has_and_renders) {
    const palpate_own_device own = device_of(hand_);
    ASSERT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_lift(run_), PALPATE_WRONG_STATE);
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK) << palpate_last_error();
    ASSERT_EQ(palpate_run_set_friction(run_, 0.5, 0.25), PALPATE_OK);
    for (std::size_t i = 0; i < palpate_setting_count(); ++i) {
        PALPATE_STRUCT(palpate_setting, one);
        ASSERT_EQ(palpate_setting_describe(i, &one), PALPATE_OK);
        double before = NAN, after = NAN;
        ASSERT_EQ(palpate_run_get(run_, one.name, &before), PALPATE_OK) << palpate_last_error();
        const std::string name = one.name;
        if (name == "limits.delay") {  // only rises
            EXPECT_EQ(palpate_run_set(run_, one.name, before - 1e-4), PALPATE_INVALID);
        } else if (name.starts_with("limits.")) {  // only falls
            if (std::isfinite(before)) {
                EXPECT_EQ(palpate_run_set(run_, one.name, before + 1), PALPATE_INVALID) << name;
            }
            if (before == 0) continue;
        }
        const double other = before == 0 ? 1e-4 : 0.9 * before;
        const double wanted = !std::isfinite(before)            ? 7
                              : name == "limits.delay"          ? before + 1e-4
                              : name == "force.magnet.distance" ? 1
                                                                : other;
        ASSERT_EQ(palpate_run_set(run_, one.name, wanted), PALPATE_OK) << palpate_last_error();
        ASSERT_EQ(palpate_run_get(run_, one.name, &after), PALPATE_OK);
        EXPECT_EQ(after, wanted) << one.name;
    }
    ASSERT_EQ(palpate_run_set_stiffness(run_, 0.375), PALPATE_OK) << palpate_last_error();
    EXPECT_TRUE(shows([](const auto& s) { return s.stiffness == 0.375; }));
    EXPECT_EQ(palpate_run_set(run_, "force.colour", 1), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_lift(run_), PALPATE_OK) << palpate_last_error();
}

TEST_F(CRun, layers_that_are_the_same_surfaces_are_sent_as_such) {
    palpate_own_device own = device_of(hand_);
    ASSERT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_change_layers(run_, "ct-needle"), PALPATE_WRONG_STATE);
    const support::ScratchFolder folder;
    const auto file = folder.path() / "session.csv";
    ASSERT_EQ(palpate_run_record(run_, file.string().c_str()), PALPATE_OK) << palpate_last_error();
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_set_layers(run_, "ct-needle"), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_change_layers(run_, "ct-needle"), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_change_layers(run_, "no-such-set"), PALPATE_INPUT);
    const std::int64_t sent = now().number;
    EXPECT_TRUE(shows([&](const auto& s) { return s.number > sent + 5; }));
    ASSERT_EQ(palpate_run_stop_recording(run_, nullptr), PALPATE_OK) << palpate_last_error();
    std::vector<bool> same;
    for (io::RecordingReader reader(file); const auto event = reader.next();) {
        const auto* sent_command = std::get_if<Command>(&*event);
        if (!sent_command) continue;
        if (const auto* use = std::get_if<command::UseLayers>(sent_command)) {
            same.push_back(use->same_surfaces);
        }
    }
    EXPECT_EQ(same, (std::vector<bool>{false, true}));
}

TEST_F(CRun, a_device_that_reports_it_is_lost_gives_no_force_and_says_so_and_may_come_back) {
    const palpate_own_device own = device_of(hand_);
    ASSERT_EQ(create(&own), PALPATE_OK);
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    ASSERT_TRUE(comes_true([&] { return hand_.force > 1; }));
    hand_.lost = true;
    EXPECT_TRUE(comes_true([&] { return hand_.force == 0; }));
    EXPECT_TRUE(shows([](const auto& s) { return s.device_status == PALPATE_DEVICE_LOST; }));
    std::array<char, 200> text{};
    size_t needed = 0;
    ASSERT_EQ(palpate_run_text(run_, PALPATE_TEXT_PROBLEM, text.data(), text.size(), &needed),
              PALPATE_OK);
    EXPECT_NE(std::string(text.data()).find("lost"), std::string::npos);
    EXPECT_EQ(needed, std::string(text.data()).size() + 1);
    hand_.lost = false;
    EXPECT_TRUE(shows([](const auto& s) { return s.device_status == PALPATE_DEVICE_READY; }));
}

TEST_F(CRun, devices_that_cannot_be_are_refused) {
    palpate_own_device own = device_of(hand_);
    own.maximum_force = 0;
    EXPECT_EQ(create(&own), PALPATE_INVALID);
    own = device_of(hand_);
    own.read = nullptr;
    EXPECT_EQ(create(&own), PALPATE_INVALID);
    own = device_of(hand_);
    own.rate = NAN;
    EXPECT_EQ(create(&own), PALPATE_INVALID);
    for (const double stiffness : {-1.0, double{NAN}, double{INFINITY}}) {
        own = device_of(hand_);
        own.stiffness = stiffness;
        EXPECT_EQ(create(&own), PALPATE_INVALID);
        EXPECT_NE(std::string(palpate_last_error()).find("own.stiffness"), std::string::npos);
    }
    EXPECT_EQ(hand_.closes, 0);
    EXPECT_EQ(create(nullptr, "nothing-of-this-name"), PALPATE_INVALID);
    EXPECT_EQ(create(nullptr, "forcedimension:library=/nowhere/libdhd.so.3"), PALPATE_NO_DEVICE);
    EXPECT_EQ(run_, nullptr);
}

TEST_F(CRun, an_own_device_is_found_under_any_name) {
    palpate_own_device own = device_of(hand_);
    own.name = "mein Ger\u00e4t: 2, links=1";
    ASSERT_EQ(create(&own, own.name), PALPATE_OK) << palpate_last_error();
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    EXPECT_EQ(palpate_run_use_device(run_, own.name), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(hand_.closes, 1);
    EXPECT_EQ(palpate_run_use_device(run_, "simulated:hand=hold"), PALPATE_OK);
    EXPECT_EQ(palpate_run_use_device(run_, own.name), PALPATE_OK) << palpate_last_error();
    EXPECT_EQ(palpate_run_use_device(run_, "nothing: 2"), PALPATE_INVALID);
}

TEST_F(CRun, that_has_stopped_takes_no_commands_and_records_nothing) {
    const support::ScratchFolder folder;
    ASSERT_EQ(create(nullptr, "simulated:touchx,hand=hold"), PALPATE_OK) << palpate_last_error();
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    ASSERT_TRUE(shows([](const auto& s) { return s.felt.isovalue == 100; }));
    ASSERT_EQ(palpate_run_stop(run_), PALPATE_OK);
    EXPECT_EQ(palpate_run_set_isovalue(run_, 90), PALPATE_WRONG_STATE);
    EXPECT_EQ(palpate_run_lift(run_), PALPATE_WRONG_STATE);
    EXPECT_EQ(palpate_run_record(run_, (folder / "r.csv").string().c_str()), PALPATE_WRONG_STATE);
    EXPECT_FALSE(std::filesystem::exists(folder / "r.csv"));
    EXPECT_EQ(now().felt.isovalue, 100);
}

TEST_F(CRun, refuses_an_isovalue_beside_ranges) {
    const std::array<double, 2> ranges{50, 120};
    PALPATE_STRUCT(palpate_render_options, render);
    render.ranges = ranges.data();
    render.range_count = 1;
    PALPATE_STRUCT(palpate_run_options, options);
    options.render = &render;
    options.no_real_time = 1;
    EXPECT_EQ(palpate_run_create(data_, &options, &run_), PALPATE_OK) << palpate_last_error();
    palpate_run_destroy(std::exchange(run_, nullptr));
    render.has_isovalue = 1;
    render.isovalue = 100;
    EXPECT_EQ(palpate_run_create(data_, &options, &run_), PALPATE_INVALID);
    EXPECT_NE(std::string(palpate_last_error()).find("isovalue does nothing"), std::string::npos);
}

TEST_F(CRun, commands_show_in_snapshots) {
    ASSERT_EQ(create(nullptr, "simulated:touchx,hand=hold"), PALPATE_OK) << palpate_last_error();
    PALPATE_STRUCT(palpate_snapshot, none);
    EXPECT_EQ(palpate_run_snapshot(run_, &none), PALPATE_WRONG_STATE);
    EXPECT_EQ(palpate_run_set_isovalue(run_, 90), PALPATE_WRONG_STATE);
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    EXPECT_EQ(palpate_run_start(run_), PALPATE_WRONG_STATE);
    EXPECT_EQ(palpate_run_set_isovalue(run_, 90), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.felt.isovalue == 90; }));
    EXPECT_EQ(palpate_run_set_isovalue(run_, NAN), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set_stiffness(run_, 0.3), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.stiffness == 0.3; }));
    EXPECT_EQ(palpate_run_set_forces(run_, 0), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.forces_on == 0; }));
    EXPECT_EQ(palpate_run_set_frozen(run_, 1), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.frozen == 1; }));
    EXPECT_EQ(palpate_run_set_scale(run_, 0.5), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.transform.scale == 0.5; }));
    EXPECT_EQ(palpate_run_set_friction(run_, 0.3, 0.2), PALPATE_OK);
    EXPECT_EQ(palpate_run_set_penetration(run_, 1), PALPATE_OK);
    EXPECT_EQ(palpate_run_set_penetration(run_, -1), PALPATE_INVALID);
    const std::array<double, 4> ranges{95, 110, 150, 160};
    EXPECT_EQ(palpate_run_set_ranges(run_, 1, ranges.data(), 2), PALPATE_OK);
    EXPECT_EQ(palpate_run_set_ranges(run_, 1, ranges.data(), 0), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set_ranges(run_, 1, ranges.data(), 17), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set_ranges(run_, 1, nullptr, 2), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set_penetration(run_, 0), PALPATE_OK);
    EXPECT_EQ(palpate_run_set_tool(run_, "sphere:5"), PALPATE_OK);
    EXPECT_EQ(palpate_run_set_tool(run_, "no-such-tool"), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set_layers(run_, "no-such-set"), PALPATE_INPUT);
    EXPECT_EQ(palpate_run_use_device(run_, "mouse"), PALPATE_OK) << palpate_last_error();
    const std::array<double, 3> aim{0, 0, 30};
    EXPECT_EQ(palpate_run_aim(run_, aim.data()), PALPATE_OK);
    PALPATE_STRUCT(palpate_report, report);
    EXPECT_TRUE(comes_true(
        [&] { return palpate_run_report(run_, &report) == PALPATE_OK && report.ticks > 10; }));
}

TEST_F(CRun, edits_are_felt_undone_and_seen_in_a_field) {
    ASSERT_EQ(create(nullptr, "simulated:touchx,hand=hold"), PALPATE_OK);
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    const std::array<double, 3> origin{0, 0, 0};
    double before = 0, after = 0;
    const auto density = [&](double& into) {
        palpate_field* field = nullptr;
        ASSERT_EQ(palpate_data_field(data_, nullptr, &field), PALPATE_OK);
        palpate_field_values(field, origin.data(), 1, &into, nullptr);
        palpate_field_destroy(field);
    };
    density(before);
    PALPATE_STRUCT(palpate_brush, brush);
    brush.kind = PALPATE_CARVE;
    brush.radius = 5;
    brush.level = 100;
    ASSERT_EQ(palpate_data_stroke(data_, &brush, origin.data(), origin.data()), PALPATE_OK)
        << palpate_last_error();
    density(after);
    EXPECT_LT(after, before - 50);
    EXPECT_TRUE(shows([](const auto& s) { return s.version == 1; }));
    int32_t done = 0;
    ASSERT_EQ(palpate_data_undo(data_, &done), PALPATE_OK);
    EXPECT_EQ(done, 1);
    density(after);
    EXPECT_EQ(after, before);
    PALPATE_STRUCT(palpate_edit_state, state);
    ASSERT_EQ(palpate_data_edits(data_, &state), PALPATE_OK);
    EXPECT_EQ(state.redo_steps, 1U);
    ASSERT_EQ(palpate_data_undo(data_, &done), PALPATE_OK);
    EXPECT_EQ(done, 0);
    brush.radius = -1;
    EXPECT_EQ(palpate_data_stroke(data_, &brush, origin.data(), origin.data()), PALPATE_INVALID);
    brush.radius = 5;
    for (const double rate : {double{NAN}, -1.0}) {
        brush.rate = rate;
        EXPECT_EQ(palpate_data_stroke(data_, &brush, origin.data(), origin.data()),
                  PALPATE_INVALID);
        EXPECT_NE(std::string(palpate_last_error()).find("rate of the brush"), std::string::npos);
    }
    EXPECT_EQ(palpate_data_play(data_, 1), PALPATE_INVALID);
}

TEST_F(CRun, a_recording_is_written_and_an_existing_file_is_left_alone) {
    const support::ScratchFolder folder;
    const std::string path = (folder.path() / "run.csv").string();
    ASSERT_EQ(create(nullptr, "simulated:touchx,hand=hold"), PALPATE_OK);
    ASSERT_EQ(palpate_run_record(run_, path.c_str()), PALPATE_OK) << palpate_last_error();
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.number > 100; }));
    int64_t ticks = 0;
    ASSERT_EQ(palpate_run_stop_recording(run_, &ticks), PALPATE_OK);
    EXPECT_GT(ticks, 100);
    EXPECT_GT(std::filesystem::file_size(path), 10'000U);
    EXPECT_EQ(palpate_run_record(run_, path.c_str()), PALPATE_OUTPUT);
}

TEST_F(CRun, whose_program_cancels_it_is_not_made) {
    PALPATE_STRUCT(palpate_run_options, options);
    options.device = "mouse";
    int calls = 0;
    options.progress = [](double, void* counted) { return ++*static_cast<int*>(counted) * 0; };
    options.context = &calls;
    EXPECT_EQ(palpate_run_create(data_, &options, &run_), PALPATE_CANCELLED);
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(run_, nullptr);
}

TEST_F(CRun, recording_can_be_cancelled_while_the_volume_is_read_and_begins_again) {
    PALPATE_STRUCT(palpate_geometry, grid);
    for (std::int32_t& size : grid.size) size = 200;
    std::vector<unsigned char> samples(std::size_t{200} * 200 * 200);
    samples.back() = 200;
    palpate_volume* volume = nullptr;
    ASSERT_EQ(palpate_volume_copy(&grid, PALPATE_UINT8, samples.data(), samples.size(), &volume),
              PALPATE_OK);
    palpate_data_destroy(std::exchange(data_, nullptr));
    ASSERT_EQ(palpate_data_create(volume, &data_), PALPATE_OK);
    palpate_volume_destroy(volume);
    ASSERT_EQ(create(nullptr, "mouse"), PALPATE_OK);
    const support::ScratchFolder folder;
    const std::string path = (folder.path() / "r.csv").string();
    int calls = 0;
    palpate_set_progress([](double, void* counted) { return ++*static_cast<int*>(counted) * 0; },
                         &calls);
    EXPECT_EQ(palpate_run_record(run_, path.c_str()), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_run_record_together(&run_, 1, path.c_str()), PALPATE_CANCELLED);
    EXPECT_EQ(calls, 2) << "once each";
    palpate_set_progress(nullptr, nullptr);
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_EQ(palpate_run_record(run_, path.c_str()), PALPATE_OK) << palpate_last_error();
}

TEST_F(CRun, two_on_the_same_data_are_recorded_together_and_one_goes_on_without_the_other) {
    const support::ScratchFolder folder;
    const std::string path = (folder.path() / "both.csv").string();
    ASSERT_EQ(create(nullptr, "simulated:omega6,hand=hold"), PALPATE_OK);
    palpate_run* const first = std::exchange(run_, nullptr);
    ASSERT_EQ(create(nullptr, "simulated:touchx,hand=hold"), PALPATE_OK);
    const std::array runs{first, run_}, twice{first, first};
    EXPECT_EQ(palpate_run_record_together(nullptr, 2, path.c_str()), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_record_together(runs.data(), 0, path.c_str()), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_record_together(twice.data(), 2, path.c_str()), PALPATE_INVALID);
    ASSERT_EQ(palpate_run_record_together(runs.data(), 2, path.c_str()), PALPATE_OK)
        << palpate_last_error();
    ASSERT_EQ(palpate_run_start(first), PALPATE_OK);
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    EXPECT_TRUE(shows([](const auto& s) { return s.number > 100; }));
    palpate_run_destroy(first);
    const std::int64_t then = now().number;
    EXPECT_TRUE(shows([&](const auto& s) { return s.number > then + 50; }));
    ASSERT_EQ(palpate_run_stop_recording(run_, nullptr), PALPATE_OK);
    for (const int hand : {1, 2}) {
        io::RecordingReader reader(path, hand);
        EXPECT_EQ(reader.hands(), 2);
        std::int64_t events = 0;
        while (reader.next()) ++events;
        EXPECT_GT(events, hand == 1 ? 0 : 150);
        EXPECT_TRUE(reader.complete());
    }
}

TEST_F(CRun, one_run_may_be_watched_and_commanded_from_two_threads_each_with_its_own_errors) {
    ASSERT_EQ(create(nullptr, "simulated:touchx,hand=hold"), PALPATE_OK);
    ASSERT_EQ(palpate_run_start(run_), PALPATE_OK);
    std::atomic<int> wrong{0};
    std::thread watcher([&] {
        for (int i = 0; i < 300; ++i) {
            PALPATE_STRUCT(palpate_snapshot, snapshot);
            const palpate_status status = palpate_run_snapshot(run_, &snapshot);
            if (status == PALPATE_OK && *palpate_last_error() != '\0') ++wrong;
            if (status != PALPATE_OK && status != PALPATE_NOTHING_YET) ++wrong;
        }
    });
    for (int i = 0; i < 300; ++i) {
        const palpate_status status = palpate_run_set_isovalue(run_, i % 2 ? NAN : 80 + i % 7);
        if (i % 2) {
            EXPECT_EQ(status, PALPATE_INVALID);
            EXPECT_STRNE(palpate_last_error(), "");
        } else {
            EXPECT_TRUE(status == PALPATE_OK || status == PALPATE_QUEUE_FULL);
        }
    }
    watcher.join();
    EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace palpate::c::test

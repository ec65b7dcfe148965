// A file played back as a device.
#include "devices/recorded/recorded.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "devices/timed_path.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/allocation_counter.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

using support::contains;
using support::message_of;
using support::Random;

const scenes::Scene& sphere() {
    static const scenes::Scene scene = scenes::make_volume("sphere:8x8x8");
    return scene;
}

/// Turned, moved and scaled, so that nothing comes out right by luck.
DeviceTransform somewhere() {
    DeviceTransform transform;
    transform.rotation << 0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6;
    transform.translation = {7, -11, 13};
    transform.scale = 0.37;
    return transform;
}

class Recorded : public testing::Test {
  protected:
    /// A device that plays this text; further options begin with a comma.
    std::unique_ptr<Device> play(const std::string& text, const std::string& options = "") {
        support::put_bytes(folder_ / "hand.csv", text);
        return open((folder_ / "hand.csv").string() + options);
    }
    std::unique_ptr<Device> open(const std::string& options) {
        const DeviceScene scene{field_, sphere().isovalue, 1000,
                                [](const DeviceInfo&) { return somewhere(); }};
        return open_recorded(parse_device("recorded:" + options), scene);
    }
    std::string refusal(const std::string& text) {
        return message_of<io::InputError>([&] { play(text); });
    }

    support::ScratchFolder folder_;
    Field field_ = linear_field(sphere().volume);
};

const std::string line = "t,x,y,z\n0,1,2,3\n1,11,2,3\n3,11,2,-17\n";

TEST_F(Recorded, is_always_found) {
    EXPECT_TRUE(find_recorded().found);
    EXPECT_EQ(find_recorded().name, "recorded");
}

TEST_F(Recorded, physical_positions_come_back_through_the_transform) {
    const auto device = play(line);
    const auto physical = [&](double time) {
        return physical_from_device(somewhere(), device->read(time).position);
    };
    EXPECT_LE((physical(0) - Vec3(1, 2, 3)).norm(), 1e-12);
    EXPECT_LE((physical(0.25) - Vec3(3.5, 2, 3)).norm(), 1e-12);
    EXPECT_LE((physical(1) - Vec3(11, 2, 3)).norm(), 1e-12);
    EXPECT_LE((physical(2.5) - Vec3(11, 2, -12)).norm(), 1e-12);
    EXPECT_LE((physical(3) - Vec3(11, 2, -17)).norm(), 1e-12);
    EXPECT_LE((physical(4) - Vec3(11, 2, -17)).norm(), 1e-12);
}

TEST_F(Recorded, a_trace_is_played_by_its_hip) {
    const auto device = play("t,hip_x,hip_y,hip_z,scp_x\n0,1,2,3,9\n1,3,2,1,9\n");
    device->read(0);
    EXPECT_LE(
        (physical_from_device(somewhere(), device->read(0.5).position) - Vec3(2, 2, 2)).norm(),
        1e-12);
}

TEST_F(Recorded, what_the_device_told_is_played_bit_for_bit_at_the_recorded_times) {
    Random random(11);
    std::string text = "# a recording\nt,device_x,device_y,device_z,buttons,hip_x,hip_y,hip_z\n";
    std::vector<double> times;
    std::vector<Vec3> positions;
    for (int i = 0; i < 500; ++i) {
        times.push_back((i + (i % 5 == 0 ? 0.3 : 0)) / 1000);
        positions.push_back(random.point(-90, 90));
        char row[200];
        std::snprintf(row, sizeof row, "%.17g,%.17g,%.17g,%.17g,%d,0,0,0\n", times.back(),
                      positions.back()[0], positions.back()[1], positions.back()[2], i % 8);
        text += row;
    }
    const auto device = play(text);
    EXPECT_EQ(device->info().buttons, 3);
    for (std::size_t i = 0; i < times.size(); ++i) {
        const DeviceReading reading = device->read(times[i]);
        ASSERT_EQ(reading.position, positions[i]) << i;
        ASSERT_EQ(reading.buttons, i % 8);
        ASSERT_EQ(reading.status, DeviceStatus::ready);
        ASSERT_EQ(reading.age, 0);
    }
}

TEST_F(Recorded, a_button_is_held_from_its_row_to_the_next) {
    const auto device =
        play("t,device_x,device_y,device_z,buttons\n0,0,0,0,0\n1,0,0,0,2\n2,0,0,0,0\n");
    EXPECT_EQ(device->read(0).buttons, 0U);
    EXPECT_EQ(device->read(0.999).buttons, 0U);
    EXPECT_EQ(device->read(1).buttons, 2U);
    EXPECT_EQ(device->read(1.999).buttons, 2U);
    EXPECT_EQ(device->read(2).buttons, 0U);
    EXPECT_EQ(play("t,device_x,device_y,device_z\n0,1,2,3\n")->info().buttons, 0);
}

TEST_F(Recorded, a_gripper_opens_as_it_did) {
    const auto device =
        play("t,device_x,device_y,device_z,opening\n0,0,0,0,nan\n1,0,0,0,0.25\n2,0,0,0,0\n");
    EXPECT_TRUE(device->info().has_gripper);
    EXPECT_EQ(device->read(0).opening, std::nullopt);
    EXPECT_EQ(device->read(1).opening, 0.25);
    EXPECT_EQ(device->read(2).opening, 0);
    const auto none = play("t,device_x,device_y,device_z,opening\n0,0,0,0,nan\n");
    EXPECT_FALSE(none->info().has_gripper);
}

TEST_F(Recorded, plays_status_age_and_tool_of_a_real_recording_row_by_row) {
    io::RecordingHead head;
    head.version = "test";
    head.volume = io::identify(field_.volume(), {{"volume", "synthetic:sphere:8x8x8"}});
    head.rate = 1000;
    head.settings.transform = somewhere();  // the device lies as it did then
    std::vector<DeviceReading> told;
    Random random(3);
    for (int i = 0; i < 7; ++i) {
        DeviceReading reading;
        reading.status = static_cast<DeviceStatus>(i);
        reading.position = random.point(-50, 50);
        reading.age = 1e-3 * i;
        reading.buttons = 1U << i;
        if (i == 3) reading.orientation << 0, 1, 0, -1, 0, 0, 0, 0, 1;
        if (i == 4) reading.position[1] = std::nan("");
        told.push_back(reading);
    }
    {
        io::RecordingWriter writer(folder_ / "session.csv", head);
        for (std::size_t i = 0; i < told.size(); ++i) {
            SessionTick tick;
            tick.tick.time = static_cast<double>(i) / 1000;
            tick.device = told[i];
            ASSERT_TRUE(writer.queue().push(tick));
        }
        writer.finish(0);
    }
    const auto device = open((folder_ / "session.csv").string());
    EXPECT_TRUE(device->info().has_orientation);
    EXPECT_EQ(device->info().buttons, 7);
    for (std::size_t i = 0; i < told.size(); ++i) {
        const DeviceReading reading = device->read(static_cast<double>(i) / 1000);
        EXPECT_EQ(reading.status, told[i].status);
        EXPECT_EQ(reading.buttons, told[i].buttons);
        EXPECT_EQ(reading.age, told[i].age);
        EXPECT_EQ(reading.orientation, told[i].orientation);
        EXPECT_EQ(reading.position[0], told[i].position[0]);
        EXPECT_EQ(std::isnan(reading.position[1]), i == 4);
    }
}

TEST_F(Recorded, a_recording_takes_the_same_way_through_the_volume_wherever_the_device_lies) {
    io::RecordingHead head;
    head.version = "test";
    head.volume = io::identify(field_.volume(), {{"volume", "synthetic:sphere:8x8x8"}});
    head.settings.transform.translation = {1, 2, 3};
    head.settings.transform.scale = 2.5;
    SessionTick tick;
    tick.device.status = DeviceStatus::ready;
    tick.device.position = {10, -20, 30};
    tick.device.orientation << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    {
        io::RecordingWriter writer(folder_ / "session.csv", head);
        ASSERT_TRUE(writer.queue().push(tick));
        writer.finish(0);
    }
    const DeviceReading reading = open((folder_ / "session.csv").string())->read(0);
    const Vec3 then = physical_from_device(head.settings.transform, tick.device.position);
    EXPECT_LT((physical_from_device(somewhere(), reading.position) - then).norm(), 1e-9);
    const Mat3 tool = somewhere().rotation * reading.orientation;
    EXPECT_LT((tool - tick.device.orientation).norm(), 1e-9);
}

TEST_F(Recorded, a_recording_that_was_cut_off_is_played_to_its_last_whole_line) {
    const std::string head = "t,device_x,device_y,device_z\n0,1,2,3\n1,2,2,3\n";
    for (const char* torn : {"2,", "2,9,9", "2,3,2,3"}) {
        const auto device = play(head + torn);
        device->read(0);
        EXPECT_EQ(device->read(1).status, DeviceStatus::ready);
        EXPECT_EQ(device->read(1.1).status, DeviceStatus::finished) << torn;
        EXPECT_EQ(device->read(1.1).position, Vec3(2, 2, 3));
    }
}

TEST_F(Recorded, begins_with_its_first_row_whatever_the_sessions_time) {
    const auto device = play("t,device_x,device_y,device_z\n100,1,2,3\n101,2,2,3\n");
    EXPECT_EQ(device->read(7).position, Vec3(1, 2, 3));
    EXPECT_NEAR(device->read(7.5).position[0], 1.5, 1e-9);
}

TEST_F(Recorded, is_finished_after_its_last_row) {
    const auto device = play(line);
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
    EXPECT_EQ(device->read(3).status, DeviceStatus::ready);
    EXPECT_EQ(device->read(3.001).status, DeviceStatus::finished);
    EXPECT_EQ(device->read(1e9).status, DeviceStatus::finished);
}

TEST_F(Recorded, plays_faster_or_slower) {
    const auto fast = play(line, ",speed=2");
    const auto slow = play(line, ",speed=0.5");
    const auto normal = play(line);
    for (const auto& device : {&fast, &slow, &normal}) (*device)->read(0);
    const Vec3 there = normal->read(0.5).position;
    EXPECT_LE((fast->read(0.25).position - there).norm(), 1e-12);
    EXPECT_LE((slow->read(1).position - there).norm(), 1e-12);
    EXPECT_EQ(fast->read(1.51).status, DeviceStatus::finished);
}

TEST_F(Recorded, a_loop_goes_there_and_back_for_ever) {
    const auto device = play(line, ",loop=yes");
    Vec3 last = device->read(0).position;
    for (int i = 1; i <= 20000; ++i) {
        const DeviceReading reading = device->read(i / 1000.0);
        ASSERT_EQ(reading.status, DeviceStatus::ready);
        ASSERT_LE((reading.position - last).norm(), 1.001e-3 * 10 / somewhere().scale);
        last = reading.position;
    }
    const auto physical = [&](double time) {
        return physical_from_device(somewhere(), device->read(time).position);
    };
    EXPECT_LE((physical(21) - Vec3(11, 2, -17)).norm(), 1e-9);
    EXPECT_LE((physical(23) - Vec3(11, 2, 3)).norm(), 1e-9);
    EXPECT_LE((physical(24) - Vec3(1, 2, 3)).norm(), 1e-9);
}

TEST_F(Recorded, one_row_is_a_hand_that_stands_still) {
    const auto device = play("t,device_x,device_y,device_z\n5,1,2,3\n", ",loop=yes");
    EXPECT_EQ(device->read(0).position, Vec3(1, 2, 3));
    EXPECT_EQ(device->read(10).position, Vec3(1, 2, 3));
    EXPECT_EQ(device->read(10).status, DeviceStatus::ready);
}

TEST_F(Recorded, takes_any_force_and_is_not_moved_by_it) {
    const auto pushed = play(line), left = play(line);
    EXPECT_TRUE(pushed->info().renders_force);
    ForceSettings force;
    force.stiffness = 1000;
    force.limit = 1000;
    EXPECT_NO_THROW(check(force, pushed->info().limits));
    for (int i = 0; i < 100; ++i) {
        ASSERT_EQ(pushed->read(i / 1000.0).position, left->read(i / 1000.0).position);
        pushed->write({Vec3::Constant(i % 2 == 0 ? 1e9 : std::nan(""))}, i / 1000.0);
    }
    pushed->stop();
    EXPECT_EQ(pushed->read(0.2).position, left->read(0.2).position);
}

TEST_F(Recorded, a_time_that_is_not_finite_moves_nothing) {
    const auto device = play(line);
    device->read(0);
    const Vec3 there = device->read(0.5).position;
    EXPECT_EQ(device->read(std::numeric_limits<double>::quiet_NaN()).position, there);
    EXPECT_EQ(device->read(std::numeric_limits<double>::infinity()).position, there);
}

TEST_F(Recorded, the_workspace_is_a_cube_of_160_mm) {
    const DeviceInfo info = play(line)->info();
    EXPECT_EQ(info.workspace_low, Vec3::Constant(-80));
    EXPECT_EQ(info.workspace_high, Vec3::Constant(80));
    EXPECT_EQ(info.limits.rate, 1000);
    EXPECT_TRUE(contains(info.model, "hand.csv"));
}

TEST_F(Recorded, reads_and_writes_allocate_nothing) {
    const auto device = play(line, ",loop=yes");
    const std::int64_t before = support::allocation_count();
    for (int i = 0; i < 10000; ++i) {
        device->read(i / 1000.0);
        device->write({Vec3(1, 2, 3)}, i / 1000.0);
    }
    EXPECT_EQ(support::allocation_count(), before);
}

TEST_F(Recorded, files_that_cannot_be_played_are_refused_with_name_and_line) {
    const std::string head = "t,device_x,device_y,device_z,buttons\n";
    EXPECT_TRUE(contains(refusal(head + "0,1,2,3,0\n0,1,2,3,0\n"), "hand.csv, line 3"));
    EXPECT_TRUE(contains(refusal(head + "0,1,2,x,0\n"), "is not a number"));
    EXPECT_TRUE(contains(refusal(head + "inf,1,2,3,0\n"), "not finite"));
    EXPECT_TRUE(contains(refusal(head + "0,1,2,3,-1\n"), "'-1' is out of range"));
    EXPECT_TRUE(contains(refusal(head + "0,1,2,3,4294967296\n"), "0 to 4294967295"));
    EXPECT_TRUE(contains(refusal("t,device_x,device_y,device_z,device_status\n0,1,2,3,7\n"),
                         "'7' is out of range: 0 to 6"));
    EXPECT_TRUE(contains(refusal("t,x,y,z\n0,1,2,nan\n"), "not finite"));
    EXPECT_TRUE(contains(refusal(head), "no rows"));
    EXPECT_TRUE(contains(refusal("t,device_x,device_y\n0,1,2\n"), "'device_z'"));
    EXPECT_TRUE(contains(refusal("t,x,y\n0,1,2\n"), "'z'"));
    EXPECT_TRUE(contains(refusal(""), "is empty"));
    EXPECT_TRUE(contains(message_of<io::InputError>([&] { open("not_there.csv"); }),
                         "not_there.csv: cannot be opened"));
}

TEST_F(Recorded, options_that_cannot_be_meant_are_refused) {
    const auto options = [&](const std::string& text) {
        return message_of<std::invalid_argument>([&] { open(text); });
    };
    EXPECT_TRUE(contains(options("speed=2"), "recorded:FILE.csv"));
    EXPECT_TRUE(contains(options("a.csv,speed=0"), "from 0.01 to 100"));
    EXPECT_TRUE(contains(options("a.csv,loop=twice"), "yes, no"));
    EXPECT_TRUE(contains(options("a.csv,profile=omni"), "no option 'profile'"));
}

TEST(TimedPath, is_where_a_search_through_all_rows_says) {
    Random random(5);
    std::vector<double> time{-3};
    std::vector<Vec3> position{random.point(-1, 1)};
    for (int i = 0; i < 60; ++i) {
        time.push_back(time.back() + std::pow(10, random.uniform(-4, 0)));
        position.push_back(random.point(-1, 1));
    }
    TimedPath path(time, position);
    double t = -4;
    for (int i = 0; i < 20000; ++i) {
        // Onwards, back, anywhere, and exactly on rows.
        const int what = random.below(8);
        t = what < 5    ? t + random.uniform(0, 0.05)
            : what == 5 ? time[static_cast<std::size_t>(random.below(61))]
                        : random.uniform(-4, time.back() + 1);
        std::size_t row = 0;
        while (row + 1 < time.size() && time[row + 1] <= t) ++row;
        Vec3 wanted = position[row], velocity = Vec3::Zero();
        if (t > time.front() && t < time.back()) {
            velocity = (position[row + 1] - position[row]) / (time[row + 1] - time[row]);
            wanted += velocity * (t - time[row]);
        }
        const TimedPath::Place place = path.at(t);
        ASSERT_LE((place.position - wanted).norm(), 1e-12) << t;
        ASSERT_EQ(place.velocity, velocity) << t;
        ASSERT_EQ(place.row, row) << t;
        ASSERT_TRUE(what != 5 || place.position == wanted) << t;
    }
}

TEST(ThereAndBack, turns_at_both_ends) {
    EXPECT_EQ(there_and_back(0.5, 2).time, 0.5);
    EXPECT_EQ(there_and_back(2, 2).time, 2);
    EXPECT_EQ(there_and_back(2.5, 2).time, 1.5);
    EXPECT_EQ(there_and_back(2.5, 2).direction, -1);
    EXPECT_EQ(there_and_back(4.5, 2).time, 0.5);
    EXPECT_EQ(there_and_back(4.5, 2).direction, 1);
    EXPECT_EQ(there_and_back(3, 0).time, 0);
}

}  // namespace
}  // namespace palpate::devices

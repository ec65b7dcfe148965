// Two hands in one session from the command line: touch and record with --device twice, their
// reports, commands and one recording.
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "devices/haply/messages.hpp"
#include "devices/haply/mock_service.hpp"
#include "palpate/io/recording.hpp"
#include "support/recordings.hpp"

namespace palpate::app::test {
namespace {

using support::put_bytes;

const std::string ball_unpaced = "synthetic:sphere:32x32x32 --unpaced";
const std::string presses = "simulated:hand=press", circles = "simulated:omega6,hand=circle";

std::vector<SessionTick> ticks_of_hand(const std::filesystem::path& path, int hand = 1,
                                       bool complete = true) {
    io::RecordingReader reader(path, hand);
    std::vector<SessionTick> ticks;
    while (const auto event = reader.next()) {
        if (const auto* tick = std::get_if<SessionTick>(&*event)) ticks.push_back(*tick);
    }
    EXPECT_TRUE(reader.complete() || !complete);
    return ticks;
}

TEST(TouchWithTwo, records_both_in_one_file_each_with_the_forces_of_its_session_alone) {
    const ScratchFolder folder;
    const Outcome both =
        succeeds(folder, "touch " + ball_unpaced + " --device " + presses + " --device " + circles +
                             " --seconds 0.8 --record both.csv");
    EXPECT_TRUE(contains(both.out, "hand 1, device simulated\nticks 8")) << both.out;
    EXPECT_TRUE(contains(both.out, "hand 2, device simulated\nticks 8")) << both.out;
    for (const int hand : {1, 2}) {
        const std::string file = std::to_string(hand) + ".csv";
        succeeds(folder, "touch " + ball_unpaced + " --device " + (hand == 1 ? presses : circles) +
                             " --seconds 0.8 --record " + file);
        const auto its_own = ticks_of_hand(folder / file),
                   together = ticks_of_hand(folder / "both.csv", hand);
        ASSERT_EQ(together.size(), its_own.size());
        int felt = 0;
        for (std::size_t i = 0; i < its_own.size(); ++i) {
            ASSERT_EQ(together[i].tick.force, its_own[i].tick.force) << "tick " << i;
            felt += its_own[i].tick.force.norm() > 0.05;
        }
        EXPECT_GT(felt, 50);
    }
    const Outcome valid = succeeds(folder, "replay both.csv --validate");
    EXPECT_TRUE(contains(valid.out, "hand 1, ")) << valid.out;
    EXPECT_TRUE(contains(valid.out, "hand 2, ")) << valid.out;
    succeeds(folder, "touch " + ball_unpaced +
                         " --device recorded:both.csv --device "
                         "recorded:both.csv,hand=2 --record again.csv");
    expect_failure(palpate(folder, "replay " + ball_unpaced.substr(0, ball_unpaced.find(' ')) +
                                       " -i 50% --trajectory both.csv -o t.csv"),
                   3, "keep the rows of one hand");
}

TEST(TouchWithTwo, says_in_json_which_hand_is_which_and_lasts_as_long_as_one_of_them) {
    const ScratchFolder folder;
    const Outcome done =
        succeeds(folder, "touch " + ball_unpaced +
                             " --device simulated:hand=tap,seconds=0.5 --device "
                             "simulated:omega6,hand=tap,seconds=0.9 --json --quiet");
    const auto report = nlohmann::json::parse(done.out);
    ASSERT_EQ(report["hands"].size(), 2U);
    EXPECT_TRUE(contains(report["hands"][1]["device"].get<std::string>(), "omega"));
    EXPECT_EQ(report["hands"][1]["hand"], 2);
    EXPECT_EQ(report["hands"][0]["problem"], "");
    for (const auto& hand : report["hands"]) EXPECT_GT(hand["ticks"], 850);
}

TEST(TouchWithTwo, commands_are_for_both_or_for_the_hand_that_they_name) {
    const ScratchFolder folder;
    put_bytes(folder / "c.txt",
              "0.05 isovalue 60%\n0.1 hand 2 isovalue 40%\n0.1 hand 1 stiffness 0.2\n"
              "0.1 damping 0.0005\n0.15 fill 0,0,0:2,2,2 7\n0.3 quit\n");
    succeeds(folder, "touch " + ball_unpaced + " --device " + presses + " --device " + circles +
                         " --commands c.txt --record both.csv");
    double levels[2];
    for (const int hand : {1, 2}) {
        const auto ticks = ticks_of_hand(folder / "both.csv", hand);
        levels[hand - 1] = ticks.back().tick.proxy.isovalue;
        EXPECT_LT(ticks.back().tick.time, 0.32);
        EXPECT_EQ(ticks.back().version, 1U) << "one edit, felt by both";
        io::RecordingReader reader(folder / "both.csv", hand);
        std::optional<ForceSettings> force;
        while (const auto event = reader.next()) {
            const auto* command = std::get_if<Command>(&*event);
            const auto* settings = command ? std::get_if<ForceSettings>(command) : nullptr;
            if (settings) force = *settings;
        }
        ASSERT_TRUE(force);
        EXPECT_EQ(force->damping, 0.0005);
        EXPECT_EQ(force->stiffness == 0.2, hand == 1);
    }
    EXPECT_NEAR(levels[0] / levels[1], 1.5, 0.1);
    succeeds(folder, "replay both.csv --validate");
    put_bytes(folder / "third.txt", "0.1 hand 3 lift\n");
    expect_failure(palpate(folder, "touch " + ball_unpaced + " --device " + presses + " --device " +
                                       circles + " --commands third.txt"),
                   3, "line 1: hand N COMMAND: N is 1 to 2");
}

TEST(TouchWithTwo, refuses_what_only_one_hand_can_have) {
    const ScratchFolder folder;
    const std::string sphere = "touch synthetic:sphere:32x32x32 --headless";
    expect_failure(palpate(folder, sphere + " --device haply --device haply"), 2,
                   "a device serves one hand");
    expect_failure(palpate(folder, sphere + " --device simulated --device recorded:r.csv --igtl 0"),
                   2, "--igtl shows one hand");
    expect_failure(palpate(folder, sphere + " --device simulated --device mouse"), 4,
                   "there is no window");
}

TEST(PacedTouchWithTwo, goes_on_with_one_when_the_other_is_unplugged) {
    const ScratchFolder folder;
    auto service = std::make_unique<support::MockService>();
    service->greet(support::snapshot({support::whole_device("049D", {0, 0, 0.2})}));
    service->answer(support::moved("049D", {0, 0, 0.2}));
    Running program(
        words_of("touch synthetic:sphere:32x32x32 --headless --device haply:host=127.0.0.1,port=" +
                 std::to_string(service->port()) + " --device " + presses +
                 ",seconds=600 --record both.csv"),
        folder.path());
    const auto last = [&](int hand) {  // of what is in the file by now
        const auto ticks = ticks_of_hand(folder / "both.csv", hand, false);
        return ticks.empty() ? SessionTick{} : ticks.back();
    };
    const auto is_recorded = [&] {
        const auto file = folder / "both.csv";
        return std::filesystem::exists(file) && contains(support::bytes_of(file), ",tick,crc32\n");
    };
    ASSERT_TRUE(comes_true(is_recorded)) << program.finish(SIGINT).err;
    ASSERT_TRUE(comes_true([&] { return last(1).device.status == DeviceStatus::ready; }))
        << program.finish(SIGINT).err;
    service.reset();
    EXPECT_TRUE(comes_true([&] { return last(1).device.status == DeviceStatus::lost; }));
    const double then = last(2).tick.time;
    EXPECT_TRUE(comes_true([&] {
        const SessionTick now = last(2);  // on a busy machine some are stale
        return now.tick.time > then + 0.3 && now.device.status == DeviceStatus::ready;
    }));
    const Outcome done = program.finish(SIGINT);
    EXPECT_EQ(done.status, 130) << done.err;
    EXPECT_TRUE(contains(done.err, "hand 1, device haply: lost")) << done.err;
    EXPECT_EQ(last(1).tick.force, Vec3(0, 0, 0));
    succeeds(folder, "replay both.csv --validate");
}

}  // namespace
}  // namespace palpate::app::test

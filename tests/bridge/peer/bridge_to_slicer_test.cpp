// The bridge in the program that is run, against peers made of OpenIGTLink's own library.
#include <unistd.h>

#include <memory>

#include "apps/program.hpp"
#include "bridge/sockets.hpp"

namespace palpate::bridge {
namespace {

using app::test::Outcome;
using app::test::Running;
using app::test::Words;
using app::test::operator+;
using app::test::words_of;
using support::comes_true;
using support::contains;
using support::ScratchFolder;

/// A port that was free a moment ago.
int free_port() {
    const Listening listening = listen_at("127.0.0.1", 0);
    for (const int socket : listening.sockets) ::close(socket);
    return listening.port;
}

/// The program, feeling a ball, with a bridge at this port.
std::unique_ptr<Running> program(const ScratchFolder& folder, int port,
                                 const std::string& option = "--igtl", const Words& more = {}) {
    return std::make_unique<Running>(
        words_of("touch synthetic:sphere:32x32x32 --isovalue 50% --device "
                 "simulated:omega7,loop=yes --json " +
                 option + " " + std::to_string(port)) +
            more,
        folder.path());
}

Outcome peer(const ScratchFolder& folder, const std::string& role, int port, const Words& actions) {
    // It tries once: the program may not listen yet.
    Outcome outcome;
    EXPECT_TRUE(comes_true([&] {
        outcome = Running(Words{role, std::to_string(port)} + actions, folder.path(),
                          app::test::Stdout::captured, PALPATE_IGTL_PEER)
                      .finish();
        return outcome.status != 4;
    }));
    return outcome;
}

TEST(BridgeToSlicer, sees_poses_force_and_status) {
    const ScratchFolder folder;
    const int port = free_port();
    const auto touch = program(folder, port);
    const Outcome seen = peer(folder, "connect", port, {"poses", "120"});
    EXPECT_EQ(seen.status, 0);
    EXPECT_TRUE(contains(seen.out, "status 1 ")) << seen.out;
    EXPECT_FALSE(contains(seen.out, "BAD")) << seen.out;
    const Outcome end = touch->finish(SIGINT);
    EXPECT_EQ(end.status, 130) << end.err;
}

TEST(BridgeToSlicer, pushes_a_level_and_a_volume_and_feels_them) {
    const ScratchFolder folder;
    const int port = free_port();
    const auto touch = program(folder, port);
    const Outcome level =
        peer(folder, "connect", port,
             {"string", "isovalue 0.25", "await", "STRING", "status", "isovalue 0.25, ",  //
              "string", "save here.nrrd", "await", "STRING",                              //
              "string", "forces on", "await", "STRING",                                   //
              "string", "isovalue much", "await", "STRING"});
    EXPECT_TRUE(contains(level.out, "PalpateReply done: isovalue 0.25")) << level.out;
    EXPECT_EQ(level.status, 0);
    EXPECT_TRUE(contains(level.out, "'save' is not for others")) << level.out;
    EXPECT_TRUE(contains(level.out, "'forces' is not for others")) << level.out;
    EXPECT_TRUE(contains(level.out, "not done: ")) << level.out;
    // Another volume, with other levels and on another grid; then its surface.
    const Outcome volume = peer(
        folder, "connect", port,
        {"image", "Ball", "24", "200", "await", "STRING", "poses", "60", "string", "isovalue 50",
         "await", "STRING", "status", "isovalue 50, ", "surface", "await", "POLYDATA"});
    EXPECT_EQ(volume.status, 0);
    EXPECT_TRUE(contains(volume.out, "done: igtl:Ball at isovalue ")) << volume.out;
    // 50 of 200 is 5/16 of 24 voxels of 2 mm from the middle.
    const auto to = volume.out.find("polygons, to ");
    ASSERT_NE(to, std::string::npos) << volume.out;
    EXPECT_NEAR(std::stod(volume.out.substr(to + 13)), 15, 0.3);
    // Labels of it, on their own grid.
    const Outcome labels =
        peer(folder, "connect", port, {"image", "Bone-label", "8", "1", "await", "STRING"});
    EXPECT_TRUE(contains(labels.out, "done: igtl:Bone-label as labels")) << labels.out;
    EXPECT_EQ(touch->finish(SIGINT).status, 130);
    EXPECT_TRUE(folder.names().empty());
}

TEST(BridgeToSlicer, serves_two_clients_of_which_one_breaks_off_and_one_sends_garbage) {
    const ScratchFolder folder;
    const int port = free_port();
    const auto touch = program(folder, port);
    ASSERT_EQ(peer(folder, "connect", port, {"poses", "5"}).status, 0);
    const auto other =
        std::make_unique<Running>(Words{"connect", std::to_string(port), "poses", "120"},
                                  folder.path(), app::test::Stdout::captured, PALPATE_IGTL_PEER);
    EXPECT_EQ(peer(folder, "connect", port, {"garbage", "poses", "60"}).status, 3);
    Running(Words{"connect", std::to_string(port), "poses", "1000000"}, folder.path(),
            app::test::Stdout::captured, PALPATE_IGTL_PEER)
        .finish(SIGKILL);
    const Outcome seen = other->finish();
    EXPECT_EQ(seen.status, 0);
    const Outcome end = touch->finish(SIGINT);
    EXPECT_TRUE(contains(end.err, "was disconnected: it sent")) << end.err;
}

TEST(BridgeToSlicer, cannot_push_a_volume_over_edits_that_were_not_saved) {
    const ScratchFolder folder;
    const int port = free_port();
    support::put_bytes(folder / "c.txt", "0 fill 1,1,1:2,2,2 9\n0 isovalue 0.3\n");
    const auto touch = program(folder, port, "--igtl", {"--commands", "c.txt"});
    const Outcome pushed =
        peer(folder, "connect", port,
             {"status", "isovalue 0.3", "image", "Ball", "16", "200", "await", "STRING"});
    EXPECT_TRUE(contains(pushed.out, "not done: the volume felt has edits")) << pushed.out;
    EXPECT_EQ(touch->finish(SIGINT).status, 130);
}

TEST(BridgeToSlicer, cannot_push_what_cannot_be_felt_and_the_session_goes_on) {
    const ScratchFolder folder;
    const int port = free_port();
    const auto touch = program(folder, port, "--igtl", {"--record", "session.csv"});
    const Outcome pushed = peer(folder, "connect", port,
                                {"image", "Ball", "16", "200", "await", "STRING", "image",
                                 "Empty-label", "16", "0", "await", "STRING", "poses", "30"});
    EXPECT_EQ(pushed.status, 0);
    EXPECT_TRUE(contains(pushed.out, "not done: the session is recorded")) << pushed.out;
    EXPECT_TRUE(contains(pushed.out, "has no label above 0")) << pushed.out;
    EXPECT_EQ(touch->finish(SIGINT).status, 130);
}

TEST(BridgeToSlicer, connects_to_a_server_that_comes_later) {
    const ScratchFolder folder;
    const int port = free_port();
    const auto touch = program(folder, port, "--igtl-connect");
    const Outcome seen =
        peer(folder, "listen", port, {"string", "isovalue 0.3", "await", "STRING", "poses", "60"});
    EXPECT_EQ(seen.status, 0);
    EXPECT_TRUE(contains(seen.out, "done: isovalue 0.3")) << seen.out;
    EXPECT_EQ(touch->finish(SIGINT).status, 130);
}

TEST(BridgeToSlicer, is_warned_of_an_address_that_others_reach_and_refuses_what_is_none) {
    const ScratchFolder folder;
    const auto touch = std::make_unique<Running>(
        words_of("touch synthetic:sphere:16x16x16 --seconds 0.2 --igtl 0.0.0.0:0"), folder.path());
    EXPECT_TRUE(contains(touch->finish().err, "warning: OpenIGTLink has no passwords"));
    for (const char* wrong : {"--igtl here", "--igtl 1 --igtl-connect 2", "--igtl-connect 0"}) {
        app::test::expect_failure(
            app::test::palpate(folder, std::string("touch synthetic:sphere:16x16x16 ") + wrong), 2,
            contains(wrong, "1") ? "give one of them" : "is no address for OpenIGTLink");
    }
}

}  // namespace
}  // namespace palpate::bridge

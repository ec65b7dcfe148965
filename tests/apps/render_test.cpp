// palpate render: the picture has the requested parts, and each failure is reported.
#include <cmath>

#include "apps/program.hpp"
#include "support/png.hpp"

namespace palpate::app::test {
namespace {

using support::is_blue;
using support::is_bone;
using support::is_green;
using support::is_vermilion;
using support::Png;

const std::string render_ball = "render synthetic:sphere:24x24x24 --size 200x160 -o p.png ";

Png picture_of(const ScratchFolder& folder, const std::string& words) {
    const Outcome outcome = succeeds(folder, words);
    EXPECT_EQ(outcome.err, "");
    return support::png_from(support::bytes_of(folder / "p.png"));
}

/// The program with a variable set.
Outcome with(const char* variable, const std::string& value, const ScratchFolder& folder,
             const std::string& words) {
    ::setenv(variable, value.c_str(), 1);
    Outcome outcome = palpate(folder, words);
    ::unsetenv(variable);
    return outcome;
}

std::size_t different(const Png& a, const Png& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) count += a.pixels[i] != b.pixels.at(i);
    return count;
}

TEST(Render, a_picture_has_its_size_with_the_surface_in_the_middle_and_background_around) {
    const ScratchFolder folder;
    const Png png = picture_of(folder, render_ball);
    EXPECT_EQ(png.width, 200U);
    EXPECT_EQ(png.height, 160U);
    EXPECT_TRUE(is_bone(png.at(100, 80)));
    EXPECT_GT(png.count(is_bone), 10'000U);
    EXPECT_GT(png.colours(), 100U);
    for (const std::size_t x : {0, 199}) {
        for (const std::size_t y : {0, 159}) {
            EXPECT_GT(std::min({png.at(x, y)[0], png.at(x, y)[1], png.at(x, y)[2]}), 230);
        }
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"p.png"});
}

TEST(Render, shows_a_second_level) {
    const ScratchFolder folder;
    const Png one = picture_of(folder, render_ball + "-i 180");
    const Png two = picture_of(folder, render_ball + "-i 180 -i 30");
    EXPECT_GT(different(one, two), 2000U);
    const Png outer = picture_of(folder, render_ball + "-i 30");
    EXPECT_GT(different(outer, two), 2000U);
}

TEST(Render, the_solid_below_a_level_is_drawn_too) {
    const ScratchFolder folder;
    const Png hole = picture_of(folder,
                                "render synthetic:shell:24x24x24 --solid below -i 50% "
                                "--size 200x160 -o p.png");
    EXPECT_GT(hole.count(is_bone), 1000U);
}

TEST(Render, a_hand_alone_gets_its_proxy_spring_and_force) {
    const ScratchFolder folder;
    const Outcome outcome =
        palpate(folder, render_ball + "--hip 0,-5,0 --view front --azimuth 0 --stiffness 0.2");
    EXPECT_EQ(outcome.status, 2);  // a view by name or by angles
    const Outcome drawn =
        succeeds(folder, render_ball + "--hip 0,-5,0.5 --elevation 60 --stiffness 0.2");
    const Png png = support::png_from(support::bytes_of(folder / "p.png"));
    EXPECT_GT(png.count(is_vermilion), 5U);
    EXPECT_GT(png.count(is_green), 10U);
    // The SCP as printed: on the ball's surface, in front of the hand; and the force k (SCP - HIP).
    double x = 0, y = 0, z = 0, force = 0;
    const auto at = drawn.out.find("SCP (");
    ASSERT_NE(at, std::string::npos) << drawn.out;
    ASSERT_EQ(std::sscanf(drawn.out.c_str() + at, "SCP (%lf, %lf, %lf) mm, force %lf N", &x, &y, &z,
                          &force),
              4)
        << drawn.out;
    EXPECT_LT(y, -5);
    EXPECT_NEAR(force, 0.2 * std::hypot(x, y + 5, z - 0.5), 1e-3);
}

TEST(Render, a_hand_in_free_space_is_its_own_proxy) {
    const ScratchFolder folder;
    const Outcome outcome = succeeds(folder, render_ball + "--hip 0,-30,0");
    EXPECT_TRUE(contains(outcome.out, "SCP (0, -30, 0) mm, force 0 N")) << outcome.out;
}

TEST(Render, points_forces_and_views_are_taken_as_given) {
    const ScratchFolder folder;
    const std::string front = render_ball + "--view front ";
    const Png plain = picture_of(folder, front);
    EXPECT_EQ(plain.count(is_vermilion), 0U);
    const Png proxy = picture_of(folder, front + "--scp 0,-12,0");
    EXPECT_TRUE(is_vermilion(proxy.at(100, 80)));
    EXPECT_FALSE(
        is_vermilion(picture_of(folder, render_ball + "--view back --scp 0,-12,0").at(100, 80)));
    const Png pushed = picture_of(folder,
                                  "render synthetic:sphere:24x24x24 --size 400x320 -o p.png --view "
                                  "front --scp 0,-12,0 --hip 3,-12,0 --force 0,0,-2");
    EXPECT_GT(pushed.count(is_blue), 5U);
    std::size_t below = 0, above = 0;
    for (std::size_t i = 0; i < pushed.pixels.size(); ++i) {
        // Right of the legend, where nothing else is green.
        if (!is_green(pushed.pixels[i]) || i % 400 < 120) continue;
        ++(i / 400 > 160 ? below : above);
    }
    EXPECT_GT(below, 10U);
    EXPECT_EQ(above, 0U);
    EXPECT_GT(different(plain, picture_of(folder, front + "--zoom 2")), 4000U);
    EXPECT_GT(different(plain, picture_of(folder, front + "--zoom 0.5")), 4000U);
    EXPECT_EQ(different(plain, picture_of(folder, render_ball + "--azimuth 0 --elevation 0")), 0U);
    const Png lying = picture_of(folder,
                                 "render synthetic:torus:24x24x12 --size 200x160 -o p.png "
                                 "--view front");
    const Png standing = picture_of(folder,
                                    "render synthetic:torus:24x24x12 --size 200x160 -o "
                                    "p.png --view front --roll 90");
    EXPECT_GT(different(lying, standing), 4000U);
}

TEST(Render, draws_the_path_of_a_trace_or_a_path_file) {
    const MotionFolder folder;
    ASSERT_EQ(palpate(folder,
                      "replay synthetic:sphere:24x24x24 --trajectory t.csv -o trace.csv "
                      "--path path.csv")
                  .status,
              0);
    const std::string left = render_ball + "--view right ";
    const Png trace = picture_of(folder, left + "--path trace.csv");
    EXPECT_GT(trace.count(is_vermilion), 5U);
    EXPECT_GT(trace.count(is_blue), 2U);
    const Png path = picture_of(folder, left + "--path path.csv");
    EXPECT_GT(path.count(is_vermilion), 5U);
    EXPECT_EQ(path.count(is_blue), 0U);
    expect_failure(palpate(folder, left + "--path nothing.csv"), 3, "nothing.csv");
    support::put_bytes(folder / "bad.csv", "x,y,z\n1,2,nan\n");
    expect_failure(palpate(folder, left + "--path bad.csv"), 3, "bad.csv");
    support::put_bytes(folder / "other.csv", "a,b\n1,2\n");
    expect_failure(palpate(folder, left + "--path other.csv"), 3, "other.csv");
}

TEST(Render, writes_only_the_picture_to_standard_output) {
    const ScratchFolder folder;
    const Outcome outcome =
        succeeds(folder, "render synthetic:sphere:16x16x16 --size 100x100 --output -");
    EXPECT_EQ(support::png_from(outcome.out).width, 100U);
    EXPECT_TRUE(folder.names().empty());
}

TEST(Render, warns_of_a_level_without_surface_and_draws_all_the_same) {
    const ScratchFolder folder;
    const Outcome outcome = succeeds(folder, render_ball + "-i 300");
    EXPECT_TRUE(contains(outcome.err, "warning: isovalue 300")) << outcome.err;
    EXPECT_LT(support::png_from(support::bytes_of(folder / "p.png")).count(is_bone),
              100U);  // the legend's
}

TEST(Render, refuses_wrong_options) {
    const ScratchFolder folder;
    const std::string start = "render synthetic:sphere:16x16x16 ";
    const auto refused = [&](const std::string& words, const std::string& reason) {
        expect_failure(palpate(folder, start + words), 2, reason);
    };
    refused("", "--output is required");
    refused("-o p.jpg", "PNG");
    refused("-o p.png -i abc", "'abc' is not a level");
    refused("-o p.png -i nan", "'nan'");
    refused("-o p.png -i 30 -i 30", "twice");
    refused("-o p.png -i 1 -i 2 -i 3 -i 4 -i 5 -i 6", "at most 5");
    refused("-o p.png --scp 1,2", "three numbers");
    refused("-o p.png --hip 1,2,x", "three numbers");
    refused("-o p.png --hip 1,2,inf", "three numbers");
    refused("-o p.png --force 1,0,0", "--scp or --hip");
    refused("-o p.png --size 10x10", "64 to 4096");
    refused("-o p.png --size big", "WIDTHxHEIGHT");
    refused("-o p.png --view sideways", "sideways");
    refused("-o p.png --elevation 95", "-90 to 90");
    refused("-o p.png --zoom 0", "--zoom");
    refused("-o p.png --stiffness -1", "--stiffness");
    EXPECT_TRUE(folder.names().empty());
    expect_failure(palpate(folder, "render nothing.nrrd -i 5 -o p.png"), 3, "nothing.nrrd");
}

TEST(Render, a_hand_where_all_is_solid_is_refused) {
    const ScratchFolder folder;
    const Outcome outcome = palpate(folder, render_ball + "-i -5 --hip 0,0,0");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(contains(outcome.err, "all of space is solid")) << outcome.err;
}

TEST(Render, a_file_needs_its_level) {
    SKIP_WITHOUT("fuel_small.nrrd");
    const ScratchFolder folder;
    const std::string file = "render " + data_file("fuel_small.nrrd").string();
    expect_failure(palpate(folder, file + " -o p.png"), 2, "--isovalue is needed");
    EXPECT_GT(picture_of(folder, file + " -i 30 --size 120x120 -o p.png").count(is_bone), 500U);
}

TEST(Render, refuses_outputs_that_cannot_be_written_before_the_work) {
    const ScratchFolder folder;
    support::put_bytes(folder / "slow", "#!/bin/sh\ntouch started\nexit 1\n");
    std::filesystem::permissions(folder / "slow", std::filesystem::perms::owner_all);
    expect_failure(with("PALPATE_PICTURE_HELPER", (folder / "slow").string(), folder,
                        "render synthetic:sphere:16x16x16 -o no/p.png"),
                   5, "does not exist");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"slow"});
    expect_failure(palpate(folder, "render synthetic:sphere:16x16x16 -q -o /dev/full"), 5,
                   "/dev/full");
}

TEST(Render, a_helper_that_fails_gives_one_line_and_status_5) {
    const ScratchFolder folder;
    support::put_bytes(folder / "crash", "#!/bin/sh\nkill -SEGV $$\n");
    std::filesystem::permissions(folder / "crash", std::filesystem::perms::owner_all);
    const auto fails = [&](const char* variable, const std::string& value,
                           const std::string& reason) {
        expect_failure(with(variable, value, folder, render_ball), 5, reason);
        EXPECT_EQ(folder.names(), std::vector<std::string>{"crash"});
    };
    fails("PALPATE_PICTURE_HELPER", (folder / "crash").string(), "libgl1-mesa-dri");
    fails("PALPATE_PICTURE_HELPER", (folder / "nothing").string(), "reinstall Palpate");
    fails("PALPATE_PICTURE_HELPER", "/bin/true", "without an answer");
    fails("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere", "install libegl1");
    fails("LIBGL_DRIVERS_PATH", "/nowhere", "install libegl1");
}

TEST(Render, ctrl_c_ends_the_helper_and_leaves_nothing) {
    const ScratchFolder folder;
    support::put_bytes(folder / "slow", "#!/bin/sh\ntouch started\nexec sleep 100\n");
    std::filesystem::permissions(folder / "slow", std::filesystem::perms::owner_all);
    ::setenv("PALPATE_PICTURE_HELPER", (folder / "slow").c_str(), 1);
    Running render(words_of(render_ball), folder.path());
    ::unsetenv("PALPATE_PICTURE_HELPER");
    ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(folder / "started"); }));
    const Outcome outcome = render.finish(SIGINT);
    EXPECT_EQ(outcome.status, 130);
    EXPECT_TRUE(comes_true([&] { return !render.left_a_process(); }));
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"slow", "started"}));
}

TEST(Render, the_program_itself_loads_no_graphics) {
    const ScratchFolder folder;
    const Outcome libraries =
        Running({PALPATE_PROGRAM}, folder.path(), Stdout::captured, "ldd").finish();
    ASSERT_EQ(libraries.status, 0) << libraries.err;
    EXPECT_TRUE(contains(libraries.out, "libstdc++"));
    for (const char* graphics : {"libvtk", "libGL", "libEGL", "libpng", "libX11"}) {
        EXPECT_FALSE(contains(libraries.out, graphics)) << graphics;
    }
}

}  // namespace
}  // namespace palpate::app::test

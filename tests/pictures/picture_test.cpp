// Pictures by the helper program show what the scene holds, and every failure becomes an error.
#include "pictures/picture.hpp"

#include <chrono>
#include <cstdlib>

#include "palpate/scenes/volumes.hpp"
#include "pictures/contact.hpp"
#include "pictures/levels.hpp"
#include "pictures/view.hpp"
#include "support/png.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::pictures {
namespace {

using support::contains;
using support::is_blue;
using support::is_bone;
using support::is_green;
using support::is_vermilion;
using support::Pixel;
using support::Png;
using support::png_from;
using support::ScratchFolder;

scenes::Scene ball() {
    return scenes::make_volume("sphere:24x24x24");
}

/// The ball from the front, without any writing.
PictureScene scene_of_ball(std::vector<double> levels = {}) {
    const scenes::Scene scene = ball();
    if (levels.empty()) levels.push_back(scene.isovalue);
    PictureScene picture;
    picture.width = 200;
    picture.height = 160;
    picture.legend = picture.orientation = picture.scale_bar = false;
    add_levels(picture, linear_field(scene.volume), levels);
    frame(picture, view_named("front"));
    return picture;
}

bool is_paper(const Pixel& p) {
    return p[0] > 235 && p[1] > 235 && p[2] > 235 && p[2] >= p[0];
}

TEST(Picture, a_ball_fills_the_middle_and_leaves_the_corners) {
    const Png png = png_from(png_of(scene_of_ball()));
    ASSERT_EQ(png.width, 200U);
    ASSERT_EQ(png.height, 160U);
    EXPECT_TRUE(is_bone(png.at(100, 80)));
    for (const auto& [x, y] : {std::pair(2, 2), {197, 2}, {2, 157}, {197, 157}}) {
        EXPECT_TRUE(is_paper(png.at(std::size_t(x), std::size_t(y))));
    }
    EXPECT_GT(png.colours(), 100U);  // shaded, not flat
    // A disc that reaches from edge to edge but for the margin: its area says that it is round.
    const double radius = 0.5 * 160 / 1.12;
    EXPECT_NEAR(double(png.count(is_bone)), 3.1416 * radius * radius, 0.05 * 160 * 160);
}

TEST(Picture, the_light_comes_from_above_the_viewers_left_shoulder) {
    const Png png = png_from(png_of(scene_of_ball()));
    EXPECT_GT(png.at(75, 55)[0], png.at(125, 105)[0] + 30);
}

TEST(Picture, hand_proxy_and_force_are_seen_where_they_are) {
    PictureScene scene = scene_of_ball();
    const Vec3 scp(0, -20, 0);
    add_contact(scene, {scp, {}, {}});
    Png png = png_from(png_of(scene));
    EXPECT_TRUE(is_vermilion(png.at(100, 80)));
    EXPECT_EQ(png.count(is_blue), 0U);
    EXPECT_EQ(png.count(is_green), 0U);

    scene = scene_of_ball();
    add_contact(scene, {Vec3(0, -20, 5), Vec3(0, -20, -5), Vec3(3, 0, 0)});
    png = png_from(png_of(scene));
    const double pixels_per_mm = 80 / scene.camera.half_height;
    const auto up = static_cast<std::size_t>(std::lround(5 * pixels_per_mm));
    EXPECT_TRUE(is_vermilion(png.at(100, 80 - up)));
    EXPECT_TRUE(is_blue(png.at(100, 80 + up)));
    std::size_t to_the_right = 0;  // where the body's left is
    for (std::size_t i = 0; i < png.pixels.size(); ++i) {
        to_the_right += is_green(png.pixels[i]) && i % png.width > 100;
    }
    EXPECT_GT(to_the_right, 20U);
    EXPECT_EQ(png.count(is_green), to_the_right);
}

TEST(Picture, a_marker_behind_a_surface_is_seen_faintly) {
    PictureScene scene = scene_of_ball();
    add_contact(scene, {{}, Vec3(0, 0, 0), {}});
    const Png png = png_from(png_of(scene));
    const Pixel hidden = png.at(100, 80), beside = png.at(100, 100);
    EXPECT_FALSE(is_blue(hidden));
    EXPECT_GT(hidden[2] - hidden[0], beside[2] - beside[0] + 30);
}

TEST(Picture, an_outer_level_is_transparent_over_the_inner_one) {
    const Png one = png_from(png_of(scene_of_ball({180})));
    const Png two = png_from(png_of(scene_of_ball({180, 20})));
    ASSERT_EQ(one.width, two.width);
    // In the middle the inner one, tinted; round it the outer one alone.
    const Pixel middle = two.at(100, 80);
    EXPECT_GT(int(middle[2]) - middle[0], int(one.at(100, 80)[2]) - one.at(100, 80)[0] + 5);
    const auto bluish = [](const Pixel& p) { return p[2] > p[0] + 15; };
    EXPECT_GT(two.count(bluish), 500U);
    EXPECT_EQ(one.count(bluish), 0U);
    EXPECT_FALSE(is_paper(middle));
}

TEST(Picture, legend_scale_bar_and_cube_are_written_where_they_belong) {
    PictureScene scene = scene_of_ball();
    scene.width = scene.height = 400;
    scene.title = "A ball";
    frame(scene, view_named("front"), 0.5);
    const Png bare = png_from(png_of(scene));
    scene.legend = scene.orientation = scene.scale_bar = true;
    const Png full = png_from(png_of(scene));
    const auto changed = [&](std::size_t x0, std::size_t x1, std::size_t y0, std::size_t y1) {
        int count = 0;
        for (std::size_t y = y0; y < y1; ++y) {
            for (std::size_t x = x0; x < x1; ++x) count += bare.at(x, y) != full.at(x, y);
        }
        return count;
    };
    EXPECT_GT(changed(0, 200, 20, 100), 100);    // legend, under the title
    EXPECT_GT(changed(0, 100, 300, 400), 100);   // cube
    EXPECT_GT(changed(300, 400, 340, 400), 50);  // scale bar
    EXPECT_EQ(changed(120, 280, 120, 280), 0);   // not over the ball
}

TEST(Picture, an_empty_scene_can_be_drawn) {
    PictureScene scene;
    scene.width = scene.height = 100;
    const Png png = png_from(png_of(scene));
    EXPECT_GT(png.count(is_paper), 8000U);
}

TEST(Picture, a_body_far_from_the_origin_is_as_sharp) {
    PictureScene near = scene_of_ball(), far = scene_of_ball();
    const Vec3 away(3e6, -2e6, 1e6);
    for (Vec3& v : far.surfaces[0].mesh.vertices) v += away;
    frame(far, view_named("front"));
    const Png a = png_from(png_of(near)), b = png_from(png_of(far));
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        different += std::abs(a.pixels[i][0] - b.pixels[i][0]) > 8;
    }
    EXPECT_LT(different, a.pixels.size() / 100);
}

TEST(Picture, scenes_without_sense_are_refused) {
    const auto refused = [](const std::function<void(PictureScene&)>& spoil) {
        PictureScene scene = scene_of_ball();
        spoil(scene);
        EXPECT_THROW((void)png_of(scene), std::invalid_argument);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    refused([](PictureScene& s) { s.width = 0; });
    refused([](PictureScene& s) { s.height = 10'000; });
    refused([&](PictureScene& s) { s.camera.focus[0] = nan; });
    refused([](PictureScene& s) { s.camera.half_height = 0; });
    refused([](PictureScene& s) { s.camera.up = s.camera.towards_viewer; });
    refused([](PictureScene& s) { s.surfaces[0].normals.pop_back(); });
    refused([](PictureScene& s) { s.surfaces[0].opacity = 0; });
    refused([](PictureScene& s) { s.surfaces[0].mesh.triangles[0][0] = 1U << 31; });
    refused([&](PictureScene& s) { s.surfaces[0].mesh.vertices[0][1] = nan; });
    refused([&](PictureScene& s) { s.balls.push_back({Vec3(nan, 0, 0), 1, {}, ""}); });
    refused([](PictureScene& s) { s.lines.push_back({{Vec3(0, 0, 0)}, 0, {}, ""}); });
}

TEST(Picture, odd_objects_are_drawn_without_complaint) {
    PictureScene scene = scene_of_ball();
    const Vec3 p(0, -20, 0);
    scene.lines.push_back({{p}, 0.5, hip_colour, "a point"});
    scene.lines.push_back({{p, p, p}, 0.5, hip_colour, "the same"});
    scene.lines.push_back({{}, 0.5, hip_colour, "nothing"});
    scene.springs.push_back({p, p, 1, spring_colour, ""});
    scene.arrows.push_back({p, p, 1, force_colour, "quoted \"\\ \xff\n text"});
    scene.surfaces.emplace_back();
    EXPECT_GT(png_from(png_of(scene)).count(is_blue), 0U);
}

/// A helper that is a shell script.
DrawOptions with_script(const ScratchFolder& folder, const std::string& commands) {
    support::put_bytes(folder / "helper", "#!/bin/bash\n" + commands + "\n");
    std::filesystem::permissions(folder / "helper", std::filesystem::perms::owner_all);
    DrawOptions options;
    options.helper = folder / "helper";
    return options;
}

std::string refusal(const DrawOptions& options) {
    try {
        (void)png_of(scene_of_ball(), options);
    } catch (const io::OutputError& e) {
        const std::string message = e.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_TRUE(contains(message, "the picture could not be drawn: ")) << message;
        return message;
    }
    ADD_FAILURE() << "it was drawn";
    return {};
}

TEST(Picture, every_failure_of_the_helper_is_an_error) {
    const ScratchFolder folder;
    EXPECT_TRUE(contains(refusal(with_script(folder, "kill -SEGV $$")), "libgl1-mesa-dri"));
    EXPECT_TRUE(contains(refusal(with_script(folder, "kill -KILL $$")), "out of memory"));
    EXPECT_TRUE(contains(refusal(with_script(folder, "exit 0")), "without an answer"));
    refusal(with_script(folder, "echo '{\"done\":{}}' >&4"));
    refusal(with_script(folder, "echo '{\"done\":{\"at\":0,\"bytes\":0}}' >&4"));
    refusal(with_script(folder, "echo '{\"done\":{\"at\":99999999,\"bytes\":10}}' >&4"));
    refusal(with_script(folder, "echo '{\"done\":{\"at\":-5,\"bytes\":10}}' >&4"));
    EXPECT_TRUE(contains(refusal(with_script(folder, "echo '{\"error\":\"no\"}' >&4")), ": no"));
    DrawOptions missing;
    missing.helper = folder / "nothing";
    EXPECT_TRUE(contains(refusal(missing), "PALPATE_PICTURE_HELPER"));
    DrawOptions slow = with_script(folder, "exec sleep 100");
    slow.time_limit_s = 0.3;
    EXPECT_TRUE(contains(refusal(slow), "no answer after"));
}

TEST(Picture, a_missing_library_is_named) {
    const ScratchFolder folder;
    // What the loader does when it does not find one.
    const std::string message = refusal(with_script(
        folder,
        "echo 'palpate-picture-helper: error while loading shared libraries: libvtk.so' >&2\n"
        "exit 127"));
    EXPECT_TRUE(contains(message, "libvtk.so")) << message;
    EXPECT_TRUE(contains(message, "library that it needs is missing")) << message;
}

TEST(Picture, without_egl_the_message_says_what_to_install) {
    ASSERT_EQ(::setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere", 1), 0);
    const std::string message = refusal({});
    ::unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
    EXPECT_TRUE(contains(message, "install libegl1")) << message;
}

TEST(Picture, an_exception_while_waiting_ends_the_helper_and_leaves_no_file) {
    const ScratchFolder folder;
    DrawOptions options = with_script(folder, "exec sleep 100");
    struct Cancelled {};
    options.waiting = [] { throw Cancelled(); };
    EXPECT_THROW(draw_picture(scene_of_ball(), folder / "p.png", options), Cancelled);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"helper"});
}

TEST(Picture, a_file_is_complete_or_not_there) {
    const ScratchFolder folder;
    draw_picture(scene_of_ball(), folder / "p.png");
    EXPECT_EQ(png_from(support::bytes_of(folder / "p.png")).width, 200U);
    EXPECT_THROW(draw_picture(scene_of_ball(), folder / "no/p.png"), io::OutputError);
    EXPECT_THROW(draw_picture(scene_of_ball(), folder / "q.png", with_script(folder, "exit 1")),
                 io::OutputError);
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"helper", "p.png"}));
}

}  // namespace
}  // namespace palpate::pictures

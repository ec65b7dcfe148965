// Which changes the painters get, and which they do not: each picture of a volume costs much.
#include <gtest/gtest.h>

#include "apps/viewer/scene/background_renderer.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "viewer/scene/shown_scene.hpp"

namespace palpate::viewer {
namespace {

/// Settled with a ball, its label and slices. What is asked for after that is drawn unless
/// settled() stays true.
struct DrawnBall {
    BackgroundRenderer renderer{painter_of_test()};
    RenderRequest wanted;
    ExtractedSurface label;

    DrawnBall() {
        const Field field = linear_field(scenes::ball(support::cube(16)));
        RenderMesh triangle;
        triangle.positions = {-5, -9, -5, 5, -9, -5, 0, -9, 5};
        triangle.normals = {0, -1, 0, 0, -1, 0, 0, -1, 0};
        triangle.triangles = {0, 1, 2};
        label.blocks = {std::make_shared<const RenderMesh>(std::move(triangle))};
        label.moving = label.blocks;
        wanted.look.slices = true;
        wanted.width = wanted.height = 32;
        wanted.camera = {physical_centre(field.geometry()), Vec3(0, -1, 0), Vec3(0, 0, 1), 10};
        renderer.request(wanted);
        renderer.set_field(field, 128);
        renderer.set_overlay(labels());
        settle();
    }
    std::vector<DrawnSurface> labels() const { return {{label, Colour{0.9, 0.1, 0.1}, 0.7}}; }
    void settle() {
        wait_until([this] { return renderer.settled(); });
    }
};

TEST(BackgroundRenderer, draws_nothing_anew_for_what_only_slices_beside_the_scene_show) {
    DrawnBall drawn;
    ASSERT_TRUE(drawn.renderer.settled());
    drawn.wanted.look.overlay.opacity = 0.9;
    drawn.wanted.look.overlay.colours = "grey";
    drawn.wanted.look.colours = "hot";
    drawn.renderer.request(drawn.wanted);
    EXPECT_TRUE(drawn.renderer.settled());
    drawn.renderer.set_overlay(drawn.labels());  // as the window does at each change of the look
    EXPECT_TRUE(drawn.renderer.settled());
}

TEST(BackgroundRenderer, draws_an_overlay_whose_surfaces_have_changed) {
    DrawnBall drawn;
    ASSERT_TRUE(drawn.renderer.settled());
    auto labels = drawn.labels();
    const auto draws = [&] {
        drawn.renderer.set_overlay(labels);
        const bool asked = !drawn.renderer.settled();
        drawn.settle();
        return asked;
    };
    labels[0].opacity = 0;
    EXPECT_TRUE(draws());
    labels[0].colour = {0, 0, 1};
    EXPECT_TRUE(draws());
    labels[0].offset = Vec3(1, 0, 0);
    EXPECT_TRUE(draws());
    labels[0].surface.blocks = {std::make_shared<const RenderMesh>(*drawn.label.blocks[0])};
    EXPECT_TRUE(draws());
    labels.clear();
    EXPECT_TRUE(draws());
    EXPECT_FALSE(draws());
}

/// Says that each quick picture took so long [s], and keeps how many triangles it had.
struct Slow final : Painter {
    Slow(Results results, double seconds, std::size_t& triangles)
        : results_(std::move(results)), seconds_(seconds), triangles_(triangles) {}
    void draw(RenderRequest request) override {
        if (request.moving && !request.surfaces.empty()) {
            triangles_ = triangle_count(request.surfaces[0].surface.moving);
        }
        RenderedImage image;
        image.number = request.number;
        image.moving = request.moving;
        image.seconds = seconds_;
        results_.drawn(std::move(image));
    }
    void give_up() override {}

    Results results_;
    double seconds_;
    std::size_t& triangles_;
};

/// Triangles in the pictures of a large ball that turns.
std::size_t triangles_in_motion(double seconds) {
    std::size_t triangles = 0;
    BackgroundRenderer renderer([&](Painter::Priority, Painter::Results results) {
        return std::make_unique<Slow>(std::move(results), seconds, triangles);
    });
    const Field field = linear_field(scenes::ball(support::cube(100)));
    RenderRequest wanted;
    wanted.width = wanted.height = 32;
    wanted.camera = {physical_centre(field.geometry()), Vec3(0, -1, 0), Vec3(0, 0, 1), 10};
    renderer.request(wanted);
    renderer.set_field(field, 128);
    wait_until([&] { return renderer.settled(); });
    for (int i = 0; i < 10; ++i) {
        wanted.camera.half_height += 1;
        renderer.request(wanted);
        wait_until([&] { return renderer.settled(); });
    }
    return triangles;
}

TEST(BackgroundRenderer, surface_in_motion_becomes_coarser_where_its_pictures_are_slow) {
    const std::size_t quick = triangles_in_motion(0.02), slow = triangles_in_motion(0.08);
    EXPECT_GT(quick, 40'000U);
    EXPECT_LE(slow, 40'000U);
    EXPECT_GT(slow, 1'000U);
}

TEST(BackgroundRenderer, an_edit_is_seen_at_once_as_finely_as_it_will_be_until_the_camera_moves) {
    std::size_t triangles = 0;
    BackgroundRenderer renderer([&](Painter::Priority, Painter::Results results) {
        return std::make_unique<Slow>(std::move(results), 0.02, triangles);
    });
    Field field = linear_field(scenes::ball(support::cube(128)));
    RenderRequest wanted;
    wanted.width = wanted.height = 32;
    wanted.camera = {physical_centre(field.geometry()), Vec3(0, -1, 0), Vec3(0, 0, 1), 10};
    renderer.request(wanted);
    renderer.set_field(field, 128);
    wait_until([&] { return renderer.settled(); });
    const std::size_t coarse = triangles;
    const edit::Fill hole{{Index3(64, 16, 64), Index3(67, 26, 67)}, 0};
    field.use(edited(field.shared_samples(), hole).samples);
    renderer.update_field(field);
    wait_until([&] { return renderer.settled(); });
    EXPECT_GT(triangles, 2 * coarse);
    wanted.camera.half_height += 1;
    renderer.request(wanted);
    EXPECT_LT(triangles, 2 * coarse);
    wait_until([&] { return renderer.settled(); });
}

}  // namespace
}  // namespace palpate::viewer

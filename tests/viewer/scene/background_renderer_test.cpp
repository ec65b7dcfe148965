// Which changes the painters get, and which they do not: each picture of a volume costs much.
#include <gtest/gtest.h>

#include "apps/viewer/scene/background_renderer.hpp"
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

}  // namespace
}  // namespace palpate::viewer

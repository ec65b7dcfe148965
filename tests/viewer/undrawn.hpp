// A painter that draws nothing, for tests of all that a scene does besides. Suites whose names
// begin with Drawn get the program's own, and need a display for its OpenGL
// (scripts/with_display.sh).
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string_view>
#include <utility>

#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/view_space.hpp"

namespace palpate::viewer {

/// Answers each request at once with a fine image, as graphics hardware does. The image has no
/// pixels.
class Undrawn final : public Painter {
  public:
    explicit Undrawn(Results results) : results_(std::move(results)) {}

    void draw(RenderRequest request) override {
        RenderedImage image;
        image.number = request.number;
        image.width = request.width;
        image.height = request.height;
        image.camera = request.camera;
        image.reach = request.field ? reach_of(request.field->geometry()) : 1;
        image.seconds = 1e-3;
        image.hardware = true;
        results_.drawn(std::move(image));
    }
    void give_up() override {}

  private:
    Results results_;
};

/// Whether the test that runs draws.
inline bool draws() {
    const auto* suite = testing::UnitTest::GetInstance()->current_test_suite();
    return std::string_view(suite->name()).starts_with("Drawn");
}

/// What the scenes of the test that runs draw with.
inline MakePainter painter_of_test() {
    if (draws()) return &make_render_thread;
    return [](Painter::Priority, Painter::Results results) {
        return std::make_unique<Undrawn>(std::move(results));
    };
}

}  // namespace palpate::viewer

// Words over the scene, and the page of a window in which nothing is open.
#include <QLabel>

#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

using HintsInWindow = InWindow;

TEST_F(HintsInWindow, stay_inside_the_scene_however_narrow_it_is) {
    feel("synthetic:sphere:32x32x32");
    const Scene& scene = window_->views().scene();
    const auto& hint = part<QLabel>("hint");
    const auto inside = [&] { return scene.rect().contains(hint.geometry()); };
    window_->resize(1, 1);
    press(Qt::Key_Space);
    wait_until([&] { return hint.isVisible(); });
    EXPECT_GT(hint.fontMetrics().horizontalAdvance(hint.text()), scene.width())
        << "too wide for one line: " << hint.text().toStdString();
    wait_until(inside);
    EXPECT_GE(hint.height(), hint.heightForWidth(hint.width())) << "all lines are seen";
    // With more room it is one line again.
    window_->resize(1060, 720);
    wait_until([&] { return inside() && hint.height() < 2 * hint.fontMetrics().height(); });
}

TEST_F(HintsInWindow, an_empty_window_welcomes_again_when_a_volume_cannot_be_felt) {
    run::Setup setup = setup_with("mouse");
    setup.open_device = [](const auto&, const auto&) -> std::unique_ptr<Device> {
        throw std::runtime_error("no device today");
    };
    open_window(setup);
    auto& welcome = part<QWidget>("welcome");
    EXPECT_TRUE(welcome.isVisible());
    window_->files().open_path("synthetic:sphere:32x32x32");
    viewer::wait_until([&] { return window_->messages().problem() == "no device today"; });
    EXPECT_TRUE(welcome.isVisible());
    // Also where something was felt before.
    open_window("mouse");
    feel("synthetic:sphere:32x32x32");
    EXPECT_FALSE(part<QWidget>("welcome").isVisible());
    window_->content().close();
    wait_until([&] { return part<QWidget>("welcome").isVisible(); });
    EXPECT_FALSE(window_->views().isVisible());
    feel("synthetic:sphere:24x24x24");
    EXPECT_FALSE(part<QWidget>("welcome").isVisible());
    EXPECT_TRUE(window_->views().isVisible());
}

}  // namespace
}  // namespace palpate::viewer::test

// Compares pictures of the whole window with committed references.
#include <QAction>
#include <QLabel>
#include <QPushButton>

#include "palpate/io/sample_volume.hpp"
#include "viewer/references.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class DrawnReferences : public InWindow {
  protected:
    /// As large as in the committed pictures.
    void SetUp() override {
        InWindow::SetUp();
        window_->resize(1280, 860);
    }

    /// Half as large: letters count less.
    void expect_as(const std::string& name) {
        wait_until_settled();
        for (int i = 0; i < 8; ++i) window_->tick();  // numbers follow a few times a second
        wait_until_settled();
        const QImage image = window_->grab().toImage();
        expect_as_committed(
            image.scaled(image.size() / 2, Qt::IgnoreAspectRatio, Qt::SmoothTransformation)
                .convertToFormat(QImage::Format_RGB32),
            name);
    }
};

TEST_F(DrawnReferences, welcome) {
    wait_until([&] { return part<QLabel>("welcome_devices").text().contains("mouse"); });
    expect_as("welcome");
}

TEST_F(DrawnReferences, first_contact) {
    feel("synthetic:sphere:48x48x48");
    Scene& scene = window_->views().scene();
    QTest::mouseClick(&scene, Qt::LeftButton, {}, scene.rect().center() + QPoint(70, -50));
    wait_until([&] { return !window_->probe().travelling(); });
    turn_wheel(scene, 4);
    wait_for_hand();
    wait_for_ticks(2);
    ASSERT_GT(force(), 0.3);
    expect_as("first_contact");
}

TEST_F(DrawnReferences, several_surfaces) {
    feel(io::sample_volume_path().string());
    QTest::mouseClick(&part<QPushButton>("add_surface"), Qt::LeftButton);
    expect_as("several_surfaces");
}

TEST_F(DrawnReferences, overlay) {
    feel("synthetic:sphere:48x48x48");
    write_segmentation(scratch_.path() / "ball.seg.nrrd");
    window_->panel().overlay_controls().open(
        run::source_named((scratch_.path() / "ball.seg.nrrd").string()));
    wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
    set(window_->views(), &Shown::crosshair, {3, 3, 3});
    expect_as("overlay");
}

TEST_F(DrawnReferences, an_edit_under_way) {
    feel("synthetic:sphere:48x48x48");
    press_until_force();
    press(Qt::Key_B);
    const auto version = [&] { return window_->live()->data().editor().state().version; };
    wait_until([&] { return version() > 0 && force() < 0.01; });  // it is carved away
    expect_as("edit");
}

}  // namespace
}  // namespace palpate::viewer::test

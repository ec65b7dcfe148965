// Words over the scene, and the page of a window in which nothing is open.
#include <QComboBox>
#include <QLabel>

#include "palpate/io/volume_file.hpp"
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

/// A plate of one sample, of a slope between 0 and 200.
Volume slice_of_ramp() {
    std::vector<std::uint8_t> samples(24 * 24);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = std::uint8_t(8 * (i % 24));
    return Volume(Geometry{.size = {24, 24, 1}}, samples);
}

/// One label in each half of a ball.
Volume labels_in_ball(std::uint8_t left, std::uint8_t right) {
    std::vector<std::uint8_t> labels;
    for (int i = 0; i < 24 * 24 * 24; ++i) {
        const Vec3 at = Vec3(i % 24, i / 24 % 24, i / 576) - Vec3::Constant(11.5);
        labels.push_back(at.norm() > 9 ? 0 : at[0] < 0 ? left : right);
    }
    return Volume(Geometry{.size = Index3::Constant(24)}, labels);
}

TEST_F(HintsInWindow, offer_dequantizing_for_a_mask_and_not_for_labels) {
    io::write_volume(labels_in_ball(2, 2), scratch_.path() / "mask.nrrd");
    feel(scratch("mask.nrrd").toStdString());
    EXPECT_TRUE(part<QLabel>("terraces").text().contains("two values"));
    io::write_volume(labels_in_ball(1, 2), scratch_.path() / "labels.nrrd");
    feel(scratch("labels.nrrd").toStdString());
    EXPECT_EQ(part<QLabel>("terraces").text(), "");
}

TEST_F(HintsInWindow, tell_why_a_single_slice_has_holes) {
    io::write_volume(slice_of_ramp(), scratch_.path() / "slice.nrrd");
    feel(scratch("slice.nrrd").toStdString());
    auto& note = part<QLabel>("one_slice");
    EXPECT_TRUE(note.isVisible());
    EXPECT_TRUE(note.text().contains("single slice"));
    auto& field = part<QComboBox>("field");
    field.setFocus();
    QTest::keyClick(&field, Qt::Key_Up);
    wait_until([&] { return !note.isVisible(); });
    EXPECT_EQ(window_->live()->field().interpolation(), Interpolation::linear);
    QTest::keyClick(&field, Qt::Key_Down);
    wait_until([&] { return note.isVisible(); });
    feel("synthetic:sphere:24x24x24");
    EXPECT_FALSE(note.isVisible());
}

}  // namespace
}  // namespace palpate::viewer::test

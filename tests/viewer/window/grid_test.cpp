// Volumes of which the file does not say how they lie in the body, or their spacing.
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QPointer>
#include <QPushButton>
#include <QRegularExpression>
#include <QSlider>
#include <QStatusBar>

#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/slices/plane.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/scenes/volumes.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class Grid : public InWindow {
  protected:
    void write(const char* name, const char* fields) {
        const Index3 size(20, 24, 28);
        const Volume ball = scenes::make_volume("sphere:20x24x28").volume;
        std::ofstream out(scratch_.path() / name, std::ios::binary);
        out << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 20 24 28\nencoding: raw\n"
            << fields << "\n";
        out.write(static_cast<const char*>(ball.data()), std::streamsize(ball.bytes()));
        ASSERT_EQ(ball.geometry().size, size);
    }
    /// On the same grid: a label on one side.
    void put_labels(const char* name, const char* fields) {
        std::ofstream out(scratch_.path() / name, std::ios::binary);
        out << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 20 24 28\nencoding: raw\n"
            << fields << "\n";
        for (int i = 0; i < 20 * 24 * 28; ++i) out.put(i % 20 < 8 ? '\1' : '\0');
    }
    QStringList titles() {
        QStringList all;
        for (const int axis : {2, 1, 0}) all << window_->views().slice(axis).title();
        return all;
    }
    const Geometry& grid() { return window_->live()->field().geometry(); }
    QPushButton& badge() { return part<QPushButton>("missing_grid"); }
};

TEST_F(Grid, that_is_not_oriented_is_shown_with_neutral_names_until_it_is_assigned) {
    write("a.nrrd", "spacings: 1 1 2\n");
    feel(scratch("a.nrrd").toStdString());
    EXPECT_EQ(titles(), QStringList({"XY", "XZ", "YZ"}));
    EXPECT_TRUE(badge().isVisible());
    EXPECT_EQ(badge().text(), "No orientation in the file");
    EXPECT_EQ(part<QAction>("view_front").text(), "From -Y");
    const double level = window_->live()->isovalue() + 3;
    window_->content().effect().request(command::Isovalue{level});
    wait_for_ticks(3);
    QTest::mouseClick(&badge(), Qt::LeftButton);
    auto& dialog = part<QDialog>("grid");
    activate(dialog);
    const auto choose = [&](const char* axis, Qt::Key first_letter, int times) {
        auto& box = part<QComboBox>(axis);
        box.setFocus();
        for (int i = 0; i < times; ++i) QTest::keyClick(&box, first_letter);
    };
    // Of "not known, L, R, P, A, S, I" these.
    choose("grid_side_X", Qt::Key_Down, 2);
    choose("grid_side_Y", Qt::Key_Down, 6);
    choose("grid_side_Z", Qt::Key_Down, 4);
    QTest::mouseClick(&part<QPushButton>("grid_mirror"), Qt::LeftButton);
    QTest::keyClick(&dialog, Qt::Key_Return);
    wait_until([&] { return window_->live() && grid().oriented && window_->settled(); });
    EXPECT_EQ(io::orientation_of(grid()), "LIA");
    EXPECT_EQ(grid().spacing, Vec3(1, 1, 2));
    EXPECT_EQ(titles(), QStringList({"Coronal", "Axial", "Sagittal"}));
    EXPECT_LT(window_->views().slice(1).y(), window_->views().slice(2).y()) << "axial above";
    EXPECT_FALSE(badge().isVisible());
    EXPECT_EQ(window_->live()->isovalue(), level) << "felt as before";
    EXPECT_EQ(part<QAction>("view_front").text(), "From the front");
    window_->files().save_session(scratch("case.json"));
    feel("synthetic:sphere:20x20x20");
    window_->files().open_path(scratch("case.json"));
    wait_until([&] { return window_->live() && grid().size[1] == 24 && window_->settled(); });
    EXPECT_EQ(io::orientation_of(grid()), "LIA");
    EXPECT_TRUE(grid().oriented);
}

TEST_F(Grid, that_is_assigned_takes_its_labels_along) {
    write("a.nrrd", "spacings: 1 1 2\n");
    feel(scratch("a.nrrd").toStdString());
    put_labels("l.nrrd", "spacings: 1 1 2\n");
    auto& overlays = window_->panel().overlay_controls();
    overlays.open(run::source_named(scratch("l.nrrd").toStdString()));
    wait_until([&] { return overlays.overlay() != nullptr; });
    wait_until_settled();
    QTest::mouseClick(&on_page<QPushButton>("feel_labels"), Qt::LeftButton);
    wait_until([&] { return window_->live()->settings().layers != nullptr; });
    QTest::mouseClick(&badge(), Qt::LeftButton);
    for (const auto& [axis, times] : {std::pair("X", 2), std::pair("Y", 6), std::pair("Z", 4)}) {
        auto& box = part<QComboBox>((std::string("grid_side_") + axis).c_str());
        box.setFocus();
        for (int i = 0; i < times; ++i) QTest::keyClick(&box, Qt::Key_Down);
    }
    QTest::keyClick(&part<QDialog>("grid"), Qt::Key_Return);
    wait_until([&] {
        const run::Run* live = window_->live();
        return live && grid().oriented && live->settings().layers && overlays.overlay() &&
               window_->settled();
    });
    EXPECT_EQ(io::orientation_of(grid()), "RIA");
    EXPECT_EQ(overlays.overlay()->volume.geometry(), grid());
    EXPECT_EQ(window_->live()->settings().layers->labels->geometry(), grid());
    EXPECT_EQ(overlays.warning(), "");
    EXPECT_FALSE(badge().isVisible());
}

TEST_F(Grid, that_is_told_on_a_badge_moves_no_picture) {
    write("d.nrrd",
          "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: space space space\n");
    feel(scratch("d.nrrd").toStdString());
    put_labels("l.nrrd", "spacings: 1 1 1\n");
    Scene& scene = window_->views().scene();
    const auto place = [&] { return QRect(scene.mapTo(window_.get(), QPoint()), scene.size()); };
    const QRect before = place();
    auto& overlays = window_->panel().overlay_controls();
    overlays.open(run::source_named(scratch("l.nrrd").toStdString()));
    wait_until([&] { return badge().isVisible(); });
    wait_until_settled();
    EXPECT_EQ(place(), before);
    // Words at the upper edge are not covered.
    part<Note>("force_part_message").say(QString("Word upon word ").repeated(20));
    auto& notes = part<QLabel>("notes");
    wait_until(
        [&] { return notes.isVisible() && !notes.geometry().intersects(badge().geometry()); });
    SlicePane& slice = window_->views().slice(1);
    QTest::mouseDClick(&slice, Qt::LeftButton, {}, slice.rect().center());
    wait_until([&] { return badge().parentWidget() == &slice && badge().isVisible(); });
    wait_until([&] { return badge().y() > slice.height() / 2; });
    EXPECT_TRUE(slice.rect().contains(badge().geometry()));
    QTest::mouseClick(&badge(), Qt::LeftButton);
    wait_until([&] { return part<QLabel>("overlay_beside").isVisible(); });
}

TEST_F(Grid, that_only_the_volume_or_the_overlay_has_is_told) {
    write("d.nrrd",
          "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: space space space\n");
    feel(scratch("d.nrrd").toStdString());
    put_labels("l.nrrd", "spacings: 1 1 1\n");
    auto& overlays = window_->panel().overlay_controls();
    overlays.open(run::source_named(scratch("l.nrrd").toStdString()));
    wait_until([&] { return overlays.overlay() != nullptr; });
    wait_until_settled();
    EXPECT_EQ(badge().text(), "The overlay may lie elsewhere");
    EXPECT_TRUE(badge().toolTip().contains("l.nrrd does not give its orientation"));
    part<QTabWidget>("tabs").setCurrentIndex(0);
    QTest::mouseClick(&badge(), Qt::LeftButton);
    wait_until([&] { return part<QLabel>("overlay_beside").isVisible(); });
    EXPECT_EQ(part<QLabel>("overlay_beside").text(), badge().toolTip());
    overlays.close_overlay();
    EXPECT_FALSE(badge().isVisible());
}

TEST_F(Grid, without_a_spacing_says_so_and_takes_one) {
    write("c.nrrd", "");
    feel(scratch("c.nrrd").toStdString());
    EXPECT_EQ(badge().text(), "No orientation and no spacing in the file");
    window_->resize(800, 560);
    part<QAction>("four").trigger();
    wait_until_settled();
    const Scene& scene = window_->views().scene();
    const auto seen = [&](const QWidget& one) {
        return QRect(one.mapTo(&window_->views(), QPoint()), one.size());
    };
    EXPECT_TRUE(seen(scene).contains(seen(badge())));
    for (const int axis : {0, 1, 2}) {
        const SlicePane& pane = window_->views().slice(axis);
        EXPECT_TRUE(pane.isVisible());
        EXPECT_FALSE(seen(pane).intersects(seen(badge()))) << "no words of a pane are covered";
    }
    press(Qt::Key_Space);
    auto& hint = part<QLabel>("hint");
    wait_until([&] { return hint.isVisible(); });
    EXPECT_FALSE(seen(hint).intersects(seen(badge()))) << "both can be read";
    press(Qt::Key_Space);
    SlicePane& pane = window_->views().slice(2);
    const auto ends_in = [&](const char* unit) {
        measure(pane);
        EXPECT_TRUE(window_->statusBar()->currentMessage().endsWith(QString(" ") + unit));
        wait_until([&] {
            return part<QLabel>("contact").text().contains(QString(" %1 in the vol").arg(unit)) &&
                   part<QLabel>("readout").text().endsWith(QString("/%1").arg(unit));
        });
        EXPECT_TRUE(QString::fromStdString(position_text(slice_plane(grid(), 2), Vec3::Constant(3)))
                        .endsWith(unit));
    };
    ends_in("voxel");
    answer(QMessageBox::Discard);
    QTest::mouseClick(&badge(), Qt::LeftButton);
    part<QDoubleSpinBox>("grid_spacing_Z").setValue(2.5);
    QTest::keyClick(&part<QDialog>("grid"), Qt::Key_Return);
    wait_until([&] { return window_->live() && grid().measured && window_->settled(); });
    EXPECT_EQ(grid().spacing, Vec3(1, 1, 2.5));
    ends_in("mm");
    EXPECT_EQ(badge().text(), "No orientation in the file");
    EXPECT_TRUE(badge().isVisible());
}

TEST_F(Grid, of_a_microscope_is_told_in_micrometres) {
    write("d.nrrd",
          "space directions: (0.0002,0,0) (0,0.0002,0) (0,0,0.0002)\nspace: RAS\n"
          "kinds: space space space\n");
    feel(scratch("d.nrrd").toStdString());
    press_until_force();
    for (const char* name : {"depth", "contact", "readout"}) {
        auto& label = part<QLabel>(name);
        wait_until([&] { return label.text().contains("µm"); });
        EXPECT_FALSE(label.text().contains(QRegularExpression("\\b0\\.0+ (mm|µm)")))
            << name << ": " << label.text().toStdString();
    }
    EXPECT_TRUE(part<QLabel>("readout").text().endsWith("/µm"));
    const auto type = [&](const char* name, const char* number) {
        auto& box = on_page<NumberBox>(name);
        EXPECT_TRUE(box.suffix().endsWith("µm")) << name;
        box.setFocus();
        QTest::keyClick(&box, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(&box, number);
        QTest::keyClick(&box, Qt::Key_Return);
    };
    type("texture_amplitude_box", "0.25");
    type("texture_wavelength_box", "1.5");
    const auto settings = [&] { return window_->content().effect().settings(); };
    EXPECT_NEAR(settings().force.texture.amplitude, 0.25e-3, 1e-12);
    EXPECT_NEAR(settings().force.texture.wavelength, 1.5e-3, 1e-12);
    auto& slider = on_page<QSlider>("texture_amplitude_slider");
    slider.setFocus();
    QTest::keyClick(&slider, Qt::Key_End);
    EXPECT_NEAR(settings().force.texture.amplitude, 0.5e-3, 1e-12) << "of the volume's unit";
    press(Qt::Key_Space);  // forces off
    on_page<QComboBox>("layers");
    QTest::mouseClick(&part<QPushButton>("add_layer"), Qt::LeftButton);
    wait_until([&] { return settings().layers != nullptr; });
    type("layers_closing_box", "2");
    EXPECT_NEAR(settings().layers->closing, 2e-3, 1e-12);
}

TEST_F(Grid, of_a_body_or_of_no_file_needs_no_words) {
    feel("synthetic:sphere:20x20x20");
    EXPECT_FALSE(badge().isVisible());
    EXPECT_EQ(titles(), QStringList({"XY", "XZ", "YZ"}));
    write("d.nrrd",
          "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: space space space\n");
    feel(scratch("d.nrrd").toStdString());
    EXPECT_FALSE(badge().isVisible());
    EXPECT_EQ(titles(), QStringList({"Axial", "Coronal", "Sagittal"}));
}

TEST_F(Grid, that_the_file_gives_cannot_be_taken_away_and_is_not_read_again_unchanged) {
    write("e.nrrd",
          "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: space space space\n");
    feel(scratch("e.nrrd").toStdString());
    const auto* felt = window_->live();
    auto& choose = part<QAction>("choose_grid");
    wait_until([&] { return choose.isEnabled(); });
    choose.trigger();
    EXPECT_EQ(part<QComboBox>("grid_side_X").count(), 6) << "not known is no choice";
    EXPECT_EQ(part<QComboBox>("grid_side_X").currentText(), "to the right (R)");
    EXPECT_FALSE(part<QCheckBox>("grid_measured").isEnabled());
    const QPointer<QDialog> dialog = &part<QDialog>("grid");
    QTest::keyClick(dialog, Qt::Key_Return);
    wait_until([&] { return !dialog || !dialog->isVisible(); });
    EXPECT_TRUE(window_->settled());
    EXPECT_EQ(window_->live(), felt);
}

}  // namespace
}  // namespace palpate::viewer::test

// The whole window: files dropped, recent, raw, cancelled; pictures.
#include <sys/stat.h>
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QFile>
#include <QFileDialog>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QTableWidget>
#include <cmath>
#include <fstream>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/screenshot.hpp"
#include "apps/viewer/window/tool_controls.hpp"
#include "io/volume_dicom_slice.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/scenes/volumes.hpp"
#include "viewer/window/held_reader.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class Files : public InWindow {
  protected:
    /// A volume in a file, of this size.
    QString file_of(int size, const char* name) {
        const std::string n = std::to_string(size);
        const auto source = run::source_named("synthetic:sphere:" + n + "x" + n + "x" + n);
        io::write_volume(run::load(source).volume, scratch_.path() / name);
        return scratch(name);
    }
};

TEST_F(Files, a_dropped_file_is_opened) {
    drop(file_of(24, "dropped.mha"));
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(window_->live()->field().geometry().size, Index3(24, 24, 24));
}

TEST_F(Files, recent_files_are_listed_newest_first_and_open_again) {
    const QString first = file_of(16, "first.nrrd"), second = file_of(20, "second.nrrd");
    feel(first.toStdString());
    feel(second.toStdString());
    wait_until([&] { return window_->live()->field().geometry().size[0] == 20; });
    auto& menu = part<QMenu>("recent");
    Q_EMIT menu.aboutToShow();
    ASSERT_GE(menu.actions().size(), 2);
    EXPECT_EQ(menu.actions()[0]->text(), second);
    EXPECT_EQ(menu.actions()[1]->text(), first);
    menu.actions()[1]->trigger();
    wait_until(
        [&] { return window_->live() && window_->live()->field().geometry().size[0] == 16; });
}

TEST_F(Files, loading_can_be_cancelled_and_what_was_felt_goes_on) {
    feel("synthetic:sphere:32x32x32");
    const run::Run* before = window_->live();
    const run::Source other = run::source_named(file_of(24, "other.nrrd").toStdString());
    const HeldReader reader(scratch_.path());
    window_->files().open_volume(other);
    cancel_task();
    wait_until_settled();
    EXPECT_EQ(strip(), nullptr);
    EXPECT_EQ(window_->live(), before);
    EXPECT_EQ(window_->live()->field().geometry().size[0], 32);
    EXPECT_TRUE(window_->messages().problem().isEmpty());
}

TEST_F(Files, that_block_leave_the_window_free_and_can_be_given_up) {
    feel("synthetic:sphere:32x32x32");
    const run::Run* before = window_->live();
    // Without a writer, a pipe never has anything to read: like a disk of the network that hangs.
    for (const char* name : {"session.json", "tool.csv"}) {
        SCOPED_TRACE(name);
        ASSERT_EQ(::mkfifo((scratch_.path() / name).c_str(), 0600), 0);
        const bool is_tool = QString(name).endsWith(".csv");
        is_tool ? window_->panel().tool_controls().open(scratch(name)) : drop(scratch(name));
        wait_for_ticks(100);
        EXPECT_FALSE(window_->settled());
        cancel_task();
        wait_until([&] { return strip() == nullptr; });
        EXPECT_EQ(window_->live(), before);
        EXPECT_EQ(window_->messages().problem(), "");
    }
    // Nor does one that is still waited for keep the window from closing.
    window_->files().open_path(scratch("session.json"));
    window_.reset();
}

TEST_F(Files, a_volume_is_dequantized_and_felt_at_the_same_level) {
    io::write_volume(scenes::ball(Index3::Constant(40)), scratch_.path() / "ball.nrrd");
    feel(scratch("ball.nrrd").toStdString());
    window_->content().effect().request(command::Isovalue{100.25});
    auto& box = part<QCheckBox>("dequantize");
    ASSERT_TRUE(box.isEnabled());
    const auto type = [&] { return window_->live()->field().volume().type(); };
    EXPECT_EQ(type(), SampleType::uint8);
    box.click();
    wait_until([&] { return window_->live() && type() == SampleType::float32; });
    EXPECT_TRUE(box.isChecked());
    EXPECT_EQ(window_->live()->isovalue(), 100.25);
    box.click();
    wait_until([&] { return window_->live() && type() == SampleType::uint8; });
    EXPECT_FALSE(box.isChecked());
    EXPECT_EQ(window_->live()->isovalue(), 100.25);
}

TEST_F(Files, of_several_series_one_is_chosen_by_its_picture) {
    for (int i = 0; i < 9; ++i) {
        io::test::TestSlice slice;
        slice.series = i < 3 ? "1.2.3.1" : "1.2.3.2";
        slice.description = i < 3 ? "HEAD" : "CHEST";
        slice.number = i;
        slice.position = "0\\0\\" + std::to_string(i);
        slice.columns = slice.rows = 20;
        io::test::put_slice(scratch_.path() / ("slice" + std::to_string(i)), slice);
    }
    const auto choose = [&](int row) {
        window_->files().open_path(scratch("."));
        wait_until([&] { return window_->findChild<QDialog*>("choose-series"); });
        auto& table = part<QTableWidget>("series");
        activate(table);
        EXPECT_EQ(table.rowCount(), 2);
        EXPECT_EQ(table.item(1, 1)->text(), "CHEST");
        EXPECT_EQ(table.item(1, 3)->text(), "6");
        EXPECT_FALSE(
            qobject_cast<QLabel*>(table.cellWidget(1, 0))->pixmap(Qt::ReturnByValue).isNull());
        EXPECT_EQ(table.currentRow(), 1) << "the one with the most slices";
        const QPoint place = table.visualItemRect(table.item(row, 1)).center();
        QTest::mouseClick(table.viewport(), Qt::LeftButton, {}, place);
        QTest::keyClick(&table, Qt::Key_Return);
        wait_until([&] { return window_->live() && window_->settled(); });
    };
    const auto slices = [&] { return window_->live()->field().geometry().size[2]; };
    choose(1);
    EXPECT_EQ(slices(), 6);
    choose(0);
    wait_until([&] { return slices() == 3; });
    EXPECT_TRUE(window_->messages().problem().isEmpty());
}

TEST_F(Files, a_raw_file_is_opened_once_the_dialog_knows_its_size) {
    // A bright disk in the middle of each slice: 12 x 10 x 8 big-endian samples after 5 bytes.
    std::string bytes = "head:";
    for (int z = 0; z < 8; ++z) {
        for (int y = 0; y < 10; ++y) {
            for (int x = 0; x < 12; ++x) {
                const bool in = std::hypot(x - 5.5, y - 4.5) < 3;
                bytes += {in ? '\x02' : '\x00', '\x01'};
            }
        }
    }
    std::ofstream(scratch_.path() / "samples.raw", std::ios::binary) << bytes;
    window_->files().open_path(scratch("samples.raw"));
    wait_until([&] { return window_->findChild<QDialog*>("raw"); });
    const auto set = [&](const char* name, int value) { part<NumberBox>(name).setValue(value); };
    QPushButton* open = nullptr;
    for (auto* button : part<QDialog>("raw").findChildren<QPushButton*>()) {
        if (button->text().contains("Open")) open = button;
    }
    ASSERT_NE(open, nullptr);
    EXPECT_FALSE(open->isEnabled()) << "256^3 samples are more than the file holds";
    set("size0", 12);
    set("size1", 10);
    set("size2", 8);
    QTest::keyClicks(&part<QComboBox>("raw_type"), "uint16");
    QTest::keyClick(&part<QComboBox>("raw_order"), Qt::Key_Down);
    EXPECT_FALSE(open->isEnabled()) << "the header is left over";
    EXPECT_TRUE(part<QLabel>("raw_verdict").text().contains("5 more"));
    QTest::mouseClick(&part<QPushButton>("raw_skip_rest"), Qt::LeftButton);
    EXPECT_EQ(part<NumberBox>("raw_skip").value(), 5);
    const QImage slice = part<QLabel>("raw_picture").pixmap(Qt::ReturnByValue).toImage();
    ASSERT_FALSE(slice.isNull());
    EXPECT_EQ(slice.pixelColor(slice.rect().center()).red(), 255);
    EXPECT_EQ(slice.pixelColor(2, 2).red(), 0);
    part<QDialog>("raw").grab().save(QString(PALPATE_PICTURES) + "/raw-dialog.png");
    ASSERT_TRUE(open->isEnabled());
    QTest::mouseClick(open, Qt::LeftButton);
    wait_until([&] { return window_->live() && window_->settled(); });
    const Volume& volume = window_->live()->field().volume();
    EXPECT_EQ(volume.geometry().size, Index3(12, 10, 8));
    EXPECT_EQ(volume.minimum(), 0x0001);
    EXPECT_EQ(volume.maximum(), 0x0201);
}

TEST_F(Files, the_surface_is_saved_as_a_mesh) {
    feel("synthetic:sphere:32x32x32");
    window_->saver().save_surface(scratch("ball.xyz"));
    EXPECT_TRUE(window_->messages().problem().contains("ply"));
    window_->saver().save_surface(scratch("ball.obj"));
    wait_until([&] { return !window_->saver().saving(); });
    std::ifstream file(scratch_.path() / "ball.obj");
    int vertices = 0, normals = 0, triangles = 0;
    for (std::string line; std::getline(file, line);) {
        vertices += line.starts_with("v ");
        normals += line.starts_with("vn ");
        triangles += line.starts_with("f ");
    }
    EXPECT_GT(triangles, 1000);
    EXPECT_EQ(vertices - triangles / 2, 2) << "a closed surface without handles";
    EXPECT_EQ(normals, vertices);
}

TEST_F(Files, a_surface_of_many_triangles_is_simplified_if_one_likes) {
    feel("synthetic:torus:48x48x24");
    SaveController& editing = window_->saver();
    const auto saved = [&](const char* name) {
        wait_until([&] { return !editing.saving(); });
        return io::read_mesh(scratch(name).toStdString());
    };
    const auto handles = [](const SurfaceMesh& mesh) {  // of a closed surface
        const auto vertices = static_cast<int>(mesh.vertices.size());
        return 1 - (vertices - static_cast<int>(mesh.triangles.size()) / 2) / 2;
    };
    editing.save_surface(scratch("without-a-question.ply"));
    const SurfaceMesh all = saved("without-a-question.ply");
    const std::size_t many = all.triangles.size() / 4;
    editing.set_many_triangles(many);
    answer(QMessageBox::Yes);
    editing.save_surface(scratch("simple.ply"));
    const SurfaceMesh simple = saved("simple.ply");
    EXPECT_LT(simple.triangles.size(), 1.05 * double(many));
    EXPECT_GT(simple.triangles.size(), 0.9 * double(many));
    EXPECT_EQ(handles(all), 1);
    EXPECT_EQ(handles(simple), 1);
    EXPECT_NEAR(enclosed_volume(simple) / enclosed_volume(all), 1, 0.02);
    answer(QMessageBox::No);
    editing.save_surface(scratch("all.ply"));
    EXPECT_EQ(saved("all.ply").triangles, all.triangles);
    answer(QMessageBox::Cancel);
    editing.save_surface(scratch("none.ply"));
    wait_until([&] { return !editing.saving(); });
    EXPECT_FALSE(QFile::exists(scratch("none.ply")));
}

TEST_F(Files, a_single_slice_is_seen_face_on) {
    Geometry geometry{Index3(24, 20, 1)};
    std::vector<std::uint8_t> disk(480);
    for (int i = 0; i < 480; ++i)
        disk[std::size_t(i)] = std::hypot(i % 24 - 12, i / 24 - 8) < 6 ? 200 : 0;
    io::write_volume(Volume(geometry, std::move(disk)), scratch_.path() / "slice.nrrd");
    feel(scratch("slice.nrrd").toStdString());
    const ViewAxes axes = axes_of(window_->views().scene().camera());
    EXPECT_LT((axes.right - Vec3::UnitX()).norm(), 1e-9);
    EXPECT_LT((axes.up + Vec3::UnitY()).norm(), 1e-9) << "rows from above";
    save("slice");
}

TEST_F(Files, a_thin_stack_is_seen_face_on) {
    Geometry geometry{Index3(40, 36, 11)};
    std::vector<std::uint8_t> ball(40 * 36 * 11);
    for (int i = 0; i < int(ball.size()); ++i)
        ball[std::size_t(i)] = std::hypot(i % 40 - 20, i / 40 % 36 - 18) < 12 ? 200 : 0;
    io::write_volume(Volume(geometry, std::move(ball)), scratch_.path() / "stack.nrrd");
    feel(scratch("stack.nrrd").toStdString());
    const ViewAxes axes = axes_of(window_->views().scene().camera());
    EXPECT_LT((axes.right - Vec3::UnitX()).norm(), 1e-9);
    EXPECT_LT((axes.up + Vec3::UnitY()).norm(), 1e-9) << "rows from above";
}

TEST_F(Files, a_stack_of_a_microscope_is_seen_along_its_thin_axis) {
    Geometry geometry{Index3(40, 36, 17)};
    geometry.spacing = {0.25e-3, 0.25e-3, 0.3e-3};
    geometry.oriented = false;
    std::vector<std::uint8_t> ball(40 * 36 * 17);
    for (int i = 0; i < int(ball.size()); ++i)
        ball[std::size_t(i)] = std::hypot(i % 40 - 20, i / 40 % 36 - 18) < 12 ? 200 : 0;
    io::write_volume(Volume(geometry, std::move(ball)), scratch_.path() / "stack.nrrd");
    feel(scratch("stack.nrrd").toStdString());
    ASSERT_FALSE(window_->live()->field().geometry().oriented);
    EXPECT_LT((axes_of(window_->views().scene().camera()).right - Vec3::UnitX()).norm(), 1e-9);
}

TEST_F(Files, dialogs_do_not_begin_in_the_folder_of_the_sample) {
    feel(file_of(24, "ball.mha").toStdString());
    feel(io::sample_volume_path().string());
    QString folder;
    in_file_dialog([&] { press(Qt::Key_R, Qt::ControlModifier); },
                   [&](QLineEdit& line) {
                       auto* dialog = qobject_cast<QFileDialog*>(line.window());
                       folder = dialog->directory().absolutePath();
                       dialog->reject();
                   });
    EXPECT_EQ(folder, QString::fromStdString(scratch_.path().string()));
}

TEST_F(Files, the_first_view_shows_the_whole_volume_in_a_window_of_any_shape) {
    window_->resize(1060, 1000);
    feel("synthetic:cylinder:64x24x24");
    const Scene& scene = window_->views().scene();
    const auto fitting = [&] {
        const pictures::Camera camera = scene.camera();
        const Geometry& grid = window_->live()->field().geometry();
        return whole(grid, {camera.towards_viewer, camera.up}, scene.view_size()).half_height;
    };
    EXPECT_NEAR(scene.camera().half_height, fitting(), 1e-9);
    press(Qt::Key_F6);  // another shape
    wait_until_settled();
    EXPECT_NEAR(scene.camera().half_height, fitting(), 1e-9);
    press(Qt::Key_3);
    EXPECT_NEAR(scene.camera().half_height, fitting(), 1e-9) << "from another side";
}

TEST_F(Files, several_at_once_and_addresses_are_dropped_knowingly) {
    const QUrl file = QUrl::fromLocalFile(file_of(24, "one.mha"));
    drop({file, file});
    EXPECT_TRUE(window_->messages().problem().startsWith("2 files"));
    EXPECT_FALSE(window_->files().loading()) << "not one slice of many";
    drop({QUrl("http://127.0.0.1:1/nothing.png")});
    viewer::wait_until([&] { return window_->messages().problem().contains("127.0.0.1"); });
}

using DrawnFiles = Files;

TEST_F(DrawnFiles, pictures_of_scene_and_window_are_what_is_seen) {
    feel("synthetic:torus:48x48x24");
    window_->save_picture(scratch("scene.png"), false);
    window_->save_picture(scratch("window.png"), true);
    const QImage scene(scratch("scene.png")), whole(scratch("window.png"));
    EXPECT_EQ(scene.size(), window_->views().scene().size() * window_->devicePixelRatioF());
    EXPECT_EQ(whole.size(), window_->size() * window_->devicePixelRatioF());
    // The scene lies in the window, pixel for pixel.
    const QPoint corner = window_->views().scene().mapTo(window_.get(), {0, 0});
    int different = 0;
    for (int y = 0; y < scene.height(); y += 3) {
        for (int x = 0; x < scene.width(); x += 3) {
            const QColor a = scene.pixelColor(x, y);
            const QColor b = whole.pixelColor(corner.x() + x, corner.y() + y);
            if (std::abs(a.red() - b.red()) + std::abs(a.green() - b.green()) > 12) ++different;
        }
    }
    EXPECT_LT(different, 30);
    EXPECT_THROW(window_->save_picture("/no/such/folder/a.png", false), io::OutputError);
}

TEST_F(Files, screenshot_waits_for_the_hand_writes_and_closes) {
    window_->files().open_path("synthetic:sphere:32x32x32");
    const Screenshot screenshot(*window_, scratch("shot.png"), 0.3);
    wait_until([&] { return !window_->isVisible(); });
    EXPECT_EQ(screenshot.status(), 0);
    EXPECT_FALSE(QImage(scratch("shot.png")).isNull());
}

TEST_F(Files, measurements_are_not_lost_without_a_question) {
    feel("synthetic:sphere:48x48x48");
    measure(window_->views().slice(2));
    ASSERT_EQ(window_->measuring().measurements().size(), 1U);
    answer(QMessageBox::Cancel);
    EXPECT_FALSE(window_->close());
    answer(QMessageBox::Save);
    typing(scratch("case.json"), [&] { EXPECT_FALSE(window_->close()) << "it is saved first"; });
    wait_until([&] { return !window_->isVisible(); });
    EXPECT_EQ(read_session(scratch("case.json").toStdString()).measurements.size(), 1U);
    open_window("mouse");
    window_->files().open_path(scratch("case.json"));
    wait_until([&] { return window_->live() && window_->settled(); });
    EXPECT_EQ(window_->measuring().measurements().size(), 1U);
    EXPECT_TRUE(window_->close()) << "they are in the session";
}

TEST_F(Files, a_session_brings_back_its_step_budget) {
    feel("synthetic:sphere:48x48x48");
    window_->files().save_session(scratch("day.json"));
    SessionFile session = read_session(scratch("day.json").toStdString());
    session.settings->proxy.step_budget = 777;
    write_session(scratch("day.json").toStdString(), session);
    feel("synthetic:torus:32x32x16");
    window_->files().open_path(scratch("day.json"));
    wait_until(
        [&] { return window_->live() && window_->live()->field().geometry().size[0] == 48; });
    EXPECT_EQ(window_->live()->settings().proxy.step_budget, 777);
}

TEST_F(Files, a_session_keeps_its_buttons_unless_the_command_line_names_others) {
    const std::string holds = "simulated:hand=hold,depth=4,seconds=3600";
    const auto feel_by = [&](const RunRequest& request, const QString& path) {
        open_window(request);
        window_->files().open_path(path);
        wait_until([&] { return window_->live() && window_->live()->snapshot(); });
        return window_->live()->setup().buttons;
    };
    RunRequest request{setup_with(holds), {}, {}};
    request.setup.buttons.clutch = {};  // simulated hands have no buttons
    feel_by(request, "synthetic:sphere:48x48x48");
    window_->files().save_session(scratch("day.json"));

    RunRequest usual{setup_with("mouse"), {}, {}};
    EXPECT_EQ(feel_by(usual, scratch("day.json")), request.setup.buttons);
    // They are those of another hand or device in this window as well.
    EXPECT_EQ(window_->content().request().setup.buttons, request.setup.buttons);
    // Of two, the command line may name one.
    usual.buttons.emplace_back(&run::Buttons::deadman, run::ButtonSetup());
    EXPECT_EQ(feel_by(usual, scratch("day.json")), request.setup.buttons);
    usual.buttons.emplace_back(&run::Buttons::clutch, run::UsualButton{});
    EXPECT_EQ(feel_by(usual, scratch("day.json")), run::Buttons{});
}

TEST_F(Files, nobody_is_asked_where_nobody_is_there) {
    for (int i = 0; i < 6; ++i) {
        io::test::TestSlice slice;
        slice.series = i < 3 ? "1.2.3.1" : "1.2.3.2";
        slice.number = i;
        slice.position = "0\\0\\" + std::to_string(i);
        slice.columns = slice.rows = 20;
        io::test::put_slice(scratch_.path() / ("slice" + std::to_string(i)), slice);
    }
    window_->messages().set_unattended();
    run::Source source = run::source_named(scratch(".").toStdString());
    std::get<run::FileSource>(source.from).series = "7";
    window_->files().open_volume(source);
    const Screenshot screenshot(*window_, scratch("shot.png"), 0);
    viewer::wait_until([&] { return !window_->isVisible(); });
    EXPECT_EQ(screenshot.status(), 3);
    EXPECT_TRUE(window_->messages().problem().contains("no DICOM series '7'"));
    EXPECT_EQ(window_->findChild<QDialog*>("choose-series"), nullptr);
}

TEST_F(Files, a_window_of_a_given_size_is_not_that_of_the_next_start) {
    window_->resize(700, 500);
    window_->forget_layout();
    EXPECT_TRUE(window_->close());
    EXPECT_FALSE(QSettings().contains("geometry"));
}

TEST_F(Files, screenshot_of_what_cannot_be_opened_ends_with_its_status) {
    window_->files().open_path(scratch("missing.nrrd"));
    const Screenshot screenshot(*window_, scratch("shot.png"), 0);
    viewer::wait_until([&] { return !window_->isVisible(); });
    EXPECT_EQ(screenshot.status(), 3);
    EXPECT_FALSE(QFile::exists(scratch("shot.png")));
}

TEST_F(Files, that_are_opened_for_a_picture_are_not_those_of_the_next_start) {
    const auto ball = run::load(run::source_named("synthetic:sphere:16x16x16")).volume;
    io::write_volume(ball, scratch_.path() / "a.nrrd");
    for (const bool nothing : {true, false}) {
        remember_nothing(nothing);
        feel((scratch_.path() / "a.nrrd").string());
        EXPECT_EQ(QSettings().contains("recent"), !nothing);
        EXPECT_EQ(QSettings().contains("folder"), !nothing);
    }
}

TEST_F(Files, a_slice_moves_the_hand_with_ctrl_only) {
    feel("synthetic:sphere:48x48x48");
    SlicePane& axial = window_->views().slice(2);
    const QPoint at(axial.width() / 2, axial.height() / 8);
    const Vec3 before = window_->live()->mouse()->aimed();
    QTest::mouseClick(&axial, Qt::LeftButton, {}, at);
    QTest::mouseDClick(&axial, Qt::LeftButton, {}, at);
    EXPECT_EQ(window_->live()->mouse()->aimed(), before);
    const Vec3 wanted = axial.point_at(at);
    QTest::lastMouseTimestamp += 1000;  // it is no third click
    QTest::mouseClick(&axial, Qt::LeftButton, Qt::ControlModifier, at);
    wait_until([&] { return (now().session.tick.proxy.hip - wanted).norm() < 0.1; });
}

}  // namespace
}  // namespace palpate::viewer::test

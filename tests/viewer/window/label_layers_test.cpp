// Layers by label in the window: felt from an overlay, kept in sessions and recordings; layer files
// that are dropped or opened.
#include <QComboBox>
#include <QDragEnterEvent>
#include <QLabel>
#include <QListWidget>
#include <QMimeData>
#include <QPushButton>
#include <QStandardItemModel>
#include <QTabWidget>

#include <fstream>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "palpate/io/layers_file.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class LabelsInWindow : public InWindow {
  protected:
    /// A shell round a core on a coarser grid than the ball's, as 3D Slicer writes them.
    void write_labels() {
        std::ofstream out(scratch_.path() / "ball.seg.nrrd", std::ios::binary);
        out << "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 24 24 24\nspace directions: (2,0,0) (0,2,0) (0,0,2)\n"
               "kinds: domain domain domain\nencoding: raw\nspace origin: (-23,-23,-23)\n"
               "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Name:=shell\n"
               "Segment0_Color:=0.9 0.1 0.1\nSegment1_ID:=Segment_2\nSegment1_LabelValue:=7\n"
               "Segment1_Name:=core\nSegment1_Color:=0.1 0.2 0.9\n\n";
        for (int i = 0; i < 24 * 24 * 24; ++i) {
            const double r = (Vec3(i % 24, i / 24 % 24, i / 576) - Vec3::Constant(11.5)).norm();
            out.put(r > 9 ? '\0' : r > 4 ? '\1' : '\7');
        }
    }
    void write_file(const char* name, const std::string& text) {
        std::ofstream(scratch_.path() / name) << text;
    }
    void open_labels() {
        write_labels();
        window_->panel().overlay_controls().open(
            run::source_named((scratch_.path() / "ball.seg.nrrd").string()));
        wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
        wait_until_settled();
    }
    void feel_labels() {
        open_labels();
        feel_open_labels();
    }
    void feel_open_labels() {
        auto* tabs = window_->findChild<QTabWidget*>("tabs");
        tabs->setCurrentIndex(2);
        QApplication::processEvents();
        QTest::mouseClick(&part<QPushButton>("feel_labels"), Qt::LeftButton);
        wait_until([&] { return layers() != nullptr; });
    }
    SharedLayers layers() { return window_->live()->settings().layers; }
    /// Row of a set in the choice. -1: it is not there.
    int row_of(const QString& set) { return part<QComboBox>("layers").findText(set); }
    bool possible(const QString& set) {
        const auto& box = part<QComboBox>("layers");
        return bool(box.model()->index(box.findText(set), 0).flags() & Qt::ItemIsEnabled);
    }
    void choose(const QString& set) {
        auto& box = part<QComboBox>("layers");
        box.setCurrentIndex(row_of(set));
        Q_EMIT box.activated(box.currentIndex());
        wait_until_quiet(*window_);
    }
    /// The wheel over the scene, until a layer of that name is touched. A whole notch may be more
    /// than a layer holds: the hand would be through it between two looks.
    bool press_until_on(const std::string& name) {
        const auto on = [&] {
            const int touched = now().session.tick.layers.touched;
            return touched >= 0 && layers()->layers[std::size_t(touched)].name == name;
        };
        return press_until(on, 30);
    }
};

TEST_F(LabelsInWindow, the_volume_is_not_saved_over_the_file_of_the_overlay) {
    feel("synthetic:sphere:48x48x48");
    open_labels();
    const std::filesystem::path file = scratch_.path() / "ball.seg.nrrd";
    const auto before = std::filesystem::file_size(file);
    window_->saver().save(QString::fromStdString(file.string()));
    EXPECT_TRUE(window_->messages().problem().contains("in use"));
    wait_until_settled();
    EXPECT_EQ(std::filesystem::file_size(file), before);

    window_->panel().overlay_controls().close_overlay();
    window_->saver().save(QString::fromStdString(file.string()));
    wait_until_settled();
    EXPECT_NE(std::filesystem::file_size(file), before);
}

TEST_F(LabelsInWindow, one_click_feels_the_labels_with_their_names_and_colours) {
    feel("synthetic:sphere:48x48x48");
    feel_labels();
    ASSERT_EQ(layers()->layers.size(), 2U);
    EXPECT_TRUE(layers()->by_label);
    EXPECT_EQ(layers()->layers[0].name, "shell");
    EXPECT_EQ(layers()->layers[1].level, 7);
    EXPECT_NEAR(layers()->layers[1].colour[2], 0.9, 1e-6);
    auto& list = part<QListWidget>("layer_list");
    wait_until([&] { return list.isVisible(); });  // the page Feel is shown
    EXPECT_EQ(list.item(1)->text(), "core   label 7");
    EXPECT_EQ(part<QComboBox>("layers").currentText(), "Labels of ball.seg.nrrd");
    EXPECT_TRUE(press_until_on("shell"));
    EXPECT_TRUE(press_until_on("core")) << "through the shell, which gives way";
    wait_until([&] { return part<QLabel>("touched_layers").text().contains("core"); });
    wait_until_settled();
    save("felt");
    const double level = window_->live()->isovalue();
    choose("No layers: one surface");
    wait_until([&] { return !layers(); });
    wait_until([&] { return now().session.tick.proxy.isovalue == level; });
}

TEST_F(LabelsInWindow, hidden_labels_are_not_felt) {
    feel("synthetic:sphere:48x48x48");
    open_labels();
    part<QListWidget>("overlay_labels").item(0)->setCheckState(Qt::Unchecked);
    QTest::mouseClick(&part<QPushButton>("feel_labels"), Qt::LeftButton);
    wait_until([&] { return layers() != nullptr; });
    ASSERT_EQ(layers()->layers.size(), 1U);
    EXPECT_EQ(layers()->layers[0].name, "core");
}

TEST_F(LabelsInWindow, a_session_keeps_them_also_when_it_is_moved_with_its_data) {
    io::write_volume(run::load(run::source_named("synthetic:sphere:48x48x48")).volume,
                     scratch_.path() / "ball.nrrd");
    feel((scratch_.path() / "ball.nrrd").string());
    feel_labels();
    auto& box = part<NumberBox>("layer_stiffness_box");
    box.setFocus();
    box.selectAll();
    QTest::keyClicks(&box, "0.123");
    QTest::keyClick(&box, Qt::Key_Return);
    wait_until([&] { return layers()->layers[0][HapticProperty::stiffness].value_or(0) == 0.123; });
    window_->files().save_session(scratch("s.json"));
    EXPECT_EQ(window_->messages().problem(), "");
    feel("synthetic:torus:40x40x40");
    ASSERT_FALSE(layers());
    const auto moved = scratch_.path() / "moved";
    std::filesystem::create_directory(moved);
    for (const char* name : {"s.json", "ball.nrrd", "ball.seg.nrrd"}) {
        std::filesystem::rename(scratch_.path() / name, moved / name);
    }
    window_->files().open_path(QString::fromStdString((moved / "s.json").string()));
    wait_until([&] { return window_->live() && layers(); });
    wait_until_settled();
    EXPECT_EQ(window_->messages().problem(), "");
    EXPECT_TRUE(layers()->by_label);
    EXPECT_EQ(layers()->layers[0][HapticProperty::stiffness], 0.123);
    EXPECT_TRUE(window_->panel().overlay_controls().overlay());
    EXPECT_TRUE(press_until_on("shell"));
    std::filesystem::remove(moved / "ball.seg.nrrd");
    window_->files().open_path(QString::fromStdString((moved / "s.json").string()));
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    wait_until([&] { return window_->live() && !layers(); });  // felt without them
}

TEST_F(LabelsInWindow, of_the_second_hand_come_back_from_a_session) {
    feel("synthetic:sphere:48x48x48");
    open_labels();
    add_hand("mouse");
    feel_open_labels();
    const auto layers_of = [&](int hand) {
        return window_->content().live(hand)->settings().layers;
    };
    ASSERT_TRUE(layers_of(2));
    EXPECT_FALSE(layers_of(1));
    window_->files().save_session(scratch("s.json"));
    feel("synthetic:torus:40x40x40");
    window_->files().open_path(scratch("s.json"));
    wait_until([&] { return window_->content().hands() == 2 && layers_of(2); });
    wait_until_settled();
    EXPECT_EQ(window_->messages().problem(), "");
    EXPECT_EQ(window_->content().hand(), 1);
    EXPECT_TRUE(layers_of(2)->by_label && layers_of(2)->labels);
    EXPECT_FALSE(layers_of(1));
}

TEST_F(LabelsInWindow, a_recording_is_played_with_them) {
    feel("synthetic:sphere:48x48x48");
    feel_labels();
    const double level = window_->live()->isovalue();
    record("a.csv");
    EXPECT_EQ(window_->live()->isovalue(), level);
    ASSERT_TRUE(press_until_on("shell"));
    stop_recording();
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->playback()->different(), 0U);
    window_->playing().show_time(window_->playback()->end());
    wait_until([&] { return part<QLabel>("readout").text().contains("on shell"); });
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() && layers(); });
    wait_until([&] {
        return window_->panel().overlay_controls().overlay() != nullptr;
    });  // their label map is shown
    wait_until_settled();
}

constexpr const char* by_label_set = R"({"palpate_layers": 1, "name": "Organs", "by_label": true,
    "layers": [{"name": "core", "level": 7, "stiffness": 0.5, "puncture_force": "inf"}]})";
constexpr const char* named_set = R"({"palpate_layers": 1, "name": "Named", "layers": [
    {"name": "shell", "level": 20}, {"name": "core", "level": 60}]})";

TEST_F(LabelsInWindow, a_set_by_label_can_be_chosen_once_there_is_a_label_map) {
    feel("synthetic:sphere:48x48x48");
    write_file("organs.json", by_label_set);
    write_file("named.json", named_set);
    drop(scratch("organs.json"));
    viewer::wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("label map"))
        << window_->messages().problem().toStdString();
    EXPECT_FALSE(layers());
    ASSERT_GE(row_of("Organs"), 0);
    EXPECT_FALSE(possible("Organs"));
    const auto& box = part<QComboBox>("layers");
    EXPECT_TRUE(box.itemData(row_of("Organs"), Qt::ToolTipRole).toString().contains("label map"));
    drop(scratch("named.json"));
    wait_until([&] { return layers() != nullptr; });
    EXPECT_FALSE(layers()->by_label);
    EXPECT_EQ(row_of("Named, by label"), -1);
    open_labels();
    EXPECT_TRUE(possible("Organs"));
    choose("Organs");
    wait_until([&] { return layers() && layers()->name == "Organs"; });
    EXPECT_TRUE(press_until_on("core"));
    choose("Named, by label");
    wait_until([&] { return layers()->by_label && layers()->layers.size() == 2; });
    EXPECT_EQ(layers()->layers[1].level, 7);
}

TEST_F(LabelsInWindow, a_layer_file_that_is_opened_is_used_and_a_bad_one_is_one_clear_line) {
    write_file("named.json", named_set);
    write_file("bad.json", R"({"palpate_layers": 1, "layers": [{"name": "a", "levle": 3}]})");
    window_->files().open_path(scratch("named.json"));
    viewer::wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("open a volume first"));
    for (auto* box : window_->findChildren<QDialog*>()) box->close();
    window_->activateWindow();
    feel("synthetic:sphere:48x48x48");
    type_in_dialog(Qt::Key_O, scratch("named.json"));
    wait_until([&] { return layers() != nullptr; });
    EXPECT_EQ(layers()->name, "Named");
    drop(scratch("bad.json"));
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    const QString problem = window_->messages().problem();
    EXPECT_TRUE(problem.contains("bad.json") && problem.contains("level")) << problem.toStdString();
    EXPECT_FALSE(problem.contains('\n'));
    EXPECT_FALSE(problem.contains("session"));
    EXPECT_EQ(layers()->name, "Named") << "the ones before stay";
}

}  // namespace
}  // namespace palpate::viewer::test

// The whole window with volumes that are read as they are felt: levels of detail, what is missing,
// addresses, levels, channels and times.
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QPushButton>
#include <QStatusBar>
#include <filesystem>

#include "apps/viewer/panel/inputs.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/stream/convert.hpp"
#include "stream/volume_server.hpp"
#include "support/silent_server.hpp"
#include "support/zarr_image.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class Streaming : public InWindow {
  protected:
    /// A ring of 160 samples along each axis; its overview is level 1.
    QString ring() {
        const Volume volume = scenes::make_volume("torus:160x160x160").volume;
        stream::ConvertOptions options;
        options.chunk = 32;
        convert_to_zarr(*stream::store_of(volume, "ring"), 0, scratch_.path() / "ring.zarr",
                        options);
        io::write_volume(volume, scratch_.path() / "ring.nrrd");
        return scratch("ring.zarr");
    }
    QString status_line() { return part<QLabel>("streaming").text(); }
    DetailController::State details() { return window_->details().state(); }
};

int differing(const QImage& a, const QImage& b) {
    int count = 0;
    for (int y = 0; y < a.height(); y += 2) {
        for (int x = 0; x < a.width(); x += 2) {
            const QColor one = a.pixelColor(x, y), other = b.pixelColor(x, y);
            count += std::abs(one.red() - other.red()) + std::abs(one.green() - other.green()) > 24;
        }
    }
    return count;
}

using DrawnStreaming = Streaming;

TEST_F(DrawnStreaming, a_store_looks_like_the_same_volume_in_memory) {
    const QString store = ring();
    auto& scene = window_->views().scene();
    pictures::Camera camera;
    camera.towards_viewer = Vec3(-0.3, -0.8, 0.6);
    camera.half_height = 80;
    // The overview suggests another level and other greys.
    const auto look = [&] {
        window_->content().effect().request(command::Isovalue{60});
        set(window_->views(), &Shown::window, {0, 240});
        scene.set_camera(camera);
        wait_until_settled();
    };
    feel(scratch("ring.nrrd").toStdString());
    look();
    wait_until_settled();
    EXPECT_FALSE(part<QLabel>("streaming").isVisible()) << "nothing is streamed";
    const QImage whole = scene.picture(), slice = window_->views().slice(2).grab().toImage();
    save("in-memory");
    feel(store.toStdString());
    look();
    wait_until_settled();
    save("store");
    EXPECT_EQ(details().overview, 1);
    EXPECT_EQ(details().finest, 0);
    for (int axis = 0; axis < 3; ++axis) {
        const DetailField* const shown = window_->views().slice(axis).shown_detail();
        ASSERT_NE(shown, nullptr) << axis;
        EXPECT_EQ(shown->of.level, 0);
        EXPECT_EQ(shown->missing, 0U);
    }
    EXPECT_LT(differing(window_->views().slice(2).grab().toImage(), slice), 200);
    // The ring fills a quarter of the picture; the surface of the overview differs nearly
    // everywhere.
    const int samples = scene.picture().width() * scene.picture().height() / 4;
    EXPECT_LT(differing(scene.picture(), whole), samples / 50);
}

class StreamingEdits : public Streaming {
  protected:
    struct Seen {
        QImage scene, slice;
    };
    Scene& scene() { return window_->views().scene(); }
    run::VolumeEditor& editor() { return window_->live()->data().editor(); }
    void set_camera() {
        pictures::Camera camera;
        camera.towards_viewer = Vec3(-0.3, -0.8, 0.6);
        camera.half_height = 80;
        scene().set_camera(camera);
    }
    /// The same level, greys and view, whatever is open.
    void look() {
        window_->content().effect().request(command::Isovalue{60});
        set(window_->views(), &Shown::window, {0, 240});
        set_camera();
        wait_until_settled();
    }
    void open(const char* name) {
        feel(scratch(name).toStdString());
        look();
    }
    Seen seen() { return {scene().picture(), window_->views().slice(2).grab().toImage()}; }
    void undo_all() {  // or the window asks
        while (editor().undo()) {
        }
    }

    /// A piece of the ring, not along pieces or bricks.
    const edit::Fill fill_{{{85, 13, 41}, {150, 77, 133}}, 0};
};

void expect_same(const QImage& a, const QImage& b, int most, const char* what) {
    EXPECT_LT(differing(a, b), most) << what;
}

using DrawnStreamingEdits = StreamingEdits;

TEST_F(DrawnStreamingEdits, look_like_those_in_memory_and_are_saved) {
    ring();
    const auto expect_like = [&](const Seen& other, const char* what) {
        const Seen now = seen();
        expect_same(now.slice, other.slice, 200, what);
        expect_same(now.scene, other.scene, now.scene.width() * now.scene.height() / 200, what);
    };
    open("ring.nrrd");
    editor().apply(fill_);
    look();
    const Seen expected = seen();
    save("in-memory");
    undo_all();
    open("ring.zarr");
    const Seen before = seen();
    EXPECT_GT(differing(before.scene, expected.scene), 2000);
    EXPECT_GT(differing(before.slice, expected.slice), 400);
    editor().apply(fill_);
    look();
    save("edited");
    expect_like(expected, "edited");
    ASSERT_NE(window_->views().slice(2).shown_detail(), nullptr);
    press(Qt::Key_Z, Qt::ControlModifier);
    wait_until([&] { return editor().state().redo_steps == 1; });
    look();
    expect_like(before, "undone");
    press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    wait_until([&] { return window_->isWindowModified(); });
    type_in_dialog(Qt::Key_S, scratch("cut.zarr"), Qt::ShiftModifier);
    wait_until([&] { return !editor().state().changed; });
    wait_until([&] { return window_->windowTitle().startsWith("cut.zarr"); });
    EXPECT_TRUE(std::holds_alternative<run::StoreSource>(window_->content().source().from))
        << "what was saved is what is opened";
    open("cut.zarr");
    EXPECT_FALSE(editor().state().changed);
    expect_like(expected, "saved and opened");
}

TEST_F(StreamingEdits, that_were_not_saved_are_rescued_when_a_signal_ends_the_window) {
    ring();
    open("ring.zarr");
    const auto sample_in = [&](const std::string& name) {
        std::vector<std::byte> sample(1);
        const SampleBox cut_out{{100, 40, 80}, {100, 40, 80}};
        stream::open_store(name)->read(0, cut_out, sample, {});
        return static_cast<int>(sample[0]);
    };
    EXPECT_GT(sample_in(scratch("ring.zarr").toStdString()), 60);
    editor().apply(fill_);
    const QStringList before = QDir::temp().entryList({"palpate-edits-*"}, QDir::Dirs);
    window_->end();
    QStringList kept = QDir::temp().entryList({"palpate-edits-*"}, QDir::Dirs);
    for (const QString& name : before) kept.removeAll(name);
    ASSERT_EQ(kept.size(), 1);
    QDir rescued(QDir::temp().filePath(kept[0]));
    EXPECT_EQ(sample_in(rescued.filePath("edits.zarr").toStdString()), 0);
    rescued.removeRecursively();
    window_.reset();
}

TEST_F(StreamingEdits, by_hand_are_recorded_and_played) {
    ring();
    open("ring.zarr");
    record("carving.csv");
    QTest::mouseClick(&scene(), Qt::LeftButton, {}, QPoint(180, 400));
    wait_until([&] { return !window_->probe().travelling(); });
    press_until_force();
    press(Qt::Key_B);
    wait_until([&] { return editor().state().version > 0; });
    press(Qt::Key_B);
    editor().apply(edit::Fill{{{20, 70, 60}, {40, 100, 110}}, 0});
    look();
    save("carved");
    stop_recording();
    undo_all();
    window_->files().open_path(scratch("carving.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->playback()->different(), 0U);
    window_->playing().show_time(window_->playback()->end());
    set_camera();
    wait_until_settled();
    save("played");
    const DetailField* const played = window_->views().slice(2).shown_detail();
    ASSERT_NE(played, nullptr);
    const Geometry& grid = window_->playback()->field().geometry();
    const double layer = std::round(index_from_physical(grid, played->field.geometry().origin)[2]);
    const auto value = [&](double x, double y) {
        return value_at(played->field, physical_from_index(grid, Vec3(x, y, layer + 2)));
    };
    EXPECT_EQ(value(30, 85), 0) << "cut out by the last edit";
    EXPECT_GT(value(30, 60), 20);
}

TEST_F(DrawnStreaming, zooming_and_stepping_bring_what_is_seen_then) {
    feel(ring().toStdString());
    wait_until_settled();
    SlicePane& pane = window_->views().slice(2);
    const auto layer = [&] {
        const Geometry& grid = window_->live()->field().geometry();
        return index_from_physical(grid, pane.shown().crosshair)[2];
    };
    const double before = layer();
    turn_wheel(pane, 3);
    EXPECT_NEAR(std::abs(layer() - before), 3, 0.6) << "samples of the level that is felt";
    wait_until_settled();
    EXPECT_NE(pane.shown_detail(), nullptr);
    turn_wheel(pane, 40);
    wait_until_settled();
    ASSERT_NE(pane.shown_detail(), nullptr) << "far from where it began";
    EXPECT_EQ(pane.shown_detail()->missing, 0U);
    // The view turns: another part is seen, and chosen.
    press(Qt::Key_H);
    auto& scene = window_->views().scene();
    turn_wheel(scene, 8);
    drag(scene, scene.rect().center(), scene.rect().center() + QPoint(60, 40));
    wait_until_settled();
    EXPECT_EQ(details().finest, 0);
    save("zoomed");
    // An hidden pane needs nothing.
    press(Qt::Key_F7);
    wait_until_settled();
    EXPECT_FALSE(pane.seen());
}

TEST_F(DrawnStreaming, another_isovalue_is_seen_as_finely) {
    feel(ring().toStdString());
    wait_until_settled();
    const QImage before = window_->views().scene().picture();
    for (int i = 0; i < 5; ++i) press(Qt::Key_Plus);
    wait_until_settled();
    EXPECT_GT(differing(window_->views().scene().picture(), before), 300);
    EXPECT_EQ(details().finest, 0);
}

TEST_F(Streaming, the_sample_at_the_proxy_is_the_one_that_is_felt) {
    feel(ring().toStdString());
    wait_until_settled();
    press_until_force();
    auto& readout = part<QLabel>("readout");
    const QString level = QString::number(window_->live()->isovalue(), 'g', 4);
    wait_until([&] { return readout.text().contains("mm   " + level); });
}

TEST_F(Streaming, an_address_is_typed_looked_up_and_felt_and_the_window_says_what_is_missing) {
    const stream::test::VolumeServer server({"--delay", "40"});
    const QString address = QString::fromStdString(server.address("virtual.zarr"));
    press(Qt::Key_L, Qt::ControlModifier);
    auto& line = part<QLineEdit>("store_address");
    activate(line);
    auto& levels = part<QComboBox>("store_level");
    auto* open = line.window()->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Open);
    EXPECT_FALSE(open->isEnabled());
    QTest::keyClicks(&line, address + "x");
    QTest::keyClick(&line, Qt::Key_Return);
    auto& verdict = part<QLabel>("store_verdict");
    wait_until([&] { return verdict.text().contains("virtual.zarrx"); });
    EXPECT_FALSE(open->isEnabled());
    QTest::keyClick(&line, Qt::Key_Backspace);
    EXPECT_TRUE(verdict.text().isEmpty()) << "that was another address";
    QTest::keyClick(&line, Qt::Key_Return);
    wait_until([&] { return open->isEnabled(); });
    EXPECT_EQ(levels.count(), 8);
    EXPECT_TRUE(levels.itemText(0).contains("12288 x 12288 x 12288"));
    EXPECT_TRUE(levels.itemText(0).contains("1.9 TB"));
    line.window()->grab().save(QString(PALPATE_PICTURES) + "/store-dialog.png");
    levels.setFocus();
    for (int i = 0; i < 3; ++i) QTest::keyClick(&levels, Qt::Key_Down);
    QTest::mouseClick(open, Qt::LeftButton);
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(window_->live()->field().geometry().size, Index3::Constant(12288 >> 3));
    // 1500 bricks at 25 requests a second and thread take a while: the window says so.
    wait_until([&] { return status_line().contains("bricks missing"); });
    EXPECT_TRUE(status_line().contains("felt: level 3"));
    EXPECT_TRUE(part<QLabel>("streaming").toolTip().contains("requests"));
    wait_until([&] {
        return details().finest < details().overview;
    });  // pictures become finer while the hand's bricks come
    EXPECT_GE(details().finest, 3) << "not finer than what is felt";
    EXPECT_EQ(window_->messages().problem(), "");
    save("address");
    wait_until([&] { return window_->details().settled(); });
    save("address-finer");
    EXPECT_EQ(QSettings().value("recent").toStringList().value(0), address);
}

TEST_F(Streaming, an_address_is_typed_at_once_and_a_long_failure_is_read_whole) {
    press(Qt::Key_L, Qt::ControlModifier);
    auto& line = part<QLineEdit>("store_address");
    activate(line);
    ASSERT_TRUE(line.hasFocus());
    QTest::keyClicks(QApplication::focusWidget(),
                     "http://127.0.0.1:1/a/folder/with/quite/a/long/name/of/an/image/that/nobody/"
                     "has/ever/put/there/image.zarr");
    QTest::keyClick(&line, Qt::Key_Return);
    auto& verdict = part<QLabel>("store_verdict");
    wait_until([&] { return verdict.text().contains("127.0.0.1"); });
    handle_events();
    EXPECT_GT(verdict.heightForWidth(verdict.width()), verdict.fontMetrics().lineSpacing() * 3 / 2)
        << "more than a line";
    EXPECT_GE(verdict.height(), verdict.heightForWidth(verdict.width()));
}

TEST_F(Streaming, a_silent_server_is_left_at_once_when_its_dialog_or_the_window_closes) {
    for (const bool closes_window : {false, true}) {
        support::SilentServer server;
        press(Qt::Key_L, Qt::ControlModifier);
        auto& line = part<QLineEdit>("store_address");
        const QPointer<QWidget> dialog = line.window();
        activate(line);
        QTest::keyClicks(&line, QString::fromStdString(server.address()));
        QTest::keyClick(&line, Qt::Key_Return);
        wait_until([&] { return server.is_asked(); });
        EXPECT_FALSE(server.is_left());
        if (closes_window) {
            window_.reset();
        } else {
            auto* buttons = dialog->findChild<QDialogButtonBox*>();
            QTest::mouseClick(buttons->button(QDialogButtonBox::Cancel), Qt::LeftButton);
            wait_until([&] { return !dialog; });
        }
        EXPECT_TRUE(server.is_left()) << closes_window;
    }
}

TEST_F(Streaming, a_hand_that_waits_is_told_why) {
    const stream::test::VolumeServer server;
    window_->files().open_path(QString::fromStdString(server.address("virtual.zarr")));
    wait_until([&] { return window_->live() && window_->live()->snapshot(); });
    auto& hint = part<QLabel>("hint");
    const auto waits = [&] { return hint.isVisible() && hint.text().contains("waits"); };
    // The hand goes farther than bricks have come, and stays there.
    server.stop_answering();
    ASSERT_TRUE(
        press_until([&] { return now().session.tick.proxy.status == UpdateStatus::waiting; }));
    wait_until(waits);
    save("waiting");
    server.answer_again();
    wait_until([&] { return !waits(); });
    EXPECT_EQ(window_->messages().problem(), "");
}

TEST_F(Streaming, of_several_levels_channels_and_times_another_is_chosen_while_one_is_felt) {
    support::put_image(scratch_.path() / "image.zarr");
    feel(scratch("image.zarr").toStdString());
    ASSERT_NE(window_->live(), nullptr);
    for (const char* note : {"2 channels, 2 times", "Felt through the device mouse"}) {
        EXPECT_TRUE(window_->statusBar()->currentMessage().contains(note)) << note;
    }
    auto* action = window_->findChild<QAction*>("choose_level");
    ASSERT_NE(action, nullptr);
    wait_until([&] { return action->isEnabled(); });
    const auto choose = [&](int level, int channel, int time) {
        action->trigger();
        auto* dialog = window_->findChild<QDialog*>("store");
        ASSERT_NE(dialog, nullptr);
        activate(*dialog);
        auto* open = dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Open);
        wait_until([&] { return open->isEnabled(); });
        EXPECT_FALSE(dialog->findChild<QLineEdit*>("store_address")->isEnabled() &&
                     !dialog->findChild<QLineEdit*>("store_address")->isReadOnly());
        auto* levels = dialog->findChild<QComboBox*>("store_level");
        auto* channels = dialog->findChild<QComboBox*>("store_channel");
        auto* times = dialog->findChild<NumberBox*>("store_time");
        EXPECT_TRUE(channels->isEnabled() && times->isEnabled());
        const auto pick = [](QComboBox& box, int row) {
            box.setFocus();
            QTest::keyClick(&box, Qt::Key_Home);
            for (int i = 0; i < row; ++i) QTest::keyClick(&box, Qt::Key_Down);
        };
        pick(*levels, level);
        EXPECT_EQ(levels->currentIndex(), level);
        pick(*channels, channel);
        times->setValue(time);
        int started = 0;
        const auto counting =
            QObject::connect(&window_->content(), &Content::run_started, [&started] { ++started; });
        QTest::mouseClick(open, Qt::LeftButton);
        wait_until([&] { return started == 1 && window_->settled(); });
        QObject::disconnect(counting);
    };
    const auto felt = [&] { return std::get<run::StoreSource>(window_->content().source().from); };
    const double level = window_->live()->isovalue();
    choose(1, 0, 1);
    EXPECT_EQ(felt().loader.level, 1);
    EXPECT_EQ(window_->content().source().frame, 1);
    EXPECT_EQ(window_->live()->field().geometry().size, Index3::Constant(16));
    EXPECT_EQ(window_->live()->isovalue(), level) << "the same channel is felt as before";
    choose(0, 1, 0);
    EXPECT_EQ(felt().loader.level, 0);
    EXPECT_EQ(felt().options.channel, 1);
    EXPECT_EQ(window_->content().source().frame, 0);
    EXPECT_EQ(window_->messages().problem(), "");
}

TEST_F(Streaming, all_times_play_and_one_of_them_is_felt_again) {
    support::put_image(scratch_.path() / "image.zarr");
    feel(scratch("image.zarr").toStdString());
    const auto choose = [&](bool all) {
        window_->findChild<QAction*>("choose_level")->trigger();
        auto* dialog = window_->findChild<QDialog*>("store");
        ASSERT_NE(dialog, nullptr);
        activate(*dialog);
        auto* open = dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Open);
        wait_until([&] { return open->isEnabled(); });
        auto* times = dialog->findChild<QCheckBox*>("store_all_times");
        EXPECT_EQ(times->isChecked(), !all) << "as it is felt now";
        QTest::mouseClick(times, Qt::LeftButton, {}, QPoint(8, times->height() / 2));
        EXPECT_EQ(dialog->findChild<NumberBox*>("store_time")->isEnabled(), !all);
        if (all) dialog->grab().save(QString("%1/all-times-dialog.png").arg(PALPATE_PICTURES));
        QTest::mouseClick(open, Qt::LeftButton);
        wait_until([&] {
            return window_->live() && window_->live()->data().is_sequence() == all &&
                   window_->live()->snapshot();
        });
    };
    choose(true);
    EXPECT_TRUE(part<QWidget>("timeline").isVisible());
    wait_until([&] { return now().session.moment > 0.5; });  // it plays
    save("all-times");
    choose(false);
    EXPECT_TRUE(window_->live()->data().is_streamed());
    EXPECT_EQ(window_->content().source().frame, 0);
}

}  // namespace
}  // namespace palpate::viewer::test

// Work is not lost without a question, and opens again under the name that was chosen, also an odd
// one.
#include <QLabel>
#include <QMenu>
#include <QMessageBox>
#include <QPushButton>

#include "apps/viewer/window/file_dialogs.hpp"
#include "viewer/window/held_reader.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class Work : public InWindow {
  protected:
    run::EditState edits() { return window_->live()->data().editor().state(); }
    /// With the hand in the solid.
    void carve() {
        press(Qt::Key_B);
        wait_until([&] { return edits().version > 0; });
        press(Qt::Key_B);
    }
    /// A file, which a HeldReader does not read before it may.
    run::Source other_source() {
        const auto ball = run::load(run::source_named("synthetic:sphere:32x32x32")).volume;
        io::write_volume(ball, scratch_.path() / "other.nrrd");
        return run::source_named(scratch("other.nrrd").toStdString());
    }
    int size() const { return window_->live()->field().geometry().size[0]; }
};

TEST_F(Work, done_while_another_file_is_read_is_asked_about_before_that_takes_its_place) {
    feel("synthetic:sphere:48x48x48");
    press_until_force();
    const run::Source other = other_source();
    for (const bool edit : {true, false}) {
        const HeldReader reader(scratch_.path());
        window_->files().open_volume(other);
        ASSERT_TRUE(window_->files().loading());
        edit ? carve() : measure(window_->views().slice(2));
        EXPECT_EQ(window_->measuring().measurements().size(), edit ? 0U : 1U);
        ASSERT_TRUE(window_->files().loading());
        answer(QMessageBox::Cancel);
        reader.release();
        wait_until([&] { return !window_->files().loading(); });
        wait_until_settled();
        EXPECT_EQ(size(), 48);
        EXPECT_EQ(edits().changed, edit);
        if (!edit) continue;
        press(Qt::Key_Z, Qt::ControlModifier);
        wait_until([&] { return !edits().changed; });
    }
    answer(QMessageBox::Discard);
    window_->files().settle_work([&] { window_->files().open_volume(other); });
    wait_until([&] { return !window_->files().loading() && size() == 32; });
    EXPECT_TRUE(window_->measuring().measurements().empty()) << "given up before, asked once";
}

TEST_F(Work, that_is_being_saved_shows_its_progress_and_can_be_cancelled) {
    feel("synthetic:sphere:96x96x96");
    press_until_force();
    carve();
    const QString path = scratch("saved.nii.gz");
    window_->saver().save(path);
    EXPECT_EQ(strip(), nullptr) << "not at once";
    QWidget* shown = late_strip();
    ASSERT_NE(shown, nullptr);
    EXPECT_EQ(shown->findChild<QLabel*>()->text(), "Saving saved.nii.gz");
    QTest::mouseClick(shown->findChild<QPushButton*>("cancel"), Qt::LeftButton);
    wait_until([&] { return !window_->saver().saving(); });
    EXPECT_EQ(strip(), nullptr);
    EXPECT_EQ(edits().changed, !QFile::exists(path)) << "as a whole or not at all";
    EXPECT_TRUE(window_->messages().problem().isEmpty());
}

TEST_F(Work, that_was_saved_is_not_taken_for_another_volume_that_was_opened_meanwhile) {
    feel("synthetic:sphere:96x96x96");
    const auto other = std::make_shared<Opened>(
        open(run::source_named("synthetic:torus:32x32x16"), [](double) {}));
    window_->saver().save(scratch("sphere.nii.gz"));
    window_->content().start_run(other, make_hands(*other, {setup_with("mouse")}));
    wait_until([&] { return !window_->saver().saving(); });
    EXPECT_TRUE(QFile::exists(scratch("sphere.nii.gz")));
    EXPECT_EQ(run::name_of(window_->content().source()), "synthetic:torus:32x32x16");
}

TEST_F(Work, goes_on_with_the_file_as_it_is_now_when_its_session_is_opened_again) {
    const auto write = [&](const char* volume) {
        io::write_volume(run::load(run::source_named(volume)).volume, scratch_.path() / "day.nrrd");
    };
    write("synthetic:sphere:24x24x24");
    feel(scratch("day.nrrd").toStdString());
    window_->files().save_session(scratch("day.json"));
    const auto volume = window_->content().volume();
    const auto open_again = [&] {
        const QSignalSpy started(&window_->content(), &Content::run_started);
        window_->files().open_path(scratch("day.json"));
        wait_until([&] { return !started.isEmpty(); });
    };
    open_again();
    EXPECT_EQ(window_->content().volume(), volume) << "nothing was written: it is not read again";
    write("synthetic:sphere:40x40x40");  // by another program
    open_again();
    EXPECT_EQ(size(), 40);
    std::filesystem::remove(scratch_.path() / "day.nrrd");
    open_again();
    EXPECT_EQ(size(), 40) << "as long as it is in memory, it can be felt";
}

TEST_F(Work, gets_the_extension_that_opens_it_again_whatever_its_name) {
    feel("synthetic:sphere:32x32x32");
    type_in_dialog(Qt::Key_S, scratch("Fall Müller 2.1"));
    ASSERT_TRUE(QFile::exists(scratch("Fall Müller 2.1.json")));
    EXPECT_FALSE(QFile::exists(scratch("Fall Müller 2.1")));
    type_in_dialog(Qt::Key_P, scratch("seen.today"), Qt::ShiftModifier);
    EXPECT_TRUE(QFile::exists(scratch("seen.today.png")));
    feel("synthetic:sphere:24x24x24");
    wait_until([&] { return size() == 24; });
    window_->files().open_path(scratch("Fall Müller 2.1.json"));
    wait_until([&] { return window_->live() && size() == 32; });
}

TEST_F(Work, replaces_no_file_of_the_longer_name_without_a_question) {
    feel("synthetic:sphere:32x32x32");
    std::ofstream(scratch_.path() / "day.2.png") << "mine";
    int asked = 0;
    QTimer person;
    QObject::connect(&person, &QTimer::timeout, [&] {
        QWidget* dialog = QApplication::activeModalWidget();
        if (auto* box = qobject_cast<QMessageBox*>(dialog); box && box->isVisible()) {
            ++asked;
            return QTest::mouseClick(box->button(QMessageBox::No), Qt::LeftButton);
        }
        auto* line = dialog ? dialog->findChild<QLineEdit*>("fileNameEdit") : nullptr;
        if (!line || !line->isVisible()) return;
        if (asked > 0) return QTest::keyClick(line, Qt::Key_Escape);  // another name could be given
        line->setText(scratch("day.2"));
        QTest::keyClick(line, Qt::Key_Return);
    });
    person.start(10);
    press(Qt::Key_P, Qt::ControlModifier | Qt::ShiftModifier);
    person.stop();
    EXPECT_EQ(asked, 1);
    EXPECT_FALSE(QFile::exists(scratch("day.2")));
    std::ifstream file(scratch_.path() / "day.2.png");
    std::string text;
    file >> text;
    EXPECT_EQ(text, "mine");
}

TEST_F(Work, has_its_name_in_menu_and_messages_as_it_is) {
    const QString name = scratch("a&b <b>c<b>.nrrd");
    io::write_volume(run::load(run::source_named("synthetic:sphere:24x24x24")).volume,
                     name.toStdString());
    feel(name.toStdString());
    auto& menu = part<QMenu>("recent");
    Q_EMIT menu.aboutToShow();
    EXPECT_EQ(menu.actions()[0]->text(), QString(name).replace('&', "&&"));
    window_->messages().show_problem(name);
    const auto box = window_->findChild<QMessageBox*>("problem");
    ASSERT_NE(box, nullptr);
    EXPECT_EQ(box->textFormat(), Qt::PlainText);
    box->close();
    open_window("mouse");
    bool found = false;
    for (auto* button : part<QWidget>("welcome_recent").findChildren<QPushButton*>()) {
        found = found || button->text() == "a&&b <b>c<b>.nrrd";
    }
    EXPECT_TRUE(found);
}

TEST_F(Work, on_a_live_source_or_an_address_is_remembered_by_that_name) {
    for (const char* name : {"live:/tmp/frames.shm", "https://example.org/a.zarr"}) {
        remember_file(name);
        EXPECT_EQ(recent_files().value(0), name);
    }
}

TEST_F(Work, with_a_very_long_name_does_not_make_the_window_wider) {
    feel("synthetic:sphere:24x24x24");
    const int width = window_->width();
    run::Source other = other_source();
    const std::string longer = (scratch_.path() / (std::string(200, 'W') + ".nrrd")).string();
    std::filesystem::rename(scratch_.path() / "other.nrrd", longer);
    std::get<run::FileSource>(other.from).path = longer;
    auto reader = std::make_unique<HeldReader>(scratch_.path());
    window_->files().open_volume(other);
    wait_until([&] { return strip() != nullptr; });
    QApplication::processEvents();
    EXPECT_EQ(window_->width(), width);
    window_->files().loader().abandon();
    reader.reset();
    std::filesystem::copy_file(longer, scratch_.path() / "short.nrrd");
    OverlayControls& overlays = window_->panel().overlay_controls();
    const auto width_with = [&](const std::string& overlay) {
        overlays.open(run::source_named(overlay));
        wait_until([&] { return overlays.settled(); });
        QApplication::processEvents();
        EXPECT_NE(overlays.overlay(), nullptr);
        return window_->panel().minimumSizeHint().width();
    };
    const int panel = width_with(scratch("short.nrrd").toStdString());
    EXPECT_EQ(width_with(longer), panel);
    EXPECT_EQ(window_->width(), width);
}

}  // namespace
}  // namespace palpate::viewer::test

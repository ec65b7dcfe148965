// Words and numbers of the window: their promises, their form, and their places.
#include <QAction>
#include <QFileDialog>
#include <QLabel>
#include <QStatusBar>
#include <QTextBrowser>

#include <algorithm>
#include <map>
#include <utility>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

using WordsInWindow = InWindow;

TEST_F(WordsInWindow, of_the_first_steps_promise_nothing_that_is_switched_off) {
    for (const auto* label : part<QWidget>("welcome").findChildren<QLabel*>()) {
        EXPECT_FALSE(label->text().contains("press harder")) << label->text().toStdString();
    }
    part<QAction>("first_steps_action").trigger();
    const QString text = part<QDialog>("first_steps").findChild<QTextBrowser*>()->toPlainText();
    const int through = text.indexOf("press harder");
    ASSERT_GE(through, 0);
    EXPECT_EQ(text.lastIndexOf("switch on Surfaces give way", through), through - 29)
        << text.mid(through - 60, 90).toStdString();
    feel("synthetic:sphere:24x24x24");
    EXPECT_FALSE(part<QAbstractButton>("penetrability").isChecked());
}

TEST_F(WordsInWindow, over_a_recording_tell_how_to_leave_it) {
    feel("synthetic:sphere:24x24x24");
    record("a.csv");
    wait_for_ticks(20);
    stop_recording();
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    auto& hint = part<QLabel>("hint");
    wait_until([&] { return hint.isVisible() && hint.text().contains("Esc leaves it"); });
    press(Qt::Key_F8);
    wait_until(
        [&] { return hint.isVisible() && hint.parentWidget() != &window_->views().scene(); });
    press(Qt::Key_Escape);
    wait_until(
        [&] { return window_->live() && !(hint.isVisible() && hint.text().contains("Esc")); });
}

TEST_F(WordsInWindow, of_a_problem_are_all_seen_however_long_a_name_is) {
    const QString name = "/data/" + QString("series_of_a_patient-T1w.").repeated(12) + "nrrd";
    window_->files().open_path(name);
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().startsWith(name + ":"));
    const auto& box = part<QMessageBox>("problem");
    for (const auto* label : box.findChildren<QLabel*>()) {
        if (label->text().isEmpty()) continue;
        EXPECT_EQ(label->text().remove(QChar(0x200b)), window_->messages().problem());
        const QRect seen = label->fontMetrics().boundingRect(QRect(0, 0, label->width(), 10000),
                                                             Qt::TextWordWrap, label->text());
        EXPECT_LE(seen.width(), label->width());
    }
}

TEST_F(WordsInWindow, suggest_the_name_of_the_volume_for_its_surface) {
    const Volume ball = run::load(run::source_named("synthetic:sphere:16x16x16")).volume;
    for (const char* name : {"iguana.nii", "iguana.nii.gz", "iguana.nrrd"}) {
        io::write_volume(ball, scratch_.path() / name);
        feel(scratch(name).toStdString());
        QString suggested;
        in_file_dialog([&] { window_->saver().ask_save_surface(); },
                       [&](QLineEdit& line) {
                           suggested = line.text();
                           QTest::keyClick(&line, Qt::Key_Escape);
                       });
        EXPECT_EQ(suggested, "iguana.ply") << name;
    }
}

TEST_F(WordsInWindow, name_the_kind_of_file_that_a_dialog_saves) {
    feel("synthetic:sphere:24x24x24");
    struct Case {
        Qt::Key key;
        const char* kind;
    };
    for (const Case& one :
         {Case{Qt::Key_S, "Sessions (*.json)"}, Case{Qt::Key_P, "Pictures (*.png)"},
          Case{Qt::Key_R, "Recordings (*.csv)"}}) {
        QStringList kinds;
        in_file_dialog([&] { press(one.key, Qt::ControlModifier); },
                       [&](QLineEdit& line) {
                           kinds = qobject_cast<QFileDialog*>(line.window())->nameFilters();
                           QTest::keyClick(&line, Qt::Key_Escape);
                       });
        EXPECT_EQ(kinds, QStringList{one.kind});
    }
}

TEST(RulerWords, have_no_exponents) {
    for (const double spacing : {1e-3, 0.5, 2.0}) {
        Geometry geometry;
        geometry.spacing.setConstant(spacing);
        for (const double mm : {0.0004, 0.13, 1.3, 130.0, 2696.5}) {
            const std::string text = ruler_of(geometry).number(mm);
            EXPECT_EQ(text.find('e'), std::string::npos) << text;
        }
    }
}

using DrawnWords = WordsInWindow;

/// With the fonts of a display: without one they are larger.
TEST_F(DrawnWords, leave_three_quarters_of_a_common_window_to_the_picture) {
    feel("synthetic:sphere:24x24x24");
    for (auto* section : window_->findChildren<Section*>()) section->set_open(true);
    auto& tabs = part<QTabWidget>("tabs");
    for (const QSize size : {QSize(1400, 900), QSize(1024, 700)}) {
        window_->resize(size);
        wait_until_quiet(*window_);
        for (int page = 0; page < tabs.count(); ++page) {
            tabs.setCurrentIndex(page);
            wait_until_quiet(*window_);
            EXPECT_LE(4 * part<QWidget>("dock").width(), window_->width()) << page;
        }
    }
}

TEST_F(DrawnWords, leave_the_pages_eight_lines_of_a_small_window) {
    window_->resize(1024, 700);
    feel("synthetic:sphere:24x24x24");
    wait_until_quiet(*window_);
    EXPECT_LE(window_->height(), 700);
    const QWidget& page = *part<QTabWidget>("tabs").currentWidget();
    EXPECT_GE(page.height(), 8 * page.fontMetrics().lineSpacing());
    save("small");
}

TEST_F(WordsInWindow, of_a_notice_in_a_small_window_are_seen_to_their_end) {
    feel("synthetic:sphere:24x24x24");
    window_->resize(640, 600);
    wait_until_quiet(*window_);
    QStatusBar& bar = *window_->statusBar();
    auto& readout = part<QLabel>("readout");
    wait_until([&] { return !readout.text().isEmpty(); });
    const auto room = [&] {
        int right = bar.width();
        for (const auto* label : bar.findChildren<QLabel*>()) {
            if (label->isVisible()) right = std::min(right, label->x());
        }
        return right;
    };
    const QString words = "Felt through the device simulated with a hand";
    window_->messages().show_done(words);
    wait_until([&] { return bar.currentMessage() == words; });
    wait_until_quiet(bar);
    wait_until([&] { return room() > bar.fontMetrics().horizontalAdvance(words); });
    bar.clearMessage();
    wait_until([&] { return readout.isVisible(); });
    // Longer than the window: dots at the end, and all of it as the tip.
    const QString longer = QString("many words ").repeated(20);
    const auto end_of = [&](const QString& message) {
        bar.showMessage(message);
        wait_until_quiet(bar);
        return bar.grab().toImage();
    };
    EXPECT_EQ(end_of(longer), end_of(longer + "and more")) << "what is cut off is not seen";
    EXPECT_NE(end_of(longer), end_of(bar.fontMetrics().elidedText(longer, Qt::ElideRight, 300)));
    EXPECT_TRUE(bar.toolTip().contains("many words"));
}

TEST_F(WordsInWindow, stay_in_their_place_when_the_hand_touches) {
    feel("synthetic:sphere:48x48x48");
    const auto places = [&] {
        std::vector<QRect> all;
        for (const char* name : {"session_part", "isovalue_part", "tabs", "force_bar"}) {
            auto& widget = part<QWidget>(name);
            all.emplace_back(widget.mapTo(window_.get(), QPoint()), widget.size());
        }
        return all;
    };
    const auto before = places();
    press_until_force();
    wait_until([&] { return part<QLabel>("contact").text().startsWith("In contact"); });
    EXPECT_EQ(places(), before);
}

/// Lines of all that is seen of the panel, by its names: the upper end and the height. Texts that
/// change have other widths.
std::map<QString, std::pair<int, int>> places_in(const QWidget& panel) {
    std::map<QString, std::pair<int, int>> places;
    for (const auto* one : panel.findChildren<QWidget*>()) {
        if (!one->isVisible() || one->objectName().isEmpty() || qobject_cast<const Note*>(one)) {
            continue;
        }
        places[one->objectName()] = {one->mapTo(&panel, QPoint()).y(), one->height()};
    }
    return places;
}

/// The same once the parts that were opened have found their places: texts that wrap take several
/// rounds of events.
std::map<QString, std::pair<int, int>> places_at_rest(MainWindow& window) {
    std::map<QString, std::pair<int, int>> before, now = places_in(window.panel());
    for (int same = 0; same < 3; same = now == before ? same + 1 : 0) {
        before = std::move(now);
        window.tick();
        wait_until_quiet(window);
        now = places_in(window.panel());
    }
    return now;
}

TEST_F(WordsInWindow, of_a_note_lie_over_the_picture_and_move_nothing_in_the_panel) {
    feel("synthetic:sphere:24x24x24");
    auto& tabs = part<QTabWidget>("tabs");
    const auto& notes = part<QLabel>("notes");
    int said = 0;
    for (int page = 0; page < tabs.count(); ++page) {
        tabs.setCurrentIndex(page);
        for (auto* section : window_->findChildren<Section*>()) {
            section->set_open(section->objectName() != "loop_part");  // whose numbers change
        }
        const auto before = places_at_rest(*window_);
        for (Note* note : window_->panel().findChildren<Note*>()) {
            if (!note->parentWidget()->isVisibleTo(&window_->panel())) continue;
            ++said;
            const QString words = "Word upon word about " + note->objectName();
            // What its control shows of the session may take the words back at once.
            wait_until([&] {
                note->say(words);
                window_->tick();
                return notes.isVisible() && notes.text().contains(words);
            });
            EXPECT_TRUE(places_at_rest(*window_) == before) << words.toStdString();
            note->say({});
        }
    }
    EXPECT_GT(said, 12);
}

TEST_F(WordsInWindow, of_a_refusal_are_seen_over_the_picture_until_they_are_closed) {
    feel("synthetic:sphere:24x24x24");
    auto& box = on_page<NumberBox>("threshold_box");
    auto& notes = part<QLabel>("notes");
    const auto type = [&](const char* number) {
        box.setFocus();
        QTest::keyClick(&box, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(&box, number);
        QTest::keyClick(&box, Qt::Key_Return);
    };
    part<QAbstractButton>("penetrability").click();
    const auto before = places_at_rest(*window_);
    type("-1");
    wait_until([&] { return notes.isVisible() && notes.text().contains("at least 0 mm"); });
    EXPECT_TRUE(places_at_rest(*window_) == before);
    EXPECT_TRUE(part<QToolButton>("penetrability_part_heading").toolTip().contains("at least 0"));
    save("note");
    // The cross is at the end of its line.
    const auto is_shown = [&] { return notes.isVisible() && notes.text().contains("at least 0"); };
    for (int y = 6; y < notes.height() && is_shown(); y += 6) {
        for (int x = notes.width() - 2; x > 0 && is_shown(); x -= 3) {
            QTest::mouseClick(&notes, Qt::LeftButton, {}, {x, y});
            window_->tick();
            window_->tick();
        }
    }
    EXPECT_FALSE(is_shown());
    EXPECT_TRUE(part<QToolButton>("penetrability_part_heading").toolTip().contains("at least 0"));
    type("2");
    for (int i = 0; i < 8; ++i) window_->tick();
    type("-1");
    wait_until([&] { return notes.isVisible() && notes.text().contains("at least 0 mm"); });
}

}  // namespace
}  // namespace palpate::viewer::test

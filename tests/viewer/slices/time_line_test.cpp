// The time line: its clock, and a person at it.
#include "apps/viewer/slices/time_line.hpp"

#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QLabel>
#include <QMouseEvent>
#include <QPalette>
#include <QTest>
#include <QToolButton>

#include <gtest/gtest.h>

#include <cmath>

#include "apps/viewer/slices/time_track.hpp"

namespace palpate::viewer {
namespace {

/// A recording of `seconds` that began at 5 s: a press a second, the level rising once.
Overview some_overview(double seconds) {
    Overview overview;
    overview.begin = 5;
    overview.end = 5 + seconds;
    overview.width = seconds / 1000;
    for (int i = 0; i < 1000; ++i) {
        const double t = i * overview.width;
        Overview::Piece piece;
        piece.empty = i > 600 && i < 620;  // the machine was late
        piece.contact = std::fmod(t, 1) > 0.5;
        piece.least_force = piece.contact ? 2 * std::sin(3.1416 * 2 * (std::fmod(t, 1) - 0.5)) : 0;
        piece.most_force = 1.2 * piece.least_force;
        piece.least_isovalue = piece.most_isovalue = i < 300 ? 500 : std::min(900, 500 + i);
        overview.pieces.push_back(piece);
    }
    for (double t = 0.5; t < seconds; t += 1) {
        overview.contacts.push_back({5 + t, 5 + std::min(t + 0.5, seconds)});
    }
    return overview;
}

struct ShownLine {
    explicit ShownLine(double seconds) {
        line.resize(800, line.sizeHint().height());
        if (seconds > 0) line.set_overview(some_overview(seconds));
        line.show();
        (void)QTest::qWaitForWindowExposed(&line);
        QObject::connect(&line, &TimeLine::time_chosen, &line,
                         [this](double time) { times.push_back(time); });
        QObject::connect(&line, &TimeLine::playing_changed, &line,
                         [this](bool playing) { states.push_back(playing); });
    }
    TimeTrack* track() { return line.findChild<TimeTrack*>("time_track"); }
    QToolButton* button() { return line.findChild<QToolButton*>("play"); }
    QString label() { return line.findChild<QLabel*>("time")->text(); }

    TimeLine line;
    std::vector<double> times;
    std::vector<bool> states;
};

TEST(TimeLine, a_click_on_the_track_chooses_that_time) {
    ShownLine shown(20);
    TimeTrack* const track = shown.track();
    QTest::mouseClick(track, Qt::LeftButton, Qt::NoModifier, track->rect().center());
    ASSERT_EQ(shown.times.size(), 1U);
    EXPECT_NEAR(shown.times[0], 15, 0.1);
    EXPECT_EQ(shown.line.time(), shown.times[0]);
    EXPECT_NE(shown.label().left(4), "0:00");
    EXPECT_TRUE(shown.label().endsWith("/ 0:20.000")) << shown.label().toStdString();
    QTest::mousePress(track, Qt::LeftButton, Qt::NoModifier, track->rect().center());
    QMouseEvent move(QEvent::MouseMove, QPointF(-50, 5), Qt::NoButton, Qt::LeftButton,
                     Qt::NoModifier);
    QApplication::sendEvent(track, &move);
    QTest::mouseRelease(track, Qt::LeftButton, Qt::NoModifier, {-50, 5});
    EXPECT_EQ(shown.times.back(), 5);  // the begin
}

TEST(TimeLine, keys_go_by_ten_milliseconds_and_by_tenths) {
    ShownLine shown(20);
    shown.line.set_time(7);
    EXPECT_TRUE(shown.times.empty());
    QTest::keyClick(shown.track(), Qt::Key_Right);
    EXPECT_NEAR(shown.line.time(), 7.01, 1e-9);
    QTest::keyClick(shown.track(), Qt::Key_PageUp);
    EXPECT_NEAR(shown.line.time(), 9.01, 1e-9);
    QTest::keyClick(shown.track(), Qt::Key_End);
    EXPECT_EQ(shown.line.time(), 25);
    QTest::keyClick(shown.track(), Qt::Key_Home);
    EXPECT_EQ(shown.line.time(), 5);
    EXPECT_EQ(shown.times.size(), 4U);
}

TEST(TimeLine, it_plays_to_the_end_and_stops_there) {
    ShownLine shown(0.3);
    QTest::mouseClick(shown.button(), Qt::LeftButton);
    EXPECT_TRUE(shown.line.playing());
    ASSERT_TRUE(QTest::qWaitFor([&] { return !shown.line.playing(); }, 20'000));
    EXPECT_EQ(shown.states, (std::vector<bool>{true, false}));
    ASSERT_GE(shown.times.size(), 2U);
    EXPECT_TRUE(std::is_sorted(shown.times.begin(), shown.times.end()));
    EXPECT_EQ(shown.times.back(), 5.3);
    EXPECT_EQ(shown.line.time(), 5.3);
    // Once more it begins at the begin.
    shown.times.clear();
    shown.line.set_playing(true);
    ASSERT_TRUE(QTest::qWaitFor([&] { return !shown.times.empty(); }, 20'000));
    EXPECT_LE(shown.times.front(), 5.3);
    EXPECT_EQ(shown.line.playing(), shown.times.back() < 5.3);
}

TEST(TimeLine, with_loop_it_begins_again) {
    ShownLine shown(0.1);
    QTest::mouseClick(shown.line.findChild<QCheckBox*>("loop"), Qt::LeftButton, Qt::NoModifier,
                      {8, 8});
    ASSERT_TRUE(shown.line.loops());
    shown.line.set_playing(true);
    ASSERT_TRUE(QTest::qWaitFor(
        [&] { return !std::is_sorted(shown.times.begin(), shown.times.end()); }, 20'000));
    EXPECT_TRUE(shown.line.playing());
    for (const double time : shown.times) {
        EXPECT_GE(time, 5);
        EXPECT_LE(time, 5.1);
    }
    shown.line.set_playing(false);
    EXPECT_FALSE(shown.line.playing());
}

TEST(TimeLine, slower_it_goes_less_far_in_the_same_time) {
    ShownLine slow(1000), fast(1000);
    slow.line.set_speed(0.1);
    fast.line.set_speed(4);
    EXPECT_EQ(slow.line.speed(), 0.1);
    EXPECT_EQ(fast.line.speed(), 4);
    fast.line.set_speed(3.4);
    EXPECT_EQ(fast.line.speed(), 4);
    slow.line.set_playing(true);
    fast.line.set_playing(true);
    // Both by the same clock, however the machine stumbles: 40 times apart, but for a frame.
    ASSERT_TRUE(QTest::qWaitFor([&] { return slow.times.size() >= 10 && fast.times.size() >= 10; },
                                20'000));
    const double slowly = slow.line.time() - 5, quickly = fast.line.time() - 5;
    EXPECT_GT(slowly, 0);
    EXPECT_GT(quickly, 10 * slowly);
}

TEST(TimeLine, hidden_it_pauses_and_another_recording_begins_anew) {
    ShownLine shown(100);
    shown.line.set_playing(true);
    shown.line.hide();
    EXPECT_FALSE(shown.line.playing());
    EXPECT_EQ(shown.states, (std::vector<bool>{true, false}));
    shown.line.show();
    shown.line.set_time(50);
    shown.line.set_playing(true);
    shown.line.set_overview(some_overview(7200));
    EXPECT_FALSE(shown.line.playing());
    EXPECT_EQ(shown.line.time(), 5);
    EXPECT_EQ(shown.label(), "0:00.000 / 2:00:00.000");
    shown.line.set_time(5 + 3661.5);
    EXPECT_EQ(shown.label(), "1:01:01.500 / 2:00:00.000");
}

TEST(TimeLine, without_a_recording_it_does_nothing) {
    ShownLine shown(0);
    EXPECT_FALSE(shown.line.isEnabled());
    shown.line.set_playing(true);
    EXPECT_FALSE(shown.line.playing());
    shown.line.set_time(3);
    shown.line.set_time(std::nan(""));
    shown.line.grab();
    shown.line.set_overview(some_overview(5));
    EXPECT_TRUE(shown.line.isEnabled());
    shown.line.clear();
    EXPECT_FALSE(shown.line.isEnabled());
    // A recording of one tick has no length.
    Overview single;
    single.begin = single.end = 3;
    single.pieces.resize(1);
    shown.line.set_overview(single);
    shown.line.set_loop(true);
    shown.line.set_playing(true);
    ASSERT_TRUE(QTest::qWaitFor([&] { return !shown.line.playing(); }, 20'000));
    EXPECT_EQ(shown.line.time(), 3);
    shown.line.grab();
}

TEST(TimeLine, destroyed_while_it_plays_it_is_gone) {
    auto shown = std::make_unique<ShownLine>(10);
    shown->line.set_playing(true);
    QTest::qWait(20);
    shown.reset();
    QTest::qWait(40);
}

TEST(TimeLinePictures, dark_and_light) {
    const QPalette before = QApplication::palette();
    for (const bool dark : {false, true}) {
        if (dark) {
            QPalette palette(QColor(60, 60, 60), QColor(40, 40, 40));
            palette.setColor(QPalette::Base, QColor(25, 25, 25));
            palette.setColor(QPalette::Highlight, QColor(80, 140, 220));
            QApplication::setPalette(palette);
        }
        ShownLine shown(12);
        shown.line.set_time(9.2);
        QDir().mkpath(PALPATE_PICTURES);
        const QString scale = shown.line.devicePixelRatioF() > 1 ? "_fine" : "";
        EXPECT_TRUE(shown.line.grab().save(QString(PALPATE_PICTURES) + "/time_line" +
                                           (dark ? "_dark" : "_light") + scale + ".png"));
    }
    QApplication::setPalette(before);
}

}  // namespace
}  // namespace palpate::viewer

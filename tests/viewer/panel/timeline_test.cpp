// The timeline, with a sequence and with a recording, used by mouse and keys.
#include "apps/viewer/panel/timeline.hpp"

#include <QApplication>
#include <QCheckBox>
#include <QDir>
#include <QLabel>
#include <QMouseEvent>
#include <QPalette>
#include <QSignalSpy>
#include <QTest>
#include <QToolButton>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/viewer/panel/inputs.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer {
namespace {

/// Six frames, 0.8 s apart from 0 to 4 s; round in 4.8 s where it loops.
TimelineView six() {
    TimelineView view;
    view.end = 4.8;
    for (int i = 0; i < 6; ++i) view.frames.push_back(0.8 * i);
    view.time = 1.7;
    view.loaded_from = 0.8;
    view.loaded_to = 3.2;
    return view;
}

class ATimeline : public testing::Test {
  protected:
    ATimeline() {
        bar.resize(900, bar.sizeHint().height());
        show(six());
        bar.show();
        activate(bar);
        const auto ask = [this](auto& asked, auto member) {
            return [this, &asked, member](auto to) {
                asked.push_back(to);
                shown.*member = to;
                bar.set_view(shown);
            };
        };
        QObject::connect(&bar, &Timeline::speed_asked, ask(speeds, &TimelineView::speed));
        QObject::connect(&bar, &Timeline::moment_asked, ask(times, &TimelineView::time));
        QObject::connect(&bar, &Timeline::loop_asked, ask(loops, &TimelineView::loop));
    }
    /// What is asked for afterwards changes this view.
    void show(const TimelineView& view) {
        shown = view;
        bar.set_view(view);
    }
    template <class T>
    T* find(const char* name) {
        T* found = bar.findChild<T*>(name);
        if (!found) throw std::runtime_error(std::string("no widget ") + name);
        return found;
    }
    TimelineTrack* track() { return find<TimelineTrack>("timeline_track"); }
    QString text() { return find<QLabel>("timeline_time")->text(); }
    void press(const char* name) { QTest::mouseClick(find<QWidget>(name), Qt::LeftButton); }
    void settle() const { wait_until_quiet(bar); }
    void move_to(double part) {
        QMouseEvent event(QEvent::MouseMove, QPointF(part * track()->width(), 5), Qt::NoButton,
                          Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(track(), &event);
    }
    void picture(const QString& name) {
        QApplication::processEvents();
        const QImage image = bar.grab().toImage();
        QDir().mkpath(PALPATE_PICTURES);
        const QString scale = image.devicePixelRatio() > 1.5 ? "_2x" : "";
        EXPECT_TRUE(image.save(QString(PALPATE_PICTURES) + "/" + name + scale + ".png"));
    }

    TimelineView shown;
    std::vector<double> speeds, times;
    std::vector<bool> loops;
    Timeline bar;
};

TEST_F(ATimeline, views_are_shown_and_emit_nothing) {
    EXPECT_EQ(text(), "1.70 s, frame 3 of 6");
    TimelineView view = six();
    view.time = 1.6;
    view.speed = 2;
    view.loop = true;
    show(view);
    EXPECT_EQ(text(), "1.60 s, frame 3 of 6");
    EXPECT_EQ(find<NumberBox>("timeline_speed")->value(), 2);
    EXPECT_TRUE(find<QCheckBox>("timeline_loop")->isChecked());
    EXPECT_EQ(find<QToolButton>("timeline_play")->accessibleName(), "Pause");
    view.time = 10.4;  // the session's clock goes on: twice round and 0.8 s
    show(view);
    EXPECT_EQ(text(), "0.80 s, frame 2 of 6");
    show({});
    EXPECT_EQ(text(), "");
    EXPECT_FALSE(bar.isEnabled());
    settle();
    EXPECT_TRUE(times.empty());
    EXPECT_TRUE(speeds.empty());
    EXPECT_TRUE(loops.empty());
}

TEST_F(ATimeline, play_asks_for_the_speed_in_the_box_and_pause_for_none) {
    press("timeline_play");
    EXPECT_EQ(speeds, (std::vector<double>{1}));
    TimelineView view = six();
    view.speed = 1;
    show(view);
    press("timeline_play");
    EXPECT_EQ(speeds, (std::vector<double>{1, 0}));
    EXPECT_TRUE(times.empty());
}

TEST_F(ATimeline, the_speed_of_the_box_is_asked_for_at_once_while_it_plays_else_with_play) {
    auto* box = find<NumberBox>("timeline_speed");
    const auto type = [&](const QString& number) {
        box->setFocus();
        QTest::keyClick(box, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(box, number);
        QTest::keyClick(box, Qt::Key_Return);
    };
    type("0.25");
    EXPECT_TRUE(speeds.empty());
    press("timeline_play");
    EXPECT_EQ(speeds, (std::vector<double>{0.25}));
    type("4");
    EXPECT_EQ(speeds, (std::vector<double>{0.25, 4}));
    type("1000");  // as fast as it goes
    EXPECT_EQ(speeds.back(), 10);
    EXPECT_EQ(box->value(), 10);
    QTest::keyClick(box, Qt::Key_Down);
    EXPECT_EQ(speeds, (std::vector<double>{0.25, 4, 10, 5}));
    press("timeline_play");
    press("timeline_play");
    EXPECT_EQ(speeds, (std::vector<double>{0.25, 4, 10, 5, 0, 5})) << "it remembers";
}

TEST_F(ATimeline, views_leave_a_speed_alone_that_is_being_typed) {
    TimelineView view = six();
    view.speed = 1;
    show(view);
    auto* box = find<NumberBox>("timeline_speed");
    box->setFocus();
    QTest::keyClick(box, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(box, "2.");
    view.time = 1.9;
    show(view);
    QTest::keyClicks(box, "5");
    QTest::keyClick(box, Qt::Key_Return);
    EXPECT_EQ(speeds, (std::vector<double>{2.5}));
}

TEST_F(ATimeline, steps_go_to_the_frame_before_and_after) {
    press("timeline_forward");
    EXPECT_EQ(times, (std::vector<double>{0.8 * 3}));
    press("timeline_forward");
    EXPECT_EQ(times.back(), 0.8 * 4);
    press("timeline_back");
    press("timeline_back");
    EXPECT_EQ(times.back(), 0.8 * 2);
    EXPECT_EQ(times.size(), 4U);
    EXPECT_EQ(text(), "1.60 s, frame 3 of 6");
    EXPECT_TRUE(speeds.empty()) << "it stood still already";
}

TEST_F(ATimeline, a_step_past_the_last_frame_goes_round_only_where_it_loops) {
    TimelineView view = six();
    view.time = 4.5;
    show(view);
    press("timeline_forward");
    EXPECT_TRUE(times.empty());
    view.loop = true;
    show(view);
    press("timeline_forward");
    EXPECT_EQ(times, (std::vector<double>{0}));
    press("timeline_back");
    EXPECT_EQ(times.back(), 0.8 * 5);
}

TEST_F(ATimeline, a_step_ends_playing) {
    TimelineView view = six();
    view.speed = 1;
    show(view);
    press("timeline_back");
    EXPECT_EQ(speeds, (std::vector<double>{0}));
    EXPECT_EQ(times, (std::vector<double>{0.8 * 2}));
    EXPECT_EQ(find<QToolButton>("timeline_play")->accessibleName(), "Play");
}

TEST_F(ATimeline, a_click_on_the_track_seeks_once) {
    QTest::mouseClick(track(), Qt::LeftButton, Qt::NoModifier, track()->rect().center());
    settle();
    ASSERT_EQ(times.size(), 1U);
    EXPECT_NEAR(times[0], 2.4, 0.02);
    EXPECT_TRUE(speeds.empty());
}

TEST_F(ATimeline, views_do_not_fight_a_drag_and_its_last_moment_comes) {
    QTest::mousePress(track(), Qt::LeftButton, Qt::NoModifier, track()->rect().center());
    TimelineView view = six();
    view.speed = 1;
    for (int i = 1; i <= 20; ++i) {
        move_to(0.5 + 0.02 * i);
        const double held = track()->time();
        view.time = 0.1 * i;
        show(view);
        EXPECT_EQ(track()->time(), held);
    }
    move_to(2);
    QTest::mouseRelease(track(), Qt::LeftButton, Qt::NoModifier, {track()->width() * 2, 5});
    ASSERT_GE(times.size(), 2U);
    EXPECT_EQ(times.back(), 4.8);
    EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
    const std::size_t count = times.size();
    settle();
    EXPECT_EQ(times.size(), count) << "nothing comes after the release";
    EXPECT_EQ(track()->time(), 4.8);
    view.time = 4.79;
    show(view);
    EXPECT_EQ(track()->time(), 4.79);
}

TEST_F(ATimeline, keys_go_by_frames_by_tenths_and_to_the_ends) {
    track()->setFocus();
    QTest::keyClick(track(), Qt::Key_Right);
    EXPECT_EQ(times.back(), 0.8 * 3);
    QTest::keyClick(track(), Qt::Key_Left);
    EXPECT_EQ(times.back(), 0.8 * 2);
    QTest::keyClick(track(), Qt::Key_PageUp);
    settle();
    EXPECT_NEAR(times.back(), 1.6 + 0.48, 1e-9);
    QTest::keyClick(track(), Qt::Key_Home);
    settle();
    EXPECT_EQ(times.back(), 0);
    QTest::keyClick(track(), Qt::Key_End);
    settle();
    EXPECT_EQ(times.back(), 4.8);
    EXPECT_EQ(times.size(), 5U);
}

TEST_F(ATimeline, loop_and_return_on_a_button_are_emitted_once) {
    auto* loop = find<QCheckBox>("timeline_loop");
    loop->setFocus();
    QTest::keyClick(loop, Qt::Key_Space);
    EXPECT_EQ(loops, (std::vector<bool>{true}));
    EXPECT_TRUE(loop->isChecked());
    auto* play = find<QToolButton>("timeline_play");
    play->setFocus();
    QTest::keyClick(play, Qt::Key_Return);
    bar.toggle_playing();
    EXPECT_EQ(speeds, (std::vector<double>{1, 0}));
}

TEST_F(ATimeline, a_live_source_can_be_held_but_not_sought) {
    TimelineView view = six();
    view.live = true;
    view.speed = 1;
    show(view);
    EXPECT_EQ(text(), "1.70 s, live");
    for (const char* name : {"timeline_back", "timeline_forward", "timeline_track",
                             "timeline_speed", "timeline_loop"}) {
        EXPECT_FALSE(find<QWidget>(name)->isEnabled()) << name;
    }
    QTest::mouseClick(track(), Qt::LeftButton, Qt::NoModifier, track()->rect().center());
    bar.step(1);
    settle();
    EXPECT_TRUE(times.empty());
    press("timeline_play");
    EXPECT_EQ(speeds, (std::vector<double>{0}));
}

TEST_F(ATimeline, a_drag_ends_when_another_sequence_or_a_live_source_comes) {
    QTest::mousePress(track(), Qt::LeftButton, Qt::NoModifier, track()->rect().center());
    move_to(0.6);
    move_to(0.7);
    const std::size_t count = times.size();
    TimelineView view = six();
    view.live = true;
    show(view);
    settle();
    EXPECT_EQ(times.size(), count) << "the moment that waited was one of the former";
    EXPECT_EQ(text(), "1.70 s, live");
}

/// Counts how often a widget is drawn.
struct Paints : QObject {
    int count = 0;
    bool eventFilter(QObject*, QEvent* event) override {
        count += event->type() == QEvent::Paint;
        return false;
    }
};

TEST_F(ATimeline, a_view_like_the_last_draws_nothing) {
    settle();
    Paints paints;
    for (auto* one : bar.findChildren<QWidget*>()) one->installEventFilter(&paints);
    for (int i = 0; i < 30; ++i) show(six());
    settle();
    EXPECT_EQ(paints.count, 0);
    TimelineView view = six();
    view.time = 1.9;
    show(view);
    wait_until([&] { return paints.count > 0; });
}

TEST(TimelineValues, what_is_in_memory_may_go_round_the_end) {
    TimelineView view = six();
    view.loop = true;
    view.loaded_from = 4;
    view.loaded_to = 5.6;
    auto parts = loaded_stretches(view);
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].from, 0);
    EXPECT_NEAR(parts[0].to, 0.8, 1e-12);
    EXPECT_EQ(parts[1].from, 4);
    EXPECT_EQ(parts[1].to, 4.8);
    view.loaded_to = 0.8;  // the same, told the other way
    parts = loaded_stretches(view);
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_NEAR(parts[0].to, 0.8, 1e-12);
    view.loop = false;
    EXPECT_TRUE(loaded_stretches(view).empty());
    view.loaded_from = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(loaded_stretches(view).empty());
}

/// A recording of `seconds` that began at 5 s: one press each second, the level rises once.
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
    return overview;
}

TimelineView recording(double seconds) {
    TimelineView view;
    view.begin = view.time = 5;
    view.end = 5 + seconds;
    view.overview = std::make_shared<Overview>(some_overview(seconds));
    return view;
}

TEST_F(ATimeline, a_recording_shows_its_time_from_the_begin_and_its_length) {
    show(recording(20));
    EXPECT_EQ(text(), "0:00.000 / 0:20.000");
    TimelineView hours = recording(7200);
    hours.time = 5 + 3661.5;
    show(hours);
    EXPECT_EQ(text(), "1:01:01.500 / 2:00:00.000");
    EXPECT_TRUE(times.empty());
    EXPECT_TRUE(find<QWidget>("timeline_loop")->isEnabled());
}

TEST_F(ATimeline, a_click_on_the_track_of_a_recording_asks_for_that_time) {
    show(recording(20));
    QTest::mousePress(track(), Qt::LeftButton, Qt::NoModifier, track()->rect().center());
    ASSERT_EQ(times.size(), 1U);
    EXPECT_NEAR(times[0], 15, 0.1);
    move_to(-1);
    QTest::mouseRelease(track(), Qt::LeftButton, Qt::NoModifier, {-50, 5});
    EXPECT_EQ(times.back(), 5);
}

TEST_F(ATimeline, keys_go_through_a_recording_by_ten_milliseconds_and_by_tenths) {
    TimelineView view = recording(20);
    view.time = 7;
    show(view);
    QTest::keyClick(track(), Qt::Key_Right);
    EXPECT_NEAR(times.back(), 7.01, 1e-9);
    QTest::keyClick(track(), Qt::Key_PageUp);
    settle();
    EXPECT_NEAR(times.back(), 9.01, 1e-9);
    QTest::keyClick(track(), Qt::Key_End);
    settle();
    EXPECT_EQ(times.back(), 25);
    QTest::keyClick(track(), Qt::Key_Right);
    EXPECT_EQ(times.back(), 25);
    QTest::keyClick(track(), Qt::Key_Home);
    settle();
    EXPECT_EQ(times.back(), 5);
}

TEST_F(ATimeline, a_recording_of_one_tick_has_no_length_and_can_be_shown) {
    TimelineView single;
    single.begin = single.end = single.time = 3;
    auto overview = std::make_shared<Overview>();
    overview->begin = overview->end = 3;
    overview->pieces.resize(1);
    single.overview = overview;
    show(single);
    EXPECT_TRUE(bar.isEnabled());
    bar.grab();
    EXPECT_EQ(text(), "0:00.000 / 0:00.000");
}

TEST(TimelineValues, the_track_of_a_recording_tells_force_level_and_contact) {
    const QString words = overview_text_at(recording(20), 5.75);
    EXPECT_TRUE(words.startsWith("0.750 s")) << words.toStdString();
    EXPECT_TRUE(words.contains("force up to 2."));
    EXPECT_TRUE(words.contains("isovalue 500"));
    EXPECT_TRUE(words.contains("in contact"));
    EXPECT_EQ(overview_text_at(recording(20), 5 + 12.2), "12.200 s") << "nothing was recorded";
}

TEST(TimelineValues, times_outside_go_round_or_to_the_ends) {
    TimelineView view = six();
    EXPECT_EQ(within(view, -1), 0);
    EXPECT_EQ(within(view, 7), 4.8);
    EXPECT_EQ(within(view, std::nan("")), 0);
    view.loop = true;
    EXPECT_NEAR(within(view, -1), 3.8, 1e-12);
    EXPECT_NEAR(within(view, 7), 2.2, 1e-12);
    EXPECT_EQ(within(view, 4.8), 4.8);
    EXPECT_EQ(within({}, 3), 0);
}

TEST_F(ATimeline, tab_goes_from_left_to_right_and_every_control_has_a_name_and_a_tip) {
    int x = -1, visited = 0;
    for (QWidget* one = bar.nextInFocusChain(); one != &bar; one = one->nextInFocusChain()) {
        if (!bar.isAncestorOf(one) || !(one->focusPolicy() & Qt::TabFocus) || one->focusProxy()) {
            continue;
        }
        if (one->objectName().startsWith("qt_")) continue;  // the line in a box
        EXPECT_GT(one->x(), x) << one->objectName().toStdString();
        x = one->x();
        ++visited;
        const auto* box = qobject_cast<QCheckBox*>(one);
        EXPECT_TRUE(!one->accessibleName().isEmpty() || (box && !box->text().isEmpty()))
            << one->objectName().toStdString();
        const bool tells = one == track() || !one->toolTip().isEmpty();  // the track: where it is
        EXPECT_TRUE(tells) << one->objectName().toStdString();
    }
    EXPECT_EQ(visited, 6);
}

TEST_F(ATimeline, is_drawn_in_light_and_dark_and_live) {
    TimelineView view = six();
    view.loop = true;
    view.loaded_from = 3.2;
    view.loaded_to = 0.8;
    show(view);
    picture("timeline_light");
    const QPalette usual = QApplication::palette();
    QPalette dark(QColor(58, 58, 62), QColor(45, 45, 48));
    dark.setColor(QPalette::Base, QColor(28, 28, 30));
    dark.setColor(QPalette::Highlight, QColor(42, 130, 218));
    QApplication::setPalette(dark);
    view.speed = 0.5;
    show(view);
    picture("timeline_dark");
    view.live = true;
    show(view);
    picture("timeline_live_dark");
    TimelineView pressed = recording(12);
    pressed.time = 9.2;
    show(pressed);
    bar.resize(bar.width(), bar.sizeHint().height());
    picture("timeline_recording_dark");
    QApplication::setPalette(usual);
    picture("timeline_recording_light");
    TimelineView many;
    for (int i = 0; i < 3000; ++i) many.frames.push_back(1e-3 * i);
    many.end = 3;
    many.time = 1.2345;
    many.loaded_from = 1;
    many.loaded_to = 2;
    show(many);
    bar.resize(bar.minimumSizeHint().width(), bar.height());
    EXPECT_EQ(text(), "1.2345 s, frame 1235 of 3000");
    picture("timeline_many_narrow");
}

}  // namespace
}  // namespace palpate::viewer

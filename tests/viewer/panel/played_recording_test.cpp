// How the time of a recording goes on while it is played.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "apps/viewer/panel/timeline.hpp"

namespace palpate::viewer {
namespace {

TimelineView recording_between(double begin, double end) {
    TimelineView view;
    view.begin = view.time = begin;
    view.end = end;
    return view;
}

TEST(PlayedRecording, plays_to_the_end_pauses_there_and_begins_again) {
    TimelineView clock = recording_between(5, 7);
    clock.advance(1);
    EXPECT_EQ(clock.time, 5) << "it is paused";
    clock.play(0.5);
    clock.advance(1);
    EXPECT_EQ(clock.time, 5.5);
    clock.advance(10);
    EXPECT_EQ(clock.time, 7);
    EXPECT_EQ(clock.speed, 0);
    clock.play(1);
    EXPECT_EQ(clock.time, 5);
}

TEST(PlayedRecording, wraps_around_in_a_loop) {
    TimelineView clock = recording_between(5, 7);
    clock.set_loop(true);
    clock.play(4);
    clock.advance(0.625);
    EXPECT_DOUBLE_EQ(clock.time, 5.5);
    EXPECT_EQ(clock.speed, 4);
}

TEST(PlayedRecording, a_recording_of_one_tick_ends_at_once_even_in_a_loop) {
    TimelineView clock = recording_between(3, 3);
    clock.set_loop(true);
    clock.play(1);
    clock.advance(0.1);
    EXPECT_EQ(clock.time, 3);
    EXPECT_EQ(clock.speed, 0);
}

TEST(PlayedRecording, seeks_within_the_recording_only) {
    TimelineView clock = recording_between(5, 7);
    for (const auto& [asked, is] : {std::pair{6.0, 6.0}, {9.0, 7.0}, {-1.0, 5.0}}) {
        clock.seek(asked);
        EXPECT_EQ(clock.time, is);
    }
    clock.seek(std::nan(""));
    EXPECT_EQ(clock.time, 5);
}

}  // namespace
}  // namespace palpate::viewer

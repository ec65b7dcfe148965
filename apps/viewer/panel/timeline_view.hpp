// What a timeline shows of a sequence or a recording: plain values, and what follows from them.
#pragma once

#include <QString>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/playback.hpp"

namespace palpate::viewer {

/// All times in seconds.
struct TimelineView {
    double begin = 0, end = 0;   ///< of a loop, the end is the begin again
    std::vector<double> frames;  ///< their times, rising; none in a recording
    double time = 0;             ///< the present; past the ends it wraps around in a loop
    double speed = 0;            ///< seconds of it in a second; 0: paused
    bool loop = false;
    /// What is in memory; in a loop it may pass the end, or `loaded_to` lies below `loaded_from`.
    /// NaN: nothing.
    double loaded_from = 0, loaded_to = 0;
    bool live = false;                         ///< a live source: it cannot be sought
    std::shared_ptr<const Overview> overview;  ///< of a recording; else null
};

/// Nothing to play.
bool empty(const TimelineView& view);
/// A time brought between begin and end: wrapped around in a loop, else the nearer end.
double within(const TimelineView& view, double time);
/// The last frame not after a time, from 0. Nothing without frames.
std::optional<std::size_t> frame_at(const TimelineView& view, double time);
/// The time of the next frame after (`direction` > 0) or before a time; wraps around in a loop. In
/// a recording 10 ms further. Nothing where there is none.
std::optional<double> frame_beside(const TimelineView& view, double time, int direction);
/// "1.60 s, frame 3 of 6"; in a recording "0:01.600 / 0:20.000" from its begin.
QString text_at(const TimelineView& view, double time);
/// What happened at a time of a recording: force, isovalue, contact.
QString overview_text_at(const TimelineView& view, double time);

/// What is in memory: one stretch, or two in a loop.
std::vector<Overview::Interval> loaded_stretches(const TimelineView& view);

}  // namespace palpate::viewer

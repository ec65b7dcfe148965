// What a timeline shows of a sequence or a recording: plain values, and what follows from them.
#pragma once

#include <QString>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "apps/viewer/model/playback.hpp"
#include "palpate/run/player.hpp"

namespace palpate::viewer {

/// What is played, and where. In a loop `time` may lie past the ends and wraps around, and the
/// stretch in memory may pass the end, or `loaded_to` lies below `loaded_from`; NaN: nothing is in
/// memory. A recording has no frames.
struct TimelineView : run::PlayState {
    TimelineView() { loop = false; }
    explicit TimelineView(run::PlayState play) : run::PlayState(std::move(play)) {}

    /// Of a recording, a player goes on by itself. Seconds of it in a second; 0: pause. At the end
    /// it begins again.
    void play(double to);
    /// Outside of the recording, to its ends.
    void seek(double to) { time = std::isnan(to) ? begin : std::clamp(to, begin, end); }
    void set_loop(bool on) { loop = on; }
    /// `seconds` have passed. At the end it pauses, unless it loops.
    void advance(double seconds);

    std::shared_ptr<const Overview> overview;  ///< of a recording; else null
};

bool empty(const TimelineView& view);
double length(const TimelineView& view);  ///< [s]
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
struct Stretch {
    double from, to;  ///< [s]
};
std::vector<Stretch> loaded_stretches(const TimelineView& view);

}  // namespace palpate::viewer

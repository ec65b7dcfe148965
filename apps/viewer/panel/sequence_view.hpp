// What there is to see of a sequence that plays: plain values, and what can be reckoned from them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate::viewer {

/// All times in seconds.
struct SequenceView {
    double begin = 0, end = 0;   ///< where it goes round, the end is the begin again
    std::vector<double> frames;  ///< their times, rising
    double time = 0;             ///< where it is; one past the ends counts round where it loops
    double speed = 0;            ///< seconds of it in a second; 0: it stands still
    bool loop = false;
    /// What is in memory, round the end where it loops: past the end, or `loaded_to` below
    /// `loaded_from`. NaN: nothing.
    double loaded_from = 0, loaded_to = 0;
    bool live = false;  ///< frames come from a program that runs: nowhere to seek
};

/// Whether there is anything to play.
bool empty(const SequenceView& view);
/// A time brought between begin and end: round where it loops, else to the nearer one.
double within(const SequenceView& view, double time);
/// The frame that counts at a time, from 0: the last one not after it. Nothing without frames.
std::optional<std::size_t> frame_at(const SequenceView& view, double time);
/// The time of the frame next after (`way` > 0) or before a time; from the last one on to the first
/// where it loops. Nothing where there is none.
std::optional<double> frame_beside(const SequenceView& view, double time, int way);

struct Stretch {
    double from, to;
};
/// What is in memory, in one stretch or two between begin and end.
std::vector<Stretch> loaded_stretches(const SequenceView& view);

}  // namespace palpate::viewer

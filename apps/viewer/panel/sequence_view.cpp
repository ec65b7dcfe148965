// Where a time lies in a sequence.
#include "apps/viewer/panel/sequence_view.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::viewer {
namespace {

double length(const SequenceView& view) {
    return std::max(view.end - view.begin, 0.0);
}

/// By how much a time may miss a frame's and still be that frame's: rounding.
double rounding(const SequenceView& view) {
    return 1e-9 * std::max({length(view), std::abs(view.begin), std::abs(view.end)});
}

}  // namespace

bool empty(const SequenceView& view) {
    return view.frames.empty() && !view.live;
}

double within(const SequenceView& view, double time) {
    if (std::isnan(time)) return view.begin;
    if (time >= view.begin && time <= view.end) return time;
    if (!view.loop || length(view) == 0 || std::isinf(time)) {
        return time < view.begin ? view.begin : std::max(view.begin, view.end);
    }
    const double round = std::fmod(time - view.begin, length(view));
    return view.begin + (round < 0 ? round + length(view) : round);
}

std::optional<std::size_t> frame_at(const SequenceView& view, double time) {
    if (view.frames.empty()) return std::nullopt;
    const auto after = std::ranges::upper_bound(view.frames, time + rounding(view));
    return after == view.frames.begin() ? 0
                                        : static_cast<std::size_t>(after - view.frames.begin()) - 1;
}

std::optional<double> frame_beside(const SequenceView& view, double time, int way) {
    const std::vector<double>& frames = view.frames;
    if (frames.empty()) return std::nullopt;
    const bool round = view.loop && frames.size() > 1;
    if (way > 0) {
        const auto after = std::ranges::upper_bound(frames, time + rounding(view));
        if (after != frames.end()) return *after;
        return round ? std::optional(frames.front()) : std::nullopt;
    }
    const auto from = std::ranges::lower_bound(frames, time - rounding(view));
    if (from != frames.begin()) return *(from - 1);
    return round ? std::optional(frames.back()) : std::nullopt;
}

std::vector<Stretch> loaded_stretches(const SequenceView& view) {
    const double from = view.loaded_from, whole = length(view);
    double to = view.loaded_to;
    if (!std::isfinite(from) || !std::isfinite(to)) return {};
    if (to < from && view.loop) to += whole;
    if (to < from) return {};
    if (to - from >= whole && view.loop) return {{view.begin, view.end}};
    std::vector<Stretch> stretches;
    // As it is, and a length earlier or later, of which only one can reach in.
    for (const double shift : {-whole, 0.0, whole}) {
        if (shift != 0 && !view.loop) continue;
        const double low = std::max(from + shift, view.begin);
        const double high = std::min(to + shift, view.end);
        if (low < high || (low == high && from == to)) stretches.push_back({low, high});
    }
    return stretches;
}

}  // namespace palpate::viewer

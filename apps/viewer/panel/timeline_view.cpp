// Times, frames and texts of a timeline.
#include "apps/viewer/panel/timeline_view.hpp"

#include <QCoreApplication>
#include <algorithm>
#include <cmath>

namespace palpate::viewer {
namespace {

struct TimelineWords {
    Q_DECLARE_TR_FUNCTIONS(TimelineWords)
};

constexpr double recording_step = 0.01;  // [s]

/// Digits behind the point that tell one frame from the next, at least two.
int digits_for(const TimelineView& view) {
    if (view.frames.size() < 2) return 2;
    const double apart =
        (view.frames.back() - view.frames.front()) / static_cast<double>(view.frames.size() - 1);
    if (!(apart > 0)) return 2;
    return std::clamp(1 - static_cast<int>(std::floor(std::log10(apart))), 2, 9);
}

/// "1:02.345"; hours where there are any.
QString clock_text(double seconds) {
    const auto all = static_cast<long long>(std::floor(1e3 * seconds + 0.5));
    const long long minutes = all / 60000 % 60, hours = all / 3600000;
    const QString rest =
        QString("%1.%2").arg(all / 1000 % 60, 2, 10, QChar('0')).arg(all % 1000, 3, 10, QChar('0'));
    return hours > 0 ? QString("%1:%2:%3").arg(hours).arg(minutes, 2, 10, QChar('0')).arg(rest)
                     : QString("%1:%2").arg(minutes).arg(rest);
}

/// By how much a time may miss a frame's and still be that frame's: rounding.
double rounding(const TimelineView& view) {
    return 1e-9 * std::max({length(view), std::abs(view.begin), std::abs(view.end)});
}

}  // namespace

void TimelineView::play(double to) {
    if (speed == 0 && to != 0 && time >= end) time = begin;
    speed = to;
}

void TimelineView::advance(double seconds) {
    time += speed * seconds;
    if (time < end || speed == 0) return;
    if (loop && end > begin) {
        time = begin + std::fmod(time - begin, end - begin);
    } else {
        time = end;
        speed = 0;
    }
}

bool empty(const TimelineView& view) {
    return view.frames.empty() && !view.live && !view.overview;
}

double length(const TimelineView& view) {
    return std::max(view.end - view.begin, 0.0);
}

double within(const TimelineView& view, double time) {
    if (std::isnan(time)) return view.begin;
    if (time >= view.begin && time <= view.end) return time;
    if (!view.loop || length(view) == 0 || std::isinf(time)) {
        return time < view.begin ? view.begin : std::max(view.begin, view.end);
    }
    const double round = std::fmod(time - view.begin, length(view));
    return view.begin + (round < 0 ? round + length(view) : round);
}

std::optional<std::size_t> frame_at(const TimelineView& view, double time) {
    if (view.frames.empty()) return std::nullopt;
    const auto after = std::ranges::upper_bound(view.frames, time + rounding(view));
    return after == view.frames.begin() ? 0
                                        : static_cast<std::size_t>(after - view.frames.begin()) - 1;
}

std::optional<double> frame_beside(const TimelineView& view, double time, int direction) {
    const std::vector<double>& frames = view.frames;
    if (view.overview) {
        const double to = time + (direction > 0 ? recording_step : -recording_step);
        return std::clamp(to, view.begin, view.end);
    }
    if (frames.empty()) return std::nullopt;
    const bool round = view.loop && frames.size() > 1;
    if (direction > 0) {
        const auto after = std::ranges::upper_bound(frames, time + rounding(view));
        if (after != frames.end()) return *after;
        return round ? std::optional(frames.front()) : std::nullopt;
    }
    const auto from = std::ranges::lower_bound(frames, time - rounding(view));
    if (from != frames.begin()) return *(from - 1);
    return round ? std::optional(frames.back()) : std::nullopt;
}

QString text_at(const TimelineView& view, double time) {
    if (view.overview) {
        return clock_text(time - view.begin) + " / " + clock_text(view.end - view.begin);
    }
    const QString seconds = QString("%1 s").arg(time, 0, 'f', digits_for(view));
    if (view.live) return TimelineWords::tr("%1, live").arg(seconds);
    const auto frame = frame_at(view, time);
    if (!frame) return {};
    return TimelineWords::tr("%1, frame %2 of %3")
        .arg(seconds)
        .arg(*frame + 1)
        .arg(view.frames.size());
}

QString overview_text_at(const TimelineView& view, double time) {
    QString words = QString("%1 s").arg(time - view.begin, 0, 'f', 3);
    const Overview::Piece piece = view.overview->over(time, time);
    if (piece.empty) return words;
    words += "\n" + TimelineWords::tr("force up to %1 N").arg(piece.most_force, 0, 'f', 2);
    if (piece.least_isovalue <= piece.most_isovalue) {
        words += "\n" + TimelineWords::tr("isovalue %1").arg(piece.most_isovalue, 0, 'g', 6);
    }
    if (piece.contact) words += "\n" + TimelineWords::tr("in contact");
    return words;
}

std::vector<Stretch> loaded_stretches(const TimelineView& view) {
    const double from = view.loaded_from, whole = length(view);
    double to = view.loaded_to;
    if (view.loop) to = std::min(to < from ? to + whole : to, from + whole);
    if (!std::isfinite(from) || !(from <= to)) return {};
    std::vector<Stretch> stretches;
    // In a loop also a length earlier and later, of which only one can reach in.
    for (const double shift : {-whole, 0.0, whole}) {
        if (shift != 0 && !view.loop) continue;
        const double low = std::max(from + shift, view.begin);
        const double high = std::min(to + shift, view.end);
        if (low < high || (low == high && from == to)) stretches.push_back({low, high});
    }
    return stretches;
}

}  // namespace palpate::viewer

// Renders a recording again and keeps snapshots and an overview of it.
#include "apps/viewer/model/playback.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/viewer/model/hands.hpp"
#include "palpate/io/csv.hpp"

namespace palpate::viewer {
namespace {

constexpr std::size_t least_snapshots = 16;
/// Part of the interval after which a snapshot is due: ticks come a little early or late.
constexpr double punctual = 0.9;

Overview::Piece piece_of(const SessionTick& session) {
    Overview::Piece piece;
    const Tick& tick = session.tick;
    piece.least_force = piece.most_force = tick.force.norm();
    if (std::isfinite(tick.proxy.isovalue)) {
        piece.least_isovalue = piece.most_isovalue = tick.proxy.isovalue;
    }
    piece.contact = tick.proxy.mode == Mode::constrained;
    piece.empty = false;
    return piece;
}

double time_of(const Snapshot& snapshot) {
    return snapshot.session.tick.time;
}

}  // namespace

void Overview::Piece::add(const Piece& other) {
    if (other.empty) return;
    if (empty) {
        *this = other;
        return;
    }
    least_force = std::min(least_force, other.least_force);
    most_force = std::max(most_force, other.most_force);
    contact = contact || other.contact;
    if (other.least_isovalue > other.most_isovalue) return;
    const bool none = least_isovalue > most_isovalue;
    least_isovalue = none ? other.least_isovalue : std::min(least_isovalue, other.least_isovalue);
    most_isovalue = none ? other.most_isovalue : std::max(most_isovalue, other.most_isovalue);
}

Overview::Piece Overview::over(double from, double to) const {
    Piece all;
    if (pieces.empty()) return all;
    const auto number = [&](double time) {
        const auto last = static_cast<double>(pieces.size() - 1);
        return static_cast<std::size_t>(std::clamp((time - begin) / width, 0.0, last));
    };
    for (std::size_t i = number(from); i <= number(to); ++i) all.add(pieces[i]);
    return all;
}

Playback Playback::read(const std::filesystem::path& recording, const run::LoadedVolume& loaded,
                        const io::Progress& progress, std::size_t most_bytes) {
    io::RecordingReader reader(recording);
    return read(reader, recording.string(), loaded, progress, most_bytes);
}

std::vector<Playback> Playback::read_hands(const std::filesystem::path& recording,
                                           const run::LoadedVolume& loaded,
                                           const io::Progress& progress) {
    const std::string text = io::read_text(recording), name = recording.string();
    io::RecordingReader first(text, name);
    const int hands = std::min(first.hands(), most_hands);
    const auto read_one = [&](io::RecordingReader& reader, int before) {
        const auto part = [&](double of_one) {
            if (progress) progress((before + of_one) / hands);
        };
        return read(reader, name, loaded, part, usual_bytes / static_cast<std::size_t>(hands));
    };
    std::vector<Playback> playbacks{read_one(first, 0)};
    for (int hand = 2; hand <= hands; ++hand) {
        io::RecordingReader reader(text, name, hand);
        playbacks.push_back(read_one(reader, hand - 1));
    }
    return playbacks;
}

Playback Playback::read(io::RecordingReader& reader, const std::string& recording,
                        const run::LoadedVolume& loaded, const io::Progress& progress,
                        std::size_t most_bytes) {
    const std::size_t most = std::max(most_bytes / sizeof(Moment), least_snapshots);
    run::Replay replay(reader, loaded, recording);
    Playback playback(reader.head(), replay.session().renderer.field);
    Moment last;
    bool kept = true;
    while (const auto tick = replay.next()) {
        if (run::difference(tick->recorded, tick->again)) ++playback.different_;
        if (progress && tick->number % 1024 == 0) progress(reader.progress());
        // A time that is not finite or goes back has no place on a timeline.
        const double time = tick->again.tick.time;
        if (!std::isfinite(time)) continue;
        auto& moments = playback.moments_;
        if (!moments.empty() && !(time > playback.overview_.end)) continue;
        const RendererSettings& settings = replay.session().renderer.settings;
        last = {snapshot_of(replay.session(), tick->again, tick->number, 0), settings.layers,
                settings.tool};
        kept = moments.empty() ||
               time >= time_of(moments.back().snapshot) + punctual * playback.interval_;
        playback.survey(tick->again);
        if (kept) playback.keep(last, most);
    }
    if (playback.moments_.empty()) {
        throw io::InputError(recording + ": has no ticks: nothing was recorded");
    }
    if (!kept) playback.moments_.push_back(last);
    playback.ticks_ = static_cast<std::size_t>(replay.ticks());
    playback.samples_ = std::move(replay.samples());
    playback.complete_ = reader.complete();
    playback.hands_ = reader.hands();
    playback.clock_ = reader.begin().value_or(-playback.begin());
    if (progress) progress(1);
    return playback;
}

/// Drops every second one when the memory is full.
void Playback::keep(Moment moment, std::size_t most) {
    if (moments_.size() + 1 >= most) {
        std::size_t to = 0;
        for (std::size_t from = 0; from < moments_.size(); from += 2) {
            moments_[to++] = moments_[from];
        }
        moments_.resize(to);
        interval_ *= 2;
    }
    moments_.push_back(std::move(moment));
}

/// Pieces become twice as wide where there are too many.
void Playback::survey(const SessionTick& tick) {
    Overview& o = overview_;
    const double time = tick.tick.time;
    if (o.pieces.empty()) o.begin = time;
    o.end = time;
    while ((time - o.begin) / o.width >= static_cast<double>(Overview::most_pieces)) {
        for (std::size_t i = 0; 2 * i < o.pieces.size(); ++i) {
            Overview::Piece joined = o.pieces[2 * i];
            if (2 * i + 1 < o.pieces.size()) joined.add(o.pieces[2 * i + 1]);
            o.pieces[i] = joined;
        }
        o.pieces.resize((o.pieces.size() + 1) / 2);
        o.width *= 2;
    }
    const auto at = static_cast<std::size_t>((time - o.begin) / o.width);
    if (at >= o.pieces.size()) o.pieces.resize(at + 1);
    o.pieces[at].add(piece_of(tick));
}

Field Playback::field_at(const Snapshot& snapshot) {
    Field field = field_;
    field.use(samples_->of(snapshot.session.version));
    field.set_time(snapshot.session.moment);
    return field;
}

const Playback::Moment& Playback::moment_at(double time) const {
    const auto after = std::ranges::upper_bound(
        moments_, time, {}, [](const Moment& moment) { return time_of(moment.snapshot); });
    const bool before_all = after == moments_.begin() || std::isnan(time);
    return before_all ? moments_.front() : *(after - 1);
}

}  // namespace palpate::viewer

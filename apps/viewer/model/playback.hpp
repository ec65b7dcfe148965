// A recording to be looked at: what hand, proxy and force did, by time. No servo, no device.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <vector>

#include "apps/live/recorded_samples.hpp"
#include "apps/live/recorded_scene.hpp"

namespace palpate::viewer {

/// A recording at a glance: equal pieces of its time, and what happened in each.
struct Overview {
    struct Piece {
        double least_force = 0, most_force = 0;  ///< [N] magnitudes
        /// [data units] of the levels felt that are finite; least > most if there was none.
        double least_isovalue = 1, most_isovalue = 0;
        bool contact = false;  ///< in some tick
        bool empty = true;     ///< no tick: the machine or the device was late
    };
    struct Interval {
        double from, to;  ///< [s]
    };

    double begin = 0, end = 0;  ///< [s] of the first and the last tick
    double width = 1e-3;        ///< [s] of a piece, the first from `begin`
    std::vector<Piece> pieces;  ///< at most most_pieces
    std::vector<Interval> contacts;

    static constexpr std::size_t most_pieces = 4096;
};

/// A recording, rendered again once; any moment of it at once. Memory is bounded: it holds
/// snapshots at least 4 ms apart, and of a recording of more than some half an hour ever fewer of
/// them, so that they never take more than `most_bytes`.
class Playback {
  public:
    static constexpr std::size_t usual_bytes = std::size_t{256} << 20;
    static constexpr double least_interval = 0.004;  ///< [s] between snapshots

    /// Reads a recording and renders it. `loaded` is its volume (app::recorded_volume). `progress`
    /// gets 0 to 1 and may throw to stop. Throws io::InputError: no recording, a damaged one,
    /// without ticks, another volume's, or one that asks for what cannot be rendered. One that was
    /// cut off is read up to there.
    static Playback read(const std::filesystem::path& recording, const app::LoadedVolume& loaded,
                         const io::Progress& progress, std::size_t most_bytes = usual_bytes);

    /// [s] of the first and the last tick, by the session's clock.
    double begin() const { return overview_.begin; }
    double end() const { return overview_.end; }
    /// The last snapshot at or before `time`; the first for what is before it or no number.
    const Snapshot& at(double time) const;
    /// In the recording; snapshots are fewer.
    std::size_t ticks() const { return ticks_; }
    std::size_t snapshots() const { return snapshots_.size(); }
    const io::RecordingHead& head() const { return head_; }
    /// It was finished, not cut off.
    bool complete() const { return complete_; }
    /// Ticks that did not come out as they were recorded: the recording lost events, or another
    /// version made it. 0 where all is well.
    std::size_t different() const { return different_; }
    const Overview& overview() const { return overview_; }
    /// The field that was felt, as it was at the start.
    const Field& field() const { return field_; }
    /// As it was then: with the edits up to there, which may have to be made again, or at the
    /// moment of the sequence.
    Field field_at(const Snapshot& snapshot);

  private:
    Playback(io::RecordingHead head, Field field, app::RecordedSamples samples)
        : head_(std::move(head)), field_(std::move(field)), samples_(std::move(samples)) {}
    void keep(const Snapshot& snapshot, std::size_t most);
    void survey(const SessionTick& tick);
    void finish();

    io::RecordingHead head_;
    Field field_;
    app::RecordedSamples samples_;
    std::deque<Snapshot> snapshots_;    // grows without a copy of all of it
    double interval_ = least_interval;  // [s] between snapshots
    std::size_t ticks_ = 0, different_ = 0;
    bool complete_ = false;
    Overview overview_;
};

}  // namespace palpate::viewer

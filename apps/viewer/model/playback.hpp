// Playback of a recording: hand, proxy and force by time. No servo, no device.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/run/replay.hpp"

namespace palpate::viewer {

/// A summary of a recording: equal pieces of its time, and force, level and contact in each.
struct Overview {
    struct Piece {
        double least_force = 0, most_force = 0;  ///< [N] magnitudes
        /// [data units] of the levels felt that are finite; least > most if there was none.
        double least_isovalue = 1, most_isovalue = 0;
        bool contact = false;  ///< in some tick
        bool empty = true;     ///< no tick: the machine or the device was late

        /// Becomes the summary of both.
        void add(const Piece& other);
    };

    double begin = 0, end = 0;  ///< [s] of the first and the last tick
    double width = 1e-3;        ///< [s] of a piece, the first from `begin`
    std::vector<Piece> pieces;  ///< at most most_pieces

    /// The summary of a stretch of time [s]: of the pieces that it touches, one at least.
    Piece over(double from, double to) const;

    static constexpr std::size_t most_pieces = 4096;
};

/// Renders a recording once, when it is read; then any moment of it can be shown at once. Memory is
/// bounded: snapshots are at least 4 ms apart, and farther apart in a recording of more than about
/// half an hour, so that they never take more than `most_bytes`.
class Playback {
  public:
    static constexpr std::size_t usual_bytes = std::size_t{256} << 20;
    static constexpr double least_interval = 0.004;  ///< [s] between snapshots

    /// Reads a recording and renders it. `loaded` is its volume (run::recorded_source). `progress`
    /// gets 0 to 1 and may throw to stop. Throws io::InputError: no recording, a damaged one,
    /// without ticks, of another volume, or one that asks for what cannot be rendered. One that was
    /// cut off is read up to there.
    static Playback read(const std::filesystem::path& recording, const run::LoadedVolume& loaded,
                         const io::Progress& progress, std::size_t most_bytes = usual_bytes);
    /// The same for each of its hands, of more than most_hands for the first ones. They share
    /// `usual_bytes`.
    static std::vector<Playback> read_hands(const std::filesystem::path& recording,
                                            const run::LoadedVolume& loaded,
                                            const io::Progress& progress);

    /// [s] of the first and the last tick, by the session's clock.
    double begin() const { return overview_.begin; }
    /// Time 0 of its clock, by one that all hands of the recording share. Where it does not say
    /// how far apart they began, the first ticks count as simultaneous.
    double clock() const { return clock_; }
    double end() const { return overview_.end; }
    /// The last snapshot at or before `time`; the first for a time before it or NaN.
    const Snapshot& at(double time) const { return moment_at(time).snapshot; }
    /// In the recording; snapshots are fewer.
    std::size_t ticks() const { return ticks_; }
    std::size_t snapshots() const { return moments_.size(); }
    const io::RecordingHead& head() const { return head_; }
    /// It was finished, not cut off.
    bool complete() const { return complete_; }
    /// Of the recording, of which this is one.
    int hands() const { return hands_; }
    /// Ticks that did not come out as they were recorded: the recording lost events, or another
    /// version made it. 0 where all is well.
    std::size_t different() const { return different_; }
    const Overview& overview() const { return overview_; }
    /// The field that was felt, as it was at the start.
    const Field& field() const { return field_; }
    /// The layers in use at this time; null: none.
    std::shared_ptr<const Layers> layers_at(double time) const { return moment_at(time).layers; }
    /// The tool; null: a point.
    std::shared_ptr<const Tool> tool_at(double time) const { return moment_at(time).tool; }
    /// The field at a snapshot: with the edits up to then, some of which may have to be repeated,
    /// or at the moment of the sequence.
    Field field_at(const Snapshot& snapshot);

  private:
    Playback(io::RecordingHead head, Field field)
        : head_(std::move(head)), field_(std::move(field)) {}
    static Playback read(io::RecordingReader& reader, const std::string& recording,
                         const run::LoadedVolume& loaded, const io::Progress& progress,
                         std::size_t most_bytes);
    /// A snapshot, with the layers and the tool in use.
    struct Moment {
        Snapshot snapshot;
        std::shared_ptr<const Layers> layers;
        std::shared_ptr<const Tool> tool;
    };

    const Moment& moment_at(double time) const;
    void keep(Moment moment, std::size_t most);
    void survey(const SessionTick& tick);

    io::RecordingHead head_;
    Field field_;
    std::optional<run::RecordedSamples> samples_;  // once all is read
    std::deque<Moment> moments_;                   // grows without a copy of all of it
    double interval_ = least_interval;             // [s] between snapshots
    std::size_t ticks_ = 0, different_ = 0;
    bool complete_ = false;
    double clock_ = 0;  // [s]
    int hands_ = 1;
    Overview overview_;
};

}  // namespace palpate::viewer

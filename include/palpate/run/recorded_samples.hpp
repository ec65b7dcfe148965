// Restores the samples of a recorded run from the edits and frames in the recording.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>

#include "palpate/run/source.hpp"
#include "palpate/session.hpp"

namespace palpate::run {

/// Reads the frames of a sequence. Null for a volume that is no sequence.
std::function<Volume(int)> frames_of(const LoadedVolume& loaded);

/// Reads a large grid. Both null for other data.
struct GridReader {
    std::function<Brick(const Index3& brick, int level)> brick;  ///< of a level of detail
    ReadSamples box;  ///< of the level that was touched, before all edits
};
/// `tell` is called repeatedly while it reads, and may throw to stop.
GridReader grid_of(const LoadedVolume& loaded, std::function<void()> tell = {});

class RecordedSamples {
  public:
    /// `start`: the samples at the start of the recording. `frame` reads a frame of the sequence
    /// and may throw. Null for data that are no sequence.
    explicit RecordedSamples(std::shared_ptr<const Samples> start,
                             std::function<Volume(int)> frame = {}, GridReader grid = {});

    /// The recorded command; if it is command::Samples, with the samples filled in. Throws
    /// std::invalid_argument for samples that cannot be made again, and as check(Edit) does.
    Command whole(const Command& recorded);

    /// The samples of a version that was made before, or those of the start for an unknown version.
    /// For a sequence the last frames, for a large grid no brick, but the edits that it had.
    /// Repeats at most fifteen edits.
    std::shared_ptr<const Samples> of(std::uint64_t version);

    /// Number of versions in memory.
    std::size_t kept() const { return kept_.size() + recent_.size(); }

  private:
    struct Version {
        EditOf made;
        int edits = 0;  ///< from the start
    };

    std::shared_ptr<const Samples> felt(std::shared_ptr<const Samples> edits) const;
    std::shared_ptr<const Samples> made(const command::Samples& recorded);
    std::shared_ptr<const Samples> frames_of(const FramesOf& frames);
    std::shared_ptr<const Samples> bricks_of(const BricksOf& bricks, std::uint64_t version);
    std::shared_ptr<const Samples> edit_of(const EditOf& edit, std::uint64_t version);
    std::shared_ptr<const Samples> find(std::uint64_t version) const;
    std::shared_ptr<const Samples> made_again(std::uint64_t version);
    void remember(std::uint64_t version, const std::shared_ptr<const Samples>& samples);

    // The versions of minutes of brushing do not all fit into memory, but the edits do.
    std::map<std::uint64_t, Version> versions_;
    std::map<std::uint64_t, std::shared_ptr<const Samples>> kept_;  // every sixteenth edit
    std::deque<std::pair<std::uint64_t, std::shared_ptr<const Samples>>> recent_;
    std::function<Volume(int)> frame_;
    std::map<int, Volume> read_;  // frames of the last window
    std::shared_ptr<const Samples> frames_;
    GridReader grid_;
    // For a large grid: the bricks in memory, the edits now, and those of each version of bricks.
    std::optional<ResidentBricks> bricks_;
    std::uint64_t bricks_version_ = 0, edits_version_ = 0;
    std::map<std::uint64_t, std::uint64_t> edits_at_;
};

}  // namespace palpate::run

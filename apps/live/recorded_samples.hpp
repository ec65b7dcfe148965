// Makes the samples again that a recorded session went on with.
#pragma once

#include <deque>
#include <functional>
#include <map>

#include "apps/live/volume_options.hpp"
#include "palpate/session.hpp"

namespace palpate::app {

/// Reads the frames of a volume that is a sequence; null if it is none.
std::function<Volume(int)> frames_of(const LoadedVolume& loaded);

class RecordedSamples {
  public:
    /// `start` are those of the session's begin. `frame` reads one of its sequence, and may throw;
    /// null if it is none.
    explicit RecordedSamples(std::shared_ptr<const Samples> start,
                             std::function<Volume(int)> frame = {});

    /// A command as it was recorded, with its samples if it is one for samples. Throws
    /// std::invalid_argument for samples that cannot be made again, and as check(Edit).
    Command whole(const Command& recorded);

    /// The samples of a version that was made before, those of the start if there was none; of
    /// frames those that came last. Takes some edits, fifteen at most.
    std::shared_ptr<const Samples> of(std::uint64_t version);

    /// How many versions are in memory now.
    std::size_t kept() const { return kept_.size() + recent_.size(); }

  private:
    struct Version {
        EditOf made;
        int edits = 0;  ///< from the start
    };

    std::shared_ptr<const Samples> made(const command::Samples& recorded);
    std::shared_ptr<const Samples> frames_of(const FramesOf& frames);
    std::shared_ptr<const Samples> find(std::uint64_t version) const;
    std::shared_ptr<const Samples> made_again(std::uint64_t version);
    void remember(std::uint64_t version, const std::shared_ptr<const Samples>& samples);

    // All versions of minutes of brushing do not fit into the memory, what was done to them does.
    std::map<std::uint64_t, Version> versions_;
    std::map<std::uint64_t, std::shared_ptr<const Samples>> kept_;  // every sixteenth edit
    std::deque<std::pair<std::uint64_t, std::shared_ptr<const Samples>>> recent_;
    std::function<Volume(int)> frame_;
    std::map<int, Volume> read_;  // of the last ones
    std::shared_ptr<const Samples> frames_;
};

}  // namespace palpate::app

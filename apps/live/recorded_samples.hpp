// Makes the samples again that a recorded session went on with.
#pragma once

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

    /// The samples of a version that was made before; of frames those that came last.
    std::shared_ptr<const Samples> of(std::uint64_t version) const;

  private:
    std::shared_ptr<const Samples> made(const command::Samples& recorded);
    std::shared_ptr<const Samples> frames_of(const FramesOf& frames);

    std::map<std::uint64_t, std::shared_ptr<const Samples>> versions_;
    std::function<Volume(int)> frame_;
    std::map<int, Volume> read_;  // of the last ones
    std::shared_ptr<const Samples> frames_;
};

}  // namespace palpate::app

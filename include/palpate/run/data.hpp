// The data of one or several runs, which may change while it is touched: a volume that is edited, a
// sequence that plays, or a store that is read meanwhile.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "palpate/io/recording.hpp"
#include "palpate/run/player.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/run/streamer.hpp"
#include "palpate/run/volume_editor.hpp"
#include "palpate/stream/edits.hpp"

namespace palpate::run {

/// Throws std::invalid_argument for a file name under which a volume on this grid cannot be
/// written.
void check_volume_name(const std::string& path, const Geometry& geometry);

/// Shared by several runs: all of them feel the edits of each hand.
class Data {
  public:
    /// A sequence plays from the start with the settings `playback`. Throws std::invalid_argument
    /// for a sequence if two of its frames do not fit into the memory limit.
    explicit Data(LoadedVolume loaded, const PlaybackSetup& playback = {},
                  Pace pace = Pace::own_thread);

    Pace pace() const { return pace_; }
    /// With Pace::by_steps: does the work that is due at this time for edits, playback and
    /// streaming. Call it every 4 ms, as Run::step() does.
    void step(std::chrono::steady_clock::time_point now);
    /// Whether all frames and samples that are needed now are in memory, or cannot be read.
    bool is_settled() const;

    /// As it was loaded.
    const LoadedVolume& loaded() const { return loaded_; }
    /// The volume's place, size and checksum, for recordings. The first call takes a moment for
    /// large data. Exceptions of `progress` are passed on. Any thread.
    io::VolumeIdentity identity(const OnProgress& progress = {}) const;
    bool is_sequence() const { return player_ != nullptr; }
    bool is_streamed() const { return streamer_ != nullptr; }
    /// State of the samples of a store in memory; empty for other data.
    stream::BrickLoaderStatus streaming() const;
    /// For data of another kind, these throw std::invalid_argument with the remedy.
    VolumeEditor& editor() const;
    Player& player() const;

    /// The samples before edits, for a field to begin with.
    const std::shared_ptr<const Samples>& start() const { return start_; }
    /// Updates a field of this data: edits, or frames and moment.
    void update(Field& field) const;
    /// Throws io::OutputError if a recording that begins now could not be rendered again.
    void check_recording() const;
    /// Starts a servo on the data as they are now and keeps it up to date until detach().
    std::unique_ptr<Servo> attach(Session session, const StartServo& start);
    void detach(const Servo& servo);
    /// As VolumeEditor::record().
    void record(const Servo& servo, const BeginRecording& begin);
    /// The tool of an attached servo from now on, for brushes.
    void rest_brush(const Servo& servo, const std::shared_ptr<const Tool>& tool);
    /// Why edits or frames are missing; usually empty.
    std::string problem() const;
    /// A file that is in use from now on, such as a recording or an overlay: save() replaces no
    /// such file. An empty path is none.
    void keep(const std::filesystem::path& path);
    /// The end of one keep().
    void release(const std::filesystem::path& path);
    /// Throws io::OutputError for a file that is in use: of the volume, or given to keep().
    void require_unused(const std::filesystem::path& path) const;
    /// Throws std::invalid_argument for a name that save() cannot write to. Throws io::OutputError
    /// if there is no such folder, no permission, or something else of this name, and as
    /// require_unused() does.
    void check_save_name(const std::string& path) const;
    /// Whether the samples are others than those that were opened, or than those that were saved.
    bool is_edited() const;
    /// Throws std::invalid_argument, with the reason, if save() has nothing to write.
    void require_saving() const;
    /// Writes the samples as they are now (for a sequence, those of its moment) to a file or a
    /// folder *.zarr, as a whole or not at all. For a store it writes only the edits
    /// (stream::save_edits()). Returns a sentence: "saved FILE", and for a raw file how to open it
    /// again. Throws io::OutputError, and as require_saving() and require_unused() do.
    std::string save(const std::filesystem::path& path, const io::Progress& progress);

    /// Saves when other ways have failed: in a new folder that only this user can enter, in the
    /// folder of temporary files or, if that fails, in the home folder or the current one. Returns
    /// the name. Throws io::OutputError with the reason for each folder, and passes on
    /// exceptions of `progress` that are no std::exception.
    std::filesystem::path rescue(const io::Progress& progress = {});

  private:
    std::string save_edits(const std::filesystem::path& path, const io::Progress& progress);

    Pace pace_;
    LoadedVolume loaded_;
    std::shared_ptr<const Samples> start_;
    std::unique_ptr<Player> player_;
    std::unique_ptr<Streamer> streamer_;
    std::unique_ptr<VolumeEditor> editor_;  // uses the streamer, if there is one
    mutable std::mutex mutex_;              // of kept_: a window saves on a thread of its own
    std::vector<std::filesystem::path> kept_;
    mutable std::mutex identifying_;  // of identity_
    mutable std::optional<io::VolumeIdentity> identity_;
};

}  // namespace palpate::run

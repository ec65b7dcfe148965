// The data of a live session, that may change while they are felt: a volume in work, or a sequence
// that plays.
#pragma once

#include <filesystem>
#include <memory>

#include "apps/live/player.hpp"
#include "apps/live/sculptor.hpp"
#include "apps/live/volume_options.hpp"

namespace palpate::app {

/// Throws std::invalid_argument for a file name that no volume on this grid can be written under.
void check_volume_name(const std::string& path, const Geometry& geometry);

class DataInHand {
  public:
    /// `field` is what the session begins with, of `loaded`'s volume. Throws std::invalid_argument
    /// for a sequence of which two frames do not fit into the memory.
    DataInHand(const LoadedVolume& loaded, const Field& field, const io::LoaderSettings& settings);

    bool is_sequence() const { return player_ != nullptr; }
    /// Throw std::invalid_argument, saying what to do, for data of the other kind.
    Sculptor& sculptor() const;
    Player& player() const;

    /// The field as it is now: with the edits, or the frames and the moment.
    Field field() const;
    /// Another side is solid from now on, or another background lies round the grid. The samples
    /// stay.
    void set_field(const Field& field);
    /// Whom to watch and to tell; it must stay until the next attach(). Null: nobody.
    void attach(Servo* servo);
    /// Brings a session that is about to run to what the data are now.
    void bring(Session& session) const;
    /// What a recording needs to know before its first tick: commands whose samples are told by
    /// their recipes.
    std::vector<Command> history() const;
    /// Writes the samples as they are (of a sequence, at its moment) to a file, whole or not at
    /// all. Gives a sentence about it: "saved FILE", and what it takes to open a raw one again.
    /// Throws io::OutputError.
    std::string save(const std::filesystem::path& path, const io::Progress& progress);

  private:
    Field field_;
    std::unique_ptr<Sculptor> sculptor_;
    std::unique_ptr<Player> player_;
};

}  // namespace palpate::app

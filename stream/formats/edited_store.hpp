// A store with edits on top: chunks of an OME-Zarr in place of the original's. Private to stream/.
#pragma once

#include <set>

#include "palpate/stream/edits.hpp"
#include "stream/box_bytes.hpp"

namespace palpate::stream {

/// Chunks of one level, cubes of as many samples as their note says.
using ChunkSet = std::set<Index3, ByPlace>;

/// What EditsNote::guessed says if the original's coarser levels follow no rule that Palpate knows.
constexpr const char *guessed_mean = "mean", *guessed_single = "single";

/// What a folder of edits says beside its chunks.
struct EditsNote {
    int chunk = 64;                     ///< samples along each axis
    Opened of;                          ///< the original
    int level = 0;                      ///< of the original that was edited
    Range bounds;                       ///< of the edited samples
    std::vector<ChunkSet> chunks = {};  ///< for that level and coarser ones, perhaps not all
    std::string content = {};           ///< of the original: content_of(); empty: not known
    std::string beside = {};            ///< where the original is if it was moved with the edits
    std::string guessed = {};           ///< how coarser samples above edits were made; or empty
    bool lacks_secrets = false;         ///< its address was saved without password and query
    bool is_whole = false;              ///< all these chunks are stored, also those that are 0
};

/// The levels of the original from the edited one on.
class EditedStore : public Store {
  public:
    /// `chunks`: a store with those levels. Throws std::invalid_argument if they do not fit.
    EditedStore(std::shared_ptr<const Store> original, std::shared_ptr<const Store> chunks,
                EditsNote note);

    const EditsNote& note() const { return note_; }
    const Store& original() const { return *original_; }
    const StoreInfo& info() const override { return info_; }
    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const override;
    Traffic traffic() const override { return original_->traffic(); }

  private:
    std::shared_ptr<const Store> original_, chunks_;
    EditsNote note_;
    StoreInfo info_;
};

/// True for a folder with a note of edits, whoever put it there.
bool holds_edits(const std::filesystem::path& folder);
/// The first chunk in such a folder that its note does not list, as a path from `folder`: another
/// program has put it there. Empty if there is none. Throws io::InputError for a damaged note.
std::string unlisted_chunk(const std::filesystem::path& folder);
/// Opens one with its original. Throws io::InputError, and Cancelled as open_until().
std::shared_ptr<const Store> open_edits(const std::stop_token& stop, const std::string& folder,
                                        const StoreOptions& options);
/// Of a folder that is being made and will be `out`. Throws io::OutputError.
void write_note(const std::filesystem::path& folder, const std::filesystem::path& out,
                const EditsNote& note);

}  // namespace palpate::stream

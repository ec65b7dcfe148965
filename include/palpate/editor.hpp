// Stage 5, editor: the samples in work, with undo and redo. Each version is kept whole, but
// versions share all bricks that did not change. Not for the servo thread.
#pragma once

#include <deque>

#include "palpate/edit.hpp"

namespace palpate {

/// Whether an edit is a step of its own for undo(), or goes on with the last one (a stroke is many
/// edits).
enum class EditStep : std::uint8_t { own, same };

/// One thread at a time.
class Editor {
  public:
    /// At most `history_bytes` of samples are held for undo() and redo(); the oldest steps go
    /// first.
    explicit Editor(std::shared_ptr<const Samples> samples,
                    std::size_t history_bytes = std::size_t{512} << 20);

    /// As they are now.
    const std::shared_ptr<const Samples>& samples() const { return samples_; }
    /// Makes an edit, and gives the box of samples that changed. Throws as check(Edit).
    SampleBox apply(const Edit& edit, EditStep step = EditStep::own);
    /// Takes the last step back, or makes the one that was taken back again; the box of samples
    /// that changed, which is empty if there is none.
    SampleBox undo();
    SampleBox redo();
    std::size_t undo_steps() const { return undone_from_; }
    std::size_t redo_steps() const { return steps_.size() - undone_from_; }
    /// Of the versions that are held for undo() and redo(), beyond the samples as they are now.
    std::size_t history_bytes() const;
    /// True if the samples are others than those that the editor began with or was last told of.
    bool changed() const { return samples_ != saved_; }
    /// They were saved: changed() is false until they change.
    void set_saved() { saved_ = samples_; }

  private:
    struct Step {
        std::shared_ptr<const Samples> before, after;
        SampleBox box;
        std::size_t bytes = 0;
    };
    void forget();

    std::shared_ptr<const Samples> samples_, saved_;
    std::deque<Step> steps_;  // in order; those from undone_from_ on were taken back
    std::size_t undone_from_ = 0;
    bool begun_ = false;  // a step of its own has begun, and changed nothing so far
    std::size_t most_bytes_;
};

}  // namespace palpate

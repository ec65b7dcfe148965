// Stage 6, editor: applies edits to samples, with undo and redo. Each step keeps its version of the
// samples; versions share all bricks that did not change. Not for the servo thread.
#pragma once

#include <deque>

#include "palpate/edit.hpp"

namespace palpate {

/// Whether an edit begins a new step of undo(), or belongs to the last one (one movement of a brush
/// is many edits).
enum class EditStep : std::uint8_t { own, same };

/// One thread at a time.
class Editor {
  public:
    /// Keeps at most `history_bytes` of samples for undo() and redo(); the oldest steps are dropped
    /// first. `read`: what a large grid needs, see edited().
    explicit Editor(std::shared_ptr<const Samples> samples,
                    std::size_t history_bytes = std::size_t{512} << 20, ReadSamples read = {});

    /// The current version.
    const std::shared_ptr<const Samples>& samples() const { return samples_; }
    /// Applies an edit and returns the box of samples that changed. Throws as edited() does.
    SampleBox apply(const Edit& edit, EditStep step = EditStep::own);
    /// Undoes the last step, or redoes the step undone last. Returns the box of samples that
    /// changed; it is empty if there is no such step.
    SampleBox undo();
    SampleBox redo();
    std::size_t undo_steps() const { return undone_from_; }
    std::size_t redo_steps() const { return steps_.size() - undone_from_; }
    /// Bytes that undo() and redo() hold beyond the current version.
    std::size_t history_bytes() const;
    /// True if the current version is not the saved one; at the start the first version is saved.
    bool changed() const { return samples_ != saved_; }
    /// Marks the current version as saved.
    void set_saved() { saved_ = samples_; }

  private:
    struct Step {
        std::shared_ptr<const Samples> before, after;
        SampleBox box;
        std::size_t bytes = 0;
    };
    void forget();

    std::shared_ptr<const Samples> samples_, saved_;
    std::deque<Step> steps_;  // in order; those from undone_from_ on are undone
    std::size_t undone_from_ = 0;
    bool begun_ = false;  // a new step has begun, and changed nothing so far
    std::size_t most_bytes_;
    ReadSamples read_;
};

}  // namespace palpate

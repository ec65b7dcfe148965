// Editor: undo and redo by keeping versions of the samples.
#include "palpate/edit.hpp"

#include <stdexcept>
#include <utility>

namespace palpate {

Editor::Editor(std::shared_ptr<const Samples> samples, std::size_t history_bytes, ReadSamples read)
    : samples_(std::move(samples)),
      saved_(samples_),
      most_bytes_(history_bytes),
      read_(std::move(read)) {
    if (!samples_) throw std::invalid_argument("an editor needs samples");
}

namespace {

/// Bytes that only one of two versions holds, and those of a table of bricks.
std::size_t bytes_between(const Samples& before, const Samples& after) {
    const Bricks none(after.geometry().size);
    const Bricks& old = before.bricks() ? *before.bricks() : none;
    return bytes_apart(before, after) + bytes_apart(after, before) +
           after.bricks()->table_bytes_apart(old);
}

}  // namespace

SampleBox Editor::apply(const Edit& edit, EditStep step, const OnProgress& progress) {
    begun_ |= step == EditStep::own;  // also if this edit fails
    return take(edited(samples_, edit, read_, progress), step);
}

SampleBox Editor::take(Edited result, EditStep step) {
    begun_ |= step == EditStep::own;
    if (result.changed.empty()) return {};
    const bool same = !std::exchange(begun_, false) && undone_from_ > 0 && redo_steps() == 0;
    steps_.resize(undone_from_);
    if (same) {
        steps_.back().after = result.samples;
        steps_.back().box = united(steps_.back().box, result.changed);
    } else {
        steps_.push_back({samples_, result.samples, result.changed});
    }
    undone_from_ = steps_.size();
    Step& last = steps_.back();
    last.bytes = bytes_between(*last.before, *last.after);
    samples_ = std::move(result.samples);
    forget();
    return result.changed;
}

SampleBox Editor::undo() {
    if (undone_from_ == 0) return {};
    const Step& step = steps_[--undone_from_];
    samples_ = step.before;
    return step.box;
}

SampleBox Editor::redo() {
    if (redo_steps() == 0) return {};
    const Step& step = steps_[undone_from_++];
    samples_ = step.after;
    return step.box;
}

std::size_t Editor::history_bytes() const {
    std::size_t bytes = 0;
    for (const Step& step : steps_) bytes += step.bytes;
    return bytes;
}

/// Drops the oldest steps beyond the limit; the last one stays, however large.
void Editor::forget() {
    std::size_t bytes = history_bytes();
    while (steps_.size() > 1 && bytes > most_bytes_) {
        bytes -= steps_.front().bytes;
        steps_.pop_front();
        --undone_from_;
    }
}

}  // namespace palpate

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

SampleBox Editor::take(Edited result, EditStep step, Versions* dropped) {
    begun_ |= step == EditStep::own;
    if (result.changed.empty()) return {};
    const bool same = !std::exchange(begun_, false) && undone_from_ > 0 && redo_steps() == 0;
    drop(undone_from_, steps_.size(), dropped);
    if (same) {
        if (dropped) dropped->push_back(steps_.back().after);
        steps_.back().after = result.samples;
        steps_.back().box = united(steps_.back().box, result.changed);
    } else {
        steps_.push_back({samples_, result.samples, result.changed});
    }
    undone_from_ = steps_.size();
    Step& last = steps_.back();
    last.bytes = bytes_between(*last.before, *last.after);
    samples_ = std::move(result.samples);
    forget(dropped);
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

void Editor::drop(std::size_t first, std::size_t end, Versions* dropped) {
    for (std::size_t i = first; dropped && i < end; ++i) {
        dropped->insert(dropped->end(), {steps_[i].before, steps_[i].after});
    }
    const auto begin = steps_.begin();
    steps_.erase(begin + static_cast<std::ptrdiff_t>(first),
                 begin + static_cast<std::ptrdiff_t>(end));
}

/// Drops the oldest steps beyond the limit; the last one stays, however large.
void Editor::forget(Versions* dropped) {
    std::size_t bytes = history_bytes(), oldest = 0;
    for (; oldest + 1 < steps_.size() && bytes > most_bytes_; ++oldest) {
        bytes -= steps_[oldest].bytes;
    }
    drop(0, oldest, dropped);
    undone_from_ -= oldest;
}

}  // namespace palpate

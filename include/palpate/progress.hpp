// Progress of long work: how it is reported, and how it is stopped.
// Uses the standard library only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>

namespace palpate {

/// Called from the calling thread with the part of the work that is done, 0 to 1, at least ten
/// times a second. If it throws, the work stops, nothing is left behind, and the exception reaches
/// the caller: throw to cancel.
using OnProgress = std::function<void(double fraction)>;

/// Reports work of many alike items.
class ReportedItems {
  public:
    /// Calls `progress` once for each `between` of all items.
    ReportedItems(OnProgress progress, std::size_t items, std::size_t between)
        : progress_(std::move(progress)), items_(items), between_(between), next_(between) {}

    /// After each item, or so many. Exceptions of `progress` pass through.
    void done(std::size_t items = 1) {
        done_ += items;
        if (done_ < next_) return;
        next_ = done_ + between_;
        if (progress_) progress_(double(done_) / double(std::max(done_, items_)));
    }

  private:
    OnProgress progress_;
    std::size_t items_, between_, next_, done_ = 0;
};

}  // namespace palpate

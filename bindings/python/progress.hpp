// OnProgress of long work that runs without the GIL: calls the user's function, and lets Ctrl-C
// stop the work.
#pragma once

#include <cstddef>
#include <optional>

#include "bindings/python/casters.hpp"
#include "palpate/progress.hpp"
#include "stream/while_telling.hpp"

namespace palpate::python {

/// A Python function of the fraction done, or nothing.
using ProgressFunction = std::optional<py::function>;

/// Throws what the function throws, and KeyboardInterrupt. The function has to outlive the result.
inline OnProgress progress_of(const ProgressFunction& function) {
    return [&function](double fraction) {
        const GilTaken gil;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (function) called(*function, fraction);
    };
}

/// OnProgress for which only Ctrl-C counts.
inline OnProgress ctrl_c() {
    static const ProgressFunction none;
    return progress_of(none);
}

/// Work of many alike items, with or without the GIL, which Ctrl-C stops: done() after so many.
class Stoppable {
  public:
    void done(std::size_t bytes) {
        done_ += bytes;
        if (done_ < between) return;
        done_ = 0;
        stop_(0);
    }

  private:
    static constexpr std::size_t between = std::size_t{4} << 20;  // milliseconds
    OnProgress stop_ = ctrl_c();
    std::size_t done_ = 0;
};

/// So many items take milliseconds: points of a field, updates of a proxy, or ticks; and batches of
/// them, or updates of a tool.
inline constexpr std::size_t updates_in_slice = 4096, batches_in_slice = 64;

/// What work(stop) returns. Ctrl-C stops it.
template <class Work>
auto until_ctrl_c(Work&& work) {
    return stream::while_telling(ctrl_c(), work);
}

}  // namespace palpate::python

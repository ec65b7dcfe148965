// Progress of long work that runs without the GIL: calls the user's function, and lets Ctrl-C stop
// the work.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "bindings/python/casters.hpp"
#include "stream/while_telling.hpp"

namespace palpate::python {

/// A Python function of the fraction done, or nothing.
using ProgressFunction = std::optional<py::function>;

/// Throws what the function throws, and KeyboardInterrupt. The function has to outlive the result.
inline std::function<void(double)> progress_of(const ProgressFunction& function) {
    return [&function](double fraction) {
        const py::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (function) (*function)(fraction);
    };
}

/// Long work of many alike items in slices: after each slice, progress_of() is called.
class Slices {
  public:
    /// The function has to outlive it. slice: so many items take milliseconds.
    Slices(const ProgressFunction& function, std::size_t items, std::size_t slice)
        : tell_(progress_of(function)), items_(items), slice_(slice) {}

    /// After each item. Throws as progress_of() does.
    void done_one() {
        if (++done_ % slice_ == 0) {
            tell_(std::min(1.0, double(done_) / double(std::max<std::size_t>(1, items_))));
        }
    }

  private:
    std::function<void(double)> tell_;
    std::size_t items_, slice_, done_ = 0;
};

/// Updates of a proxy, or ticks; and batches of them, or updates of a tool.
inline constexpr std::size_t updates_in_slice = 4096, batches_in_slice = 64;

/// What work(stop) returns. Ctrl-C stops it.
template <class Work>
auto until_ctrl_c(Work&& work) {
    const ProgressFunction none;
    const auto progress = progress_of(none);
    return stream::while_telling([&] { progress(0); }, work);
}

}  // namespace palpate::python

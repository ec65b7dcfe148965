// Makes renderers for settings as Python gives them.
#pragma once

#include "bindings/python/setup.hpp"
#include "palpate/renderer.hpp"

namespace palpate::python {

/// A Renderer of Python. While follow() or batch_ns() moves it without the GIL, other threads may
/// look at it, as it was before, and copy it.
struct SharedRenderer : Renderer {
    bool moves = false;

    explicit SharedRenderer(Renderer renderer) : Renderer(std::move(renderer)) {}
    SharedRenderer copied() const { return SharedRenderer(Renderer(*this)); }
    /// Throws std::logic_error, a RuntimeError in Python, while it moves.
    SharedRenderer& changeable() {
        if (!moves) return *this;
        throw std::logic_error(
            "another thread moves this Renderer, in follow() or batch_ns(): wait for its end, or "
            "use a copy()");
    }
};

/// As `palpate replay` makes it. Throws std::invalid_argument, io::InputError.
Renderer offline_renderer(const Field& field, const io::Level& level, const RenderSetup& setup);

}  // namespace palpate::python

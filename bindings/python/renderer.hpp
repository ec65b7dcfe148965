// Makes renderers for settings as Python gives them.
#pragma once

#include "bindings/python/moving.hpp"
#include "bindings/python/setup.hpp"
#include "palpate/renderer.hpp"

namespace palpate::python {

using SharedRenderer = Shared<Renderer>;

/// As `palpate replay` makes it. Throws std::invalid_argument, io::InputError.
Renderer offline_renderer(const Field& field, const io::Level& level, const RenderSetup& setup);

}  // namespace palpate::python

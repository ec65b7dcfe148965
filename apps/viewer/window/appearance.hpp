// Light and dark.
#pragma once

namespace palpate::viewer {

enum class Appearance { system, light, dark };

/// For the whole application, at once; `system` is what it had at its start.
void set_appearance(Appearance appearance);

}  // namespace palpate::viewer

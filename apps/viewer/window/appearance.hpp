// Light and dark appearance of the application.
#pragma once

namespace palpate::viewer {

enum class Appearance { system, light, dark };

/// For the whole application, at once, and for the next start; `system` is what it had when this
/// was first called.
void set_appearance(Appearance appearance);
/// What was set last, in this run or another.
Appearance last_appearance();

}  // namespace palpate::viewer

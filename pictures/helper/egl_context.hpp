// OpenGL without a display: Mesa's surfaceless EGL platform.
#pragma once

namespace palpate::pictures {

/// Makes a context that is current in this thread until the process ends. Throws Failure, saying
/// what to install.
void make_surfaceless_context();

}  // namespace palpate::pictures

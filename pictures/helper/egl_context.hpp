// OpenGL without a display: Mesa's surfaceless EGL platform.
#pragma once

#include <string>

namespace palpate::pictures {

/// Who draws.
enum class Driver {
    software,  ///< the processor, unless LIBGL_ALWAYS_SOFTWARE says otherwise: what pictures get
    machine,   ///< what the graphics card's driver offers
};

/// Makes a context that is current in this thread until the process ends. Throws Failure, saying
/// what to install.
void make_surfaceless_context(Driver driver = Driver::software);

/// OpenGL's name for who draws ("llvmpipe (LLVM 15.0.6, 256 bits)"), of the current context.
std::string renderer_name();

}  // namespace palpate::pictures

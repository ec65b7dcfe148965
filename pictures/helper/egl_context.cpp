// Opens EGL at run time, so that a machine without it gets a readable message.
#include "pictures/helper/egl_context.hpp"

#include <dlfcn.h>

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstdlib>
#include <string>

#include "pictures/helper/failure.hpp"

namespace palpate::pictures {
namespace {

constexpr const char* remedy = "; install libegl1 and libgl1-mesa-dri";

class Egl {
  public:
    Egl() : library_(dlopen("libEGL.so.1", RTLD_NOW | RTLD_GLOBAL)) {
        if (!library_) throw Failure(std::string("there is no EGL (libEGL.so.1)") + remedy);
    }
    template <class Function>
    Function function(const char* name) const {
        auto* const found = reinterpret_cast<Function>(dlsym(library_, name));
        if (!found) throw Failure(std::string("libEGL.so.1 lacks ") + name + remedy);
        return found;
    }

  private:
    void* library_;  // never closed: the context lives as long as the process
};

/// A desktop OpenGL context of at least 3.2 core, which is what VTK draws with.
EGLContext context_of(const Egl& egl, EGLDisplay display) {
    const auto bind = egl.function<decltype(&eglBindAPI)>("eglBindAPI");
    const auto choose = egl.function<decltype(&eglChooseConfig)>("eglChooseConfig");
    const auto create = egl.function<decltype(&eglCreateContext)>("eglCreateContext");
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              2,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    EGLConfig configuration = nullptr;
    EGLint count = 0;
    if (!bind(EGL_OPENGL_API) || !choose(display, wanted, &configuration, 1, &count) ||
        count == 0) {
        return EGL_NO_CONTEXT;
    }
    return create(display, configuration, EGL_NO_CONTEXT, version);
}

}  // namespace

void make_surfaceless_context(Driver driver) {
    // Gives the same picture on every machine, and needs no graphics driver. Set it to 0 to use a
    // graphics card.
    if (driver == Driver::software) setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
    const Egl egl;
    const auto address = egl.function<decltype(&eglGetProcAddress)>("eglGetProcAddress");
    const auto platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(address("eglGetPlatformDisplayEXT"));
    if (!platform_display) throw Failure(std::string("EGL knows no platforms") + remedy);
    const EGLDisplay display =
        platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY ||
        !egl.function<decltype(&eglInitialize)>("eglInitialize")(display, &major, &minor)) {
        throw Failure(std::string("EGL cannot draw without a screen (Mesa's surfaceless "
                                  "platform)") +
                      remedy);
    }
    const EGLContext context = context_of(egl, display);
    if (context == EGL_NO_CONTEXT || !egl.function<decltype(&eglMakeCurrent)>("eglMakeCurrent")(
                                         display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        throw Failure(std::string("EGL gives no OpenGL 3.2 context") + remedy);
    }
}

std::string renderer_name() {
    const auto address = Egl().function<decltype(&eglGetProcAddress)>("eglGetProcAddress");
    using GetString = const unsigned char* (*)(unsigned);
    const auto get = reinterpret_cast<GetString>(address("glGetString"));
    constexpr unsigned gl_renderer = 0x1F01;  // GL_RENDERER
    const auto* const name = get ? reinterpret_cast<const char*>(get(gl_renderer)) : nullptr;
    return name ? name : "an OpenGL without a name";
}

}  // namespace palpate::pictures

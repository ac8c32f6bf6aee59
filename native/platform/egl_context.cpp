// SPDX-License-Identifier: Apache-2.0
#include "platform/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstring>

namespace fourdvt::platform {
namespace {

constexpr const char* kRemedy = "install libegl1, libgles2 and libgl1-mesa-dri (software GL suffices)";

bool hasClientExtension(const char* name) {
  const char* list = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return list != nullptr && std::strstr(list, name) != nullptr;
}

EGLDisplay initialised(EGLDisplay display) {
  return display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) ? display : EGL_NO_DISPLAY;
}

EGLDisplay surfacelessDisplay() {
  if (!hasClientExtension("EGL_MESA_platform_surfaceless")) return EGL_NO_DISPLAY;
  auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (!get_display) return EGL_NO_DISPLAY;
  return initialised(get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
}

// The display stays initialised for the process: other contexts may share it.
class Context final : public EglContext {
 public:
  ~Context() override {
    if (context_ != EGL_NO_CONTEXT) {
      if (eglGetCurrentContext() == context_) {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      }
      eglDestroyContext(display_, context_);
    }
    if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
  }

  // Returns true if a GLES 3 context on this display is now current.
  bool makeOn(EGLDisplay display, bool with_pbuffer) {
    display_ = display;
    if (display == EGL_NO_DISPLAY || !eglBindAPI(EGL_OPENGL_ES_API)) return false;
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, with_pbuffer ? EGL_PBUFFER_BIT : 0, EGL_RENDERABLE_TYPE,
                                        EGL_OPENGL_ES3_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display, config_attributes, &config, 1, &count) || count < 1) return false;
    const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
    context_ = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
    if (context_ == EGL_NO_CONTEXT) return false;
    if (with_pbuffer) {
      const EGLint size[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
      surface_ = eglCreatePbufferSurface(display, config, size);
      if (surface_ == EGL_NO_SURFACE) return false;
    }
    return eglMakeCurrent(display, surface_, surface_, context_);
  }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
};

}  // namespace

Result<std::unique_ptr<EglContext>> EglContext::create() {
  auto context = std::make_unique<Context>();
  if (context->makeOn(surfacelessDisplay(), false)) return std::unique_ptr<EglContext>(std::move(context));
  context = std::make_unique<Context>();
  if (context->makeOn(initialised(eglGetDisplay(EGL_DEFAULT_DISPLAY)), true)) {
    return std::unique_ptr<EglContext>(std::move(context));
  }
  return Error{ErrorId::GpuFailure, std::string("no OpenGL ES 3.0 context without a screen: ") + kRemedy};
}

}  // namespace fourdvt::platform

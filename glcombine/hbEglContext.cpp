#include "glcombine/hbEglContext.h"

#include <string_view>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "volume/hbError.h"

namespace {

/// The displays that can do without a window, best first: graphics processors, software devices, Mesa's platform.
std::vector<EGLDisplay> displays(const hbSharedLibrary& library) {
  const auto address = library.function<decltype(eglGetProcAddress)>("eglGetProcAddress");
  const auto display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(address("eglGetPlatformDisplayEXT"));
  const auto devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(address("eglQueryDevicesEXT"));
  const auto text = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(address("eglQueryDeviceStringEXT"));
  std::vector<EGLDisplay> hardware, software;
  if (!display) return {};
  constexpr EGLint kMost = 16;
  EGLDeviceEXT found[kMost];
  EGLint count = 0;
  if (devices && text && devices(kMost, found, &count))
    for (EGLint i = 0; i < count; ++i) {
      const char* extensions = text(found[i], EGL_EXTENSIONS);
      const bool isSoftware =
          extensions && std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
      (isSoftware ? software : hardware).push_back(display(EGL_PLATFORM_DEVICE_EXT, found[i], nullptr));
    }
  hardware.insert(hardware.end(), software.begin(), software.end());
  hardware.push_back(display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  return hardware;
}

} // namespace

hbEglContext::hbEglContext() {
  for (const EGLDisplay display : displays(library_))
    if (display != EGL_NO_DISPLAY && open(display)) break;
  if (!context_) throw hbError("EGL: expected a device with OpenGL 3.3, found none");
  makeCurrent();
  const auto load = library_.function<decltype(eglGetProcAddress)>("eglGetProcAddress");
  initialise([load](const char* name) { return reinterpret_cast<void*>(load(name)); });
  release();
}

bool hbEglContext::open(void* display) {
  EGLint major = 0, minor = 0;
  if (!library_.function<decltype(eglInitialize)>("eglInitialize")(display, &major, &minor)) return false;
  library_.function<decltype(eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  library_.function<decltype(eglChooseConfig)>("eglChooseConfig")(display, wanted, &config, 1, &configs);
  const EGLint attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  display_ = display;
  context_ =
      library_.function<decltype(eglCreateContext)>("eglCreateContext")(display, config, EGL_NO_CONTEXT, attributes);
  return context_ != EGL_NO_CONTEXT;
}

hbEglContext::~hbEglContext() {
  // The display stays: other contexts may share it, and EGL counts nothing.
  library_.function<decltype(eglDestroyContext)>("eglDestroyContext")(display_, context_);
}

void hbEglContext::makeCurrent() {
  library_.function<decltype(eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API); // of this thread
  if (!library_.function<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, EGL_NO_SURFACE, EGL_NO_SURFACE,
                                                                     context_))
    throw hbError("EGL: expected to make the context current, which was refused");
}

void hbEglContext::release() {
  library_.function<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, EGL_NO_SURFACE, EGL_NO_SURFACE,
                                                                EGL_NO_CONTEXT);
}

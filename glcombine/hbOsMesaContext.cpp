#include "glcombine/hbOsMesaContext.h"

#include <GL/osmesa.h>

#include "volume/hbError.h"

hbOsMesaContext::hbOsMesaContext() {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            0,
                            OSMESA_STENCIL_BITS,
                            0,
                            OSMESA_ACCUM_BITS,
                            0,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  context_ = library_.function<decltype(OSMesaCreateContextAttribs)>("OSMesaCreateContextAttribs")(attributes, nullptr);
  if (!context_) throw hbError("OSMesa: expected an OpenGL 3.3 core context, found none");
  makeCurrent();
  const auto load = library_.function<decltype(OSMesaGetProcAddress)>("OSMesaGetProcAddress");
  initialise([load](const char* name) { return reinterpret_cast<void*>(load(name)); });
  release();
}

hbOsMesaContext::~hbOsMesaContext() {
  library_.function<decltype(OSMesaDestroyContext)>("OSMesaDestroyContext")(static_cast<OSMesaContext>(context_));
}

void hbOsMesaContext::makeCurrent() {
  if (!library_.function<decltype(OSMesaMakeCurrent)>("OSMesaMakeCurrent")(static_cast<OSMesaContext>(context_),
                                                                           buffer_.data(), GL_UNSIGNED_BYTE, 4, 4))
    throw hbError("OSMesa: expected to make the context current, which was refused");
}

void hbOsMesaContext::release() {
  library_.function<decltype(OSMesaMakeCurrent)>("OSMesaMakeCurrent")(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
}

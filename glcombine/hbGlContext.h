#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

class hbGlFunctions;

/// An OpenGL 3.3 or later core context that draws off screen, with no window and no display. Several may live at a
/// time, each current in one thread at the most. The libraries (OSMesa, EGL) are loaded when they are asked for: a
/// program runs without either until then.
class hbGlContext {
public:
  enum class Kind : std::uint8_t {
    automatic, ///< OSMesa, and where that is missing EGL.
    osmesa,    ///< Mesa's software renderer, in memory.
    egl        ///< A graphics processor without a display where there is one, otherwise Mesa's surfaceless platform.
  };

  /// Throws hbError naming what is missing.
  static std::unique_ptr<hbGlContext> create(Kind kind = Kind::automatic);

  virtual ~hbGlContext() = default;
  hbGlContext(const hbGlContext&) = delete;
  hbGlContext& operator=(const hbGlContext&) = delete;

  /// Makes it current in the calling thread, in which it was not or nowhere current before; release() ends that.
  /// Throws hbError.
  virtual void makeCurrent() = 0;
  virtual void release() = 0;

  /// To be called in the thread in which the context is current.
  const hbGlFunctions& gl() const { return *functions_; }

  /// "osmesa" or "egl".
  virtual std::string_view kind() const = 0;
  /// GL_VENDOR, GL_RENDERER and GL_VERSION.
  const std::string& vendor() const { return vendor_; }
  const std::string& renderer() const { return renderer_; }
  const std::string& version() const { return version_; }
  /// GL_MAX_3D_TEXTURE_SIZE: texels an axis.
  int maxTextureSize3d() const { return maxTextureSize3d_; }

protected:
  hbGlContext() = default;
  /// Loads the functions (`load`: see hbGlFunctions) and reads what the context says of itself; it must be current.
  void initialise(const std::function<void*(const char*)>& load);

private:
  std::shared_ptr<const hbGlFunctions> functions_; // shared: its deleter does not need the type
  std::string vendor_, renderer_, version_;
  int maxTextureSize3d_ = 0;
};

/// Makes a context current in this thread as long as it lives.
class hbGlCurrent {
public:
  explicit hbGlCurrent(hbGlContext& context) : context_(context) { context.makeCurrent(); }
  ~hbGlCurrent() { context_.release(); }
  hbGlCurrent(const hbGlCurrent&) = delete;
  hbGlCurrent& operator=(const hbGlCurrent&) = delete;

private:
  hbGlContext& context_;
};

// A scene drawn by VTK's volume mappers: hbvol_peer_vtk IN.nrrd SCENE.json cpu|gpu REPEATS THREADS OUT.png
// (doc/peers.md).
//
// hbvol adds up light and shows pictures as coded sRGB. So VTK is given linear light, and what it draws, in floats, is
// shown by hbvol's own display; a map's colours of greatest values are coded already.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/matrix.hpp>
#include <vtkColorTransferFunction.h>
#include <vtkContourValues.h>
#include <vtkFloatArray.h>
#include <vtkLogger.h>
#include <vtkMultiThreader.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOutputWindow.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderer.h>
#include <vtkVersion.h>
#include <vtkVolume.h>

#include "bench/peers/peer.h"
#include "bench/peers/vtkParts.h"
#include "raycast/hbRaySegment.h"
#include "scene/hbColorSpace.h"
#include "scene/hbColormap.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "scene/hbScene.h"
#include "volume/hbParallel.h"
#include "volume/hbVolumeReader.h"

namespace {

/// What VTK complains about, without its log's colours and dates. Written at once: VTK may end the program after it.
class Complaints : public vtkOutputWindow {
public:
  static Complaints* New();
  vtkTypeMacro(Complaints, vtkOutputWindow)

      void DisplayText(const char* text) override {
    std::string line = peer::oneLine(text);
    fmt::print(stderr, "vtk: {}\n", line);
    if (first_.empty()) first_ = std::move(line);
  }

  /// "" for none.
  const std::string& first() const { return first_; }

private:
  std::string first_;
};
vtkStandardNewMacro(Complaints);

using Functions = std::pair<vtkNew<vtkColorTransferFunction>, vtkNew<vtkPiecewiseFunction>>;

void refuse(bool it, const char* what) {
  if (it) throw peer::Refused(std::string("does not draw ") + what);
}

void check(const hbScene& scene, const hbGeometry& geometry, bool onGpu, const std::string& name) {
  refuse(scene.mode == hbMode::slice, "slices as a volume");
  refuse(scene.mode == hbMode::xray && !onGpu, "X-rays on the CPU");
  refuse(scene.mode == hbMode::iso && !onGpu, "iso-surfaces on the CPU");
  refuse(scene.labels, "labels");
  refuse(scene.clip.has_value(), "the box's part as hbvol clips it");
  refuse(scene.mode == hbMode::dvr && scene.preintegrated, "pre-integrated slabs");
  refuse(scene.mode == hbMode::dvr && scene.gradientOpacity.has_value(), "extinction by the gradient as hbvol does");
  refuse(scene.mode == hbMode::dvr && scene.shading && !scene.shading->lights.empty(), "lights where hbvol's are");
  refuse(geometry.isFlat(0) || geometry.isFlat(1) || geometry.isFlat(2), "flat volumes");
  const auto expect = [&](bool is, const char* what) {
    if (!is) throw hbError(fmt::format("{}: expected {} in the scene, found none", name, what));
  };
  expect(scene.window || (scene.mode != hbMode::xray && scene.mode != hbMode::mip), "a window");
  expect(scene.isoValue || scene.mode != hbMode::iso, "an iso-value");
  expect(scene.mode != hbMode::dvr ||
             (scene.transfer && scene.transfer->definition().unitLength && !scene.transfer->definition().relative),
         "a transfer function with a unit length, over values,");
}

/// The samples as VTK takes them: packed floats in this machine's byte order, whose axes are right-handed (its mappers
/// on the GPU leave out the faces of others).
hbVolume prepared(const hbVolume& volume, const std::string& name) {
  if (volume.components() != 1 || volume.type() != hbSampleType::float32)
    throw hbError(name + ": expected 32-bit floats of one component");
  hbGeometry geometry = volume.geometry();
  const hbSize3 size = geometry.size;
  const bool isMirrored = glm::determinant(geometry.direction) < 0.0;
  if (isMirrored) {
    geometry.origin += geometry.direction[0] * (geometry.spacing.x * double(size.x - 1));
    geometry.direction[0] = -geometry.direction[0];
  }
  std::vector<float> samples;
  samples.reserve(std::size_t(geometry.samples()));
  std::vector<double> row(static_cast<std::size_t>(size.x));
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      volume.row(0, y, z, 0, row);
      if (isMirrored) std::reverse(row.begin(), row.end());
      for (const double value : row) {
        if (!std::isfinite(value))
          throw peer::Refused(fmt::format("{}: expected finite values, found {}", name, value));
        samples.push_back(float(value));
      }
    }
  return hbVolume::fromSamples(geometry, std::move(samples));
}

/// One colour and full opacity everywhere.
void setWhite(Functions& functions) {
  functions.first->AddRGBPoint(0.0, 1.0, 1.0, 1.0);
  functions.second->AddPoint(0.0, 1.0);
}

void setMap(Functions& functions, const hbScene& scene) {
  constexpr int kPieces = 3 * 256; // the corners of `heat` lie at thirds
  const hbColormap map(scene.colormap.empty() ? "heat" : scene.colormap);
  const auto [lo, hi] = *scene.window;
  for (int i = 0; i <= kPieces; ++i) {
    const double t = double(i) / kPieces;
    const glm::dvec3 colour = map.rgb(t);
    functions.first->AddRGBPoint(lo + t * (hi - lo), colour.r, colour.g, colour.b);
  }
  functions.second->AddPoint(lo, 1.0);
}

/// Linear light, and opacities, piecewise linear between 4096 places, every point and both sides of it (steps), and one
/// place outside at each end.
void setTransfer(Functions& functions, const hbTransferFunction& transfer) {
  constexpr int kPieces = 4096;
  const auto [lo, hi] = transfer.range();
  const double piece = (hi - lo) / kPieces;
  std::set<double> places;
  for (int i = -1; i <= kPieces + 1; ++i) places.insert(lo + i * piece);
  const auto addPoint = [&](double value) {
    const double side = 1e-9 * (hi - lo);
    places.insert({value - side, value, value + side});
  };
  for (const auto& point : transfer.definition().colors) addPoint(point.value);
  for (const auto& point : transfer.definition().opacities) addPoint(point.value);
  for (const double place : places) {
    const glm::dvec3 colour = transfer.colour(place);
    functions.first->AddRGBPoint(place, colour.r, colour.g, colour.b);
    functions.second->AddPoint(place, transfer.opacity(place));
  }
}

/// The integral that is drawn as full light, over the least value's: large enough for the window's upper end. VTK adds
/// up values counted from the least one.
double brightest(const hbScene& scene, const hbGeometry& geometry, double least, double greatest) {
  const double longest = glm::length(geometry.extent());
  const double needed = scene.window->second - std::min(0.0, least) * longest;
  const double possible = (greatest - least) * longest;
  return needed > 0.0 ? std::min(needed, possible) : possible;
}

class Drawing {
public:
  Drawing(const hbVolume& volume, const hbScene& scene, bool onGpu)
      : volume_(volume), scene_(scene), camera_(scene.cameraFor(volume.geometry())), image_(peer::imageOf(volume)) {
    step_ = scene.sampling.stepLength(volume.geometry(), camera_);
    image_->GetScalarRange(range_.data());
    vtkNew<vtkVolume> prop;
    prop->SetUserMatrix(peer::placeOf(volume.geometry()));
    setProperty(*prop->GetProperty());
    vtkSmartPointer<vtkVolumeMapper> mapper;
    if (onGpu)
      mapper = peer::onGpu(step_);
    else
      mapper = peer::onCpu(step_);
    mapper->SetInputData(image_);
    mapper->SetBlendMode(blendMode());
    prop->SetMapper(mapper);
    renderer_->AddVolume(prop);
    setBackground();
    peer::look(*renderer_->GetActiveCamera(), camera_);
    renderer_->ResetCameraClippingRange();
    window_->SetOffScreenRendering(1);
    window_->SetMultiSamples(0);
    window_->SetAlphaBitPlanes(1);
    window_->SetSize(scene.width, scene.height);
    window_->AddRenderer(renderer_);
  }

  double step() const { return step_; }
  std::string rendererName() { return peer::rendererOf(*window_); }

  /// Gives the window its OpenGL, and 32-bit floats to draw into instead of 8 bits: linear light needs more of them,
  /// and so do integrals.
  void begin() {
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(window_);
    if (window == nullptr) throw hbError("expected VTK to draw by OpenGL");
    window->Start();
    // The depth as VTK has it: its mapper on the GPU copies it, and with another sees nothing.
    constexpr int kColourTextures = 1, kDepthBits = 32, kMultisamples = 0;
    if (!window->GetRenderFramebuffer()->PopulateFramebuffer(scene_.width, scene_.height, true, kColourTextures,
                                                             VTK_FLOAT, true, kDepthBits, kMultisamples))
      throw hbError("no frame buffer of floats");
  }

  void draw() {
    window_->Render();
    window_->WaitForCompletion();
  }

  hbImage8 image() {
    hbPicture picture = read();
    switch (scene_.mode) {
    case hbMode::mip:
      return coded(picture);
    case hbMode::xray:
      integrate(picture);
      break;
    default:
      picture.channels["Y"] = picture.channels["R"]; // what iso-surfaces show; composited ones show colours
    }
    return hb::displayImage(picture, scene_);
  }

private:
  vtkVolumeMapper::BlendModes blendMode() const {
    switch (scene_.mode) {
    case hbMode::xray:
      return vtkVolumeMapper::ADDITIVE_BLEND;
    case hbMode::mip:
      return vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND;
    case hbMode::iso:
      return vtkVolumeMapper::ISOSURFACE_BLEND;
    default:
      return vtkVolumeMapper::COMPOSITE_BLEND;
    }
  }

  void setProperty(vtkVolumeProperty& property) {
    Functions functions;
    property.SetInterpolationTypeToLinear();
    switch (scene_.mode) {
    case hbMode::xray:
      setWhite(functions);
      brightest_ = brightest(scene_, volume_.geometry(), range_[0], range_[1]);
      property.SetScalarOpacityUnitDistance(brightest_ / (range_[1] - range_[0]));
      break;
    case hbMode::mip:
      setMap(functions, scene_);
      break;
    case hbMode::iso:
      setWhite(functions);
      property.GetIsoSurfaceValues()->SetValue(0, *scene_.isoValue);
      peer::reflect(property, {.ambient = 0.0, .diffuse = 1.0, .specular = 0.0, .shininess = 1.0, .lights = {}});
      break;
    default:
      setTransfer(functions, *scene_.transfer);
      property.SetScalarOpacityUnitDistance(*scene_.transfer->definition().unitLength);
      if (scene_.shading) peer::reflect(property, *scene_.shading);
    }
    property.SetColor(functions.first);
    property.SetScalarOpacity(functions.second);
  }

  /// Nothing, which hb::displayImage() puts the background behind; under a map's colours that themselves.
  void setBackground() {
    const bool isCoded = scene_.mode == hbMode::mip;
    const glm::dvec3 colour = isCoded ? hb::backgroundColour(scene_) : glm::dvec3(0.0);
    renderer_->SetBackground(colour.r, colour.g, colour.b);
    renderer_->SetBackgroundAlpha(isCoded ? 1.0 : 0.0);
  }

  /// "R", "G", "B", "A" as VTK leaves them in its frame buffer.
  hbPicture read() {
    vtkNew<vtkFloatArray> pixels;
    window_->GetRGBAPixelData(0, 0, scene_.width - 1, scene_.height - 1, 0, pixels);
    hbPicture picture{scene_.width, scene_.height, {}, {}};
    for (int c = 0; c < 4; ++c) {
      std::vector<float>& channel = picture.add(std::string(1, "RGBA"[c]));
      if (std::size_t(pixels->GetNumberOfValues()) != 4 * channel.size())
        throw hbError("the picture cannot be read back");
      for (int y = 0; y < scene_.height; ++y) // the bottom row first
        for (int x = 0; x < scene_.width; ++x)
          channel[std::size_t(x) + std::size_t(scene_.width) * std::size_t(scene_.height - 1 - y)] =
              pixels->GetValue(4 * (x + vtkIdType(scene_.width) * y) + c);
    }
    return picture;
  }

  /// "Y" from "R": values times length, counted from 0 instead of the least value.
  void integrate(hbPicture& picture) const {
    const glm::dmat4 worldToCube = glm::inverse(volume_.geometry().cubeToWorld());
    std::vector<float>& integrals = picture.channels["Y"] = picture.channels["R"];
    std::size_t pixel = 0;
    for (int y = 0; y < scene_.height; ++y)
      for (int x = 0; x < scene_.width; ++x, ++pixel) {
        const auto segment = hb::clipToCube(camera_.ray(x + 0.5, y + 0.5, scene_.width, scene_.height), worldToCube);
        const double length = segment ? segment->length() : 0.0;
        integrals[pixel] = float(brightest_ * integrals[pixel] + range_[0] * length);
      }
  }

  /// Colours as they are.
  static hbImage8 coded(const hbPicture& picture) {
    hbImage8 image{picture.width, picture.height, {}};
    for (std::size_t i = 0; i < picture.channels.at("R").size(); ++i)
      for (const char* name : {"R", "G", "B"})
        image.rgb.push_back(std::uint8_t(std::lround(255.0F * std::clamp(picture.channels.at(name)[i], 0.0F, 1.0F))));
    return image;
  }

  const hbVolume& volume_;
  const hbScene& scene_;
  hbCamera camera_;
  double step_ = 0.0;
  std::array<double, 2> range_{}; ///< Of the samples.
  double brightest_ = 0.0;
  vtkNew<vtkImageData> image_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
};

/// Holds VTK to so many threads (0: one a core), and Mesa's software renderer, where LP_NUM_THREADS does not say:
/// before either begins. Returns VTK's, which has a bound of its own.
int holdToThreads(int threads) {
  if (threads > 0) ::setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 0);
  vtkMultiThreader::SetGlobalDefaultNumberOfThreads(threads > 0 ? threads : hb::parallelThreads());
  return vtkMultiThreader::GetGlobalDefaultNumberOfThreads();
}

nlohmann::ordered_json work(char** arguments) {
  constexpr int kMostRepeats = 10000, kMostThreads = 4096;
  const std::string in = arguments[0], sceneName = arguments[1], mapper = arguments[2], out = arguments[5];
  if (mapper != "cpu" && mapper != "gpu") throw hbError(fmt::format("mapper: expected cpu or gpu, found '{}'", mapper));
  const std::uint64_t repeats = peer::wholeNumber(arguments[3], "REPEATS", 1, kMostRepeats);
  const int threads = holdToThreads(int(peer::wholeNumber(arguments[4], "THREADS", 0, kMostThreads)));
  const hbScene scene = hb::loadScene(sceneName);
  const hbVolume volume = prepared(hb::readVolume(in), in);
  check(scene, volume.geometry(), mapper == "gpu", sceneName);
  // VTK ends the program where there is none.
  if (std::getenv("DISPLAY") == nullptr) throw hbError("expected an X server (DISPLAY), found none");

  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  vtkNew<Complaints> complaints;
  vtkOutputWindow::SetInstance(complaints);
  Drawing drawing(volume, scene, mapper == "gpu");
  const double first = peer::seconds([&] {
    drawing.begin();
    drawing.draw();
  });
  std::vector<double> frames;
  for (std::uint64_t i = 0; i < repeats; ++i) frames.push_back(peer::seconds([&] { drawing.draw(); }));
  const hbImage8 image = drawing.image();
  if (!complaints->first().empty()) throw hbError(complaints->first());
  hb::writePng(image, out);
  return {{"name", "vtk"},          {"version", vtkVersion::GetVTKVersion()},
          {"mapper", mapper},       {"renderer", drawing.rendererName()},
          {"threads", threads},     {"step", drawing.step()},
          {"seconds_first", first}, {"seconds_frames", frames}};
}

} // namespace

int main(int count, char** arguments) {
  return peer::run(count, arguments, "vtk", vtkVersion::GetVTKVersion(),
                   "IN.nrrd SCENE.json cpu|gpu REPEATS THREADS OUT.png", work);
}

#include "report/hbComparisonPeers.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "raycast/hbNominalSamples.h"
#include "report/hbMedian.h"
#include "report/hbPictureDifference.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "volume/hbError.h"
#include "volume/hbVolumeWriter.h"

namespace fs = std::filesystem;

namespace {

/// An image's luma as values from 0 to 1, to show differences of images.
hbPicture lumaOf(const hbImage8& image) {
  hbPicture picture{image.width, image.height, {}, {}};
  std::vector<float>& y = picture.add("Y");
  for (std::size_t i = 0; i < y.size(); ++i) {
    const std::uint8_t* rgb = &image.rgb[3 * i];
    y[i] = (0.299F * float(rgb[0]) + 0.587F * float(rgb[1]) + 0.114F * float(rgb[2])) / 255.0F;
  }
  return picture;
}

} // namespace

hbComparisonPeers::hbComparisonPeers(const hbComparisonSource& source, const hbComparison& what,
                                     const hbComparisonFolder& folder)
    : source_(source), what_(what), folder_(folder), peers_(what.peerFolders.value_or(std::vector<fs::path>())),
      isAsked_(what.peerFolders && source.volume().components() == 1), place_(folder.path() / "peers") {}

hbComparisonPeers::~hbComparisonPeers() {
  std::error_code ignored;
  fs::remove_all(place_, ignored);
}

hb::ReportJson hbComparisonPeers::versions(hbProgress& progress) const {
  return {{"zfp", hasZfp() ? hb::ReportJson(peers_.zfpVersion(progress)) : hb::ReportJson()},
          {"vtk", hasVtk() ? hb::ReportJson(peers_.vtkVersion(progress)) : hb::ReportJson()}};
}

const fs::path& hbComparisonPeers::floats() {
  if (!floats_.empty()) return floats_;
  const double bytes = 4.0 * double(source_.volume().geometry().samples());
  if (bytes > double(what_.memoryLimit))
    throw hbError(fmt::format("the volume in floats needs {:.3g} MB, more than the memory limit of {:.3g} MB",
                              bytes / 0x1p20, double(what_.memoryLimit) / 0x1p20));
  fs::create_directories(place_);
  hb::writeVolume(source_.floats(), place_ / "floats.nrrd");
  return floats_ = place_ / "floats.nrrd";
}

hb::ReportJson hbComparisonPeers::vtk(hbPeers::VtkMapper mapper, hbScene scene, const hbPicture& reference,
                                      const std::string& key, double shownDifference, hbProgress& progress) {
  floats();
  scene.window = hb::displayWindow(reference, scene);
  if (!(scene.window->first < scene.window->second)) scene.window.reset(); // a picture of one value
  const fs::path sceneFile = place_ / "scene.json";
  hb::saveScene(scene, sceneFile);
  const std::string image = hbComparisonFolder::picture(key);
  const hbVtkRun run =
      peers_.render(floats_, sceneFile, mapper, what_.repeats, what_.threads, folder_.path() / image, progress);

  const hbImage8 expected = hb::displayImage(reference, scene), found = hb::readPng(folder_.path() / image);
  const std::string difference = hbComparisonFolder::picture(key + "-difference");
  hb::writePng(hb::signedDifferenceImage(lumaOf(found), lumaOf(expected), shownDifference),
               folder_.path() / difference);
  const double median = hb::median(run.secondsFrames);
  const auto [least, greatest] = std::minmax_element(run.secondsFrames.begin(), run.secondsFrames.end());
  const double samples = hb::nominalSamples(source_.volume().geometry(), scene);
  return {{"image_only", true},
          {"seconds_build", nullptr},
          {"seconds_first_picture", run.secondsFirst},
          {"seconds_warmup", run.secondsFirst},
          {"seconds_frame",
           {{"median", median}, {"min", *least}, {"max", *greatest}, {"repeats", run.secondsFrames.size()}}},
          {"samples", samples},
          {"samples_per_second", samples / median},
          {"sampling", "equidistant"},
          {"compressed_bytes", source_.bytes()},
          {"resident_bytes", nullptr},
          {"memory_growth_bytes", nullptr},
          {"texture_bytes", nullptr},
          {"gl_renderer", run.renderer},
          {"picture", hb::reportJson(hb::pictureDifference(expected, found))},
          {"true_picture", nullptr},
          {"image", image},
          {"difference", difference}};
}

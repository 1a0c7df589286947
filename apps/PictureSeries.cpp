#include "apps/PictureSeries.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/Program.h"
#include "glcombine/hbRenderer.h"
#include "scene/hbCameraPath.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "volume/hbError.h"

namespace {

void warnOfWhatIsSeen(const hbPicture& picture, const hbScene& scene, const hbHistogram& histogram) {
  const std::vector<float>& covered = *picture.find("A");
  if (scene.mode == hbMode::iso && std::all_of(covered.begin(), covered.end(), [](float a) { return a == 0.0F; }))
    fmt::print(
        stderr,
        "hbvol: warning: nothing of the iso-surface {} is in view; the values looked at lie in [{:.6g}, {:.6g}]\n",
        *scene.isoValue, histogram.min, histogram.max);
  const std::vector<float>& shown = *picture.find("Y");
  if (std::any_of(shown.begin(), shown.end(), [](float y) { return !std::isfinite(y); }))
    fmt::print(stderr, "hbvol: warning: NaN or infinite samples show in the picture; --nan-value V replaces them\n");
}

} // namespace

double app::PictureTimes::sinceBegin() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void app::PictureSeries::addTo(CLI::App& subcommand) {
  CLI::Option* around =
      subcommand.add_option("--orbit", orbit, "N pictures once around the volume, OUT-0000.png and so on")
          ->check(CLI::Range(1, int(hb::kMostCameras)))
          ->group("Camera")
          ->type_name("N");
  subcommand.add_option("--path", path, "A picture for each camera of a file, numbered likewise")
      ->excludes(around)
      ->group("Camera")
      ->type_name("CAMERAS.json");
  subcommand.add_option("--save-path", savePath, "Save the cameras of all pictures, for --path")
      ->group("Camera")
      ->type_name("CAMERAS.json");
}

std::vector<hbCamera> app::PictureSeries::cameras(const hbCamera& first) const {
  if (!path.empty()) return hb::loadPath(path);
  return hb::orbit(first, std::max(1, orbit));
}

void app::PictureSeries::draw(hbRenderer& renderer, const Output& output, const hbHistogram& histogram,
                              PictureTimes& times) const {
  const std::vector<hbCamera> all = cameras(*renderer.scene().camera);
  std::optional<std::pair<double, double>> window;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (isAskedFor()) renderer.look(all[i]);
    hbPicture picture;
    for (int k = 0; k < output.repeat; ++k) {
      const double before = times.sinceBegin();
      picture = renderer.render(app::progress());
      times.pictures.push_back(times.sinceBegin() - before);
      if (times.pictures.size() == 1) times.first = times.sinceBegin();
    }
    if (i == 0) warnOfWhatIsSeen(picture, renderer.scene(), histogram);
    if (i == 0 && !output.scene.empty()) hb::saveScene(renderer.scene(), output.scene);
    picture.metadata.insert(output.metadata.begin(), output.metadata.end());
    if (!window) window = hb::displayWindow(picture, renderer.scene());
    const std::string file = isAskedFor() ? name(output.name, i, all.size()) : output.name;
    if (app::extension(file) == ".exr")
      hb::writeExr(picture, file);
    else
      hb::writePng(hb::displayImage(picture, renderer.scene(), *window), file);
  }
  if (!savePath.empty()) hb::savePath(all, savePath);
}

std::string app::PictureSeries::name(const std::string& out, std::size_t index, std::size_t count) {
  const std::filesystem::path whole(out);
  const std::size_t digits = std::max<std::size_t>(4, fmt::format("{}", count - 1).size());
  return (whole.parent_path() /
          fmt::format("{}-{:0{}}{}", whole.stem().string(), index, digits, whole.extension().string()))
      .string();
}

void app::PictureSeries::checkOthers(const std::string& out, const std::vector<std::string>& others) const {
  if (!isAskedFor()) return;
  const std::filesystem::path whole(out);
  const std::string prefix = whole.stem().string() + "-";
  for (const std::string& other : others) {
    const std::filesystem::path file(other);
    const std::string stem = file.stem().string();
    if (file.parent_path() == whole.parent_path() && file.extension() == whole.extension() &&
        stem.starts_with(prefix) && stem.find_first_not_of("0123456789", prefix.size()) == std::string::npos)
      throw hbError(fmt::format("{}: expected a name that no picture of the series has", other));
  }
}

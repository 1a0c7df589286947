#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "scene/hbCamera.h"
#include "volume/hbHistogram.h"

namespace CLI {
class App;
}

class hbRenderer;

namespace app {

/// What the pictures of a run took, in seconds.
struct PictureTimes {
  double load = 0.0, build = 0.0;
  double first = 0.0;           ///< From the beginning to the first picture, everything included.
  std::vector<double> pictures; ///< Each one's own, in order.

  double sinceBegin() const;

private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// The options of `render` that make several pictures, each of its own camera.
struct PictureSeries {
  int orbit = 0;
  std::string path, savePath;

  void addTo(CLI::App& subcommand);
  bool isAskedFor() const { return orbit > 0 || !path.empty(); }

  /// Where pictures go and what is written beside them.
  struct Output {
    std::string name, scene; ///< The scene's "": nowhere.
    int repeat = 1;          ///< How often each picture is drawn.
    std::map<std::string, std::string> metadata;
  };
  /// Draws and writes all pictures, or one where no series is asked for, and warns on stderr where nothing or nothing
  /// finite is seen. `histogram`: of what iso-values are chosen from. PNGs are shown through the first one's window.
  void draw(hbRenderer& renderer, const Output& output, const hbHistogram& histogram, PictureTimes& times) const;

  /// The name of picture `index` of `count`: "out-0007.exr" of "out.exr".
  static std::string name(const std::string& out, std::size_t index, std::size_t count);
  /// Throws hbError where a picture of a series that is asked for may have one of these names.
  void checkOthers(const std::string& out, const std::vector<std::string>& others) const;

private:
  std::vector<hbCamera> cameras(const hbCamera& first) const;
};

} // namespace app

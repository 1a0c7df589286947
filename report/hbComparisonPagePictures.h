#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "report/hbHtmlWriter.h"
#include "report/hbReportPlace.h"

/// The pictures and plots of a comparison's page, inlined. Not installed.
class hbComparisonPagePictures {
public:
  /// Chooses what to show. `folder` is where the report's paths begin.
  hbComparisonPagePictures(const hbReportPlace& report, std::filesystem::path folder);

  /// A mode's reference, then each choice with its difference picture, in the order of the mode's table. Says which
  /// pictures are missing or left out. This and the next throw hbError where one that is there cannot be read.
  void write(hbHtmlWriter& page, const std::string& mode) const;

  /// A plot; nothing where the report has none there.
  void writePlot(hbHtmlWriter& page, const hbReportPlace& place, const char* description) const;

private:
  void writeCase(hbHtmlWriter& page, const hbReportPlace& one) const;
  void writeImage(hbHtmlWriter& page, const hbReportPlace& path, const std::string& description) const;

  hbReportPlace report_;
  std::filesystem::path folder_;
  std::set<std::string> inlined_; ///< Paths of the pictures that the page has room for.
};

namespace hb {

/// The cases of a mode whose pictures are shown: of each choice the fastest, and those of its engines whose pictures
/// look different (the mean L*u*v* distance to the reference differs by more than 1, what can just be seen). The
/// reference, which is the volume itself by engine "full", comes first, whatever is faster.
std::vector<hbReportPlace> casesToShow(const hbReportPlace& report, const std::string& mode);

} // namespace hb

#pragma once

#include <filesystem>
#include <string>

#include "report/hbComparison.h"
#include "report/hbComparisonFolder.h"
#include "report/hbComparisonSource.h"
#include "report/hbPeers.h"
#include "report/hbReportJson.h"
#include "scene/hbPicture.h"

/// Other programs in a comparison, where they are found: zfp as one more way to keep the volume, VTK as one more way to
/// draw it. They are given files, in the folder's peers/ as long as this lives. Volumes of one component only.
class hbComparisonPeers {
public:
  /// Keeps references.
  hbComparisonPeers(const hbComparisonSource& source, const hbComparison& what, const hbComparisonFolder& folder);
  ~hbComparisonPeers();
  hbComparisonPeers(const hbComparisonPeers&) = delete;
  hbComparisonPeers& operator=(const hbComparisonPeers&) = delete;

  bool hasZfp() const { return isAsked_ && peers_.hasZfp(); }
  bool hasVtk() const { return isAsked_ && peers_.hasVtk(); }
  const hbPeers& peers() const { return peers_; }
  /// {"zfp", "vtk"}: their versions, null where they take no part.
  hb::ReportJson versions(hbProgress& progress) const;

  /// The volume as a file of 32-bit floats, written when it is first asked for. Throws hbError where it cannot be.
  const std::filesystem::path& floats();

  /// A case drawn by VTK: times, and errors of the picture as displayed against `reference` as displayed, in bytes
  /// ("image_only"); its pictures are written by the names of `key`. Throws hbPeerRefusal for what VTK does not draw,
  /// hbError, hbCancelled.
  hb::ReportJson vtk(hbPeers::VtkMapper mapper, hbScene scene, const hbPicture& reference, const std::string& key,
                     double shownDifference, hbProgress& progress);

private:
  const hbComparisonSource& source_;
  const hbComparison& what_;
  const hbComparisonFolder& folder_;
  hbPeers peers_;
  bool isAsked_;
  std::filesystem::path place_, floats_;
};

#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "report/hbComparison.h"
#include "report/hbComparisonChoices.h"
#include "report/hbComparisonFolder.h"
#include "report/hbComparisonPeers.h"
#include "report/hbComparisonSource.h"
#include "report/hbReportJson.h"

/// Carries out a comparison: every choice, drawn by every engine in every mode, each picture against the full grid's
/// and, of an analytic field, against the field's own.
///
/// A case is measured as a user meets it: what is kept is read, the engine made, one frame drawn to warm up (with it
/// the first picture is there), then frames are timed. A case that fails is reported as failed; the rest goes on. What
/// was measured is kept in the folder at once, so that an interrupted comparison goes on where it stopped.
class hbComparisonRun {
public:
  /// What a folder of this comparison is known by: its settings, the input, and the version of the program.
  static hb::ReportJson identity(const hbComparisonSource& source, const hbComparison& what);

  /// Keeps references. Completes the scene by the values of the full grid (camera, iso-value, transfer function).
  hbComparisonRun(const hbComparisonSource& source, const hbComparison& what, hbComparisonFolder& folder);

  /// Measures what is not yet known and gives the report, as doc/comparison.md describes it, without plots. Throws
  /// hbCancelled, and hbError where the folder cannot be written.
  hb::ReportJson run(hbProgress& progress);

private:
  using Json = hb::ReportJson;
  struct Case;

  std::vector<Case> casesOf(const hbComparisonChoice& choice) const;
  void take(const hbComparisonChoice& choice, hbProgress& progress);
  void measure(const hbComparisonChoice& choice, const Case& one, hbProgress& progress);
  /// The record of a case: the one kept, or what `make` adds to its head.
  Json record(const Case& one, const std::string& choice, const std::function<Json()>& make);
  Json measured(const hbComparisonChoice& choice, const Case& one, hbProgress& progress);
  void compare(const hbPicture& picture, const Case& one, Json& record);
  /// The picture that others in that mode are compared with, drawn once and kept in the folder.
  const hbPicture& reference(hbMode mode, bool isTrue, hbProgress& progress);
  /// The completed scene. Throws hbError where it could not be completed: of a constant, there is no dvr.
  const hbScene& sceneOf(hbMode mode) const;
  hbPicture draw(const hbField& field, hbMode mode, hbProgress& progress) const;
  /// The fits of that level, each drawn by the first engine.
  void takeFits(int level, hbComparisonChoices& choices, hbProgress& progress);
  /// Zfp as one more choice, with as many bytes as that sparse grid.
  void takeZfp(const hbComparisonChoice& sparse, hbComparisonChoices& choices, hbProgress& progress);
  /// The volume itself, drawn by VTK.
  void takeVtk(hbProgress& progress);
  Json assemble(hbProgress& progress) const;

  const hbComparisonSource& source_;
  const hbComparison& what_;
  hbComparisonFolder& folder_;
  hbComparisonPeers peers_;
  std::map<hbMode, hbScene> scenes_;
  std::map<hbMode, std::string> sceneErrors_;
  std::map<std::pair<hbMode, bool>, hbPicture> references_;
  std::vector<Json> choices_, cases_;
};

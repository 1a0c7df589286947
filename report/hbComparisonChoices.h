#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "report/hbComparison.h"
#include "report/hbComparisonFolder.h"
#include "report/hbComparisonPeers.h"
#include "report/hbComparisonSource.h"
#include "report/hbReportJson.h"

/// One way to keep a volume: what is known of it, and how it is had back.
struct hbComparisonChoice {
  std::string key; ///< "sparse-8"
  /// "kind", "label", "level", "bytes", "values" and so on; "status" is "done" or "failed".
  hb::ReportJson record;
  /// Reads and unpacks what is kept: a sparse grid, or a plain volume.
  std::function<hbInput()> load;

  bool isDone() const { return record["status"] == "done"; }
};

/// Makes the ways to keep a volume that are compared, each once: what the folder knows already is not made again. One
/// that fails is a choice with the status "failed" and its error; it is tried again next time. All throw hbCancelled.
class hbComparisonChoices {
public:
  /// Keeps references.
  hbComparisonChoices(const hbComparisonSource& source, const hbComparison& what, hbComparisonFolder& folder)
      : source_(source), what_(what), folder_(folder) {}

  /// The volume as it is, uncompressed.
  hbComparisonChoice original(hbProgress& progress);
  /// The regular sparse grid of that level, as choices/sparse-N.hbv. Of an analytic field it interpolates the field, on
  /// axes as fine as the level has them; of a volume its trilinear interpolant, capped as `compress` does.
  hbComparisonChoice sparse(int level, hbProgress& progress);
  /// The same set fitted to all samples, as choices/METHOD-N.hbv, with the "fit" of the component compared
  /// (hb::toJson()). Of an analytic field those of its nominal sizes. Where the fit is no better than interpolation on
  /// the samples held out, the grid interpolates, and the label says so.
  hbComparisonChoice fitted(const hbComparison::Fit& fit, int level, hbProgress& progress);
  /// A coarser full grid that takes no more than `bytes`: those of the sparse grid of that level.
  hbComparisonChoice coarse(int level, std::uint64_t bytes, hbProgress& progress);

  /// What zfp makes of the volume within those bytes, unpacked as choices/zfp-N.nrrd.
  hbComparisonChoice zfp(hbComparisonPeers& peers, int level, std::uint64_t bytes, hbProgress& progress);

private:
  using Json = hb::ReportJson;

  /// The record of `key`: the one kept, or what `make` adds to `head`.
  Json record(const std::string& key, Json head, const std::function<void(Json&)>& make);
  /// Adds bytes and errors; `atPoints` is the same field, fast at single points.
  void describe(Json& record, const hbField& field, const hbField& atPoints, std::uint64_t bytes,
                hbProgress& progress) const;
  /// The sparse grid of that level, interpolating or fitted, by the name of `key`.
  hbComparisonChoice sparseGrid(const std::string& key, Json head, int level, const std::optional<hbFit>& fit,
                                hbProgress& progress);
  void makeSparse(const std::string& key, int level, const std::optional<hbFit>& fit, Json& record,
                  hbProgress& progress) const;

  const hbComparisonSource& source_;
  const hbComparison& what_;
  hbComparisonFolder& folder_;
};

#pragma once

#include "fitting/hbFitReport.h"
#include "report/hbReportJson.h"

namespace hb {

/// For statistics files: what hbFitReport has; null for what is not known.
ReportJson toJson(const hbFitReport& report);

/// The same without figures that differ from machine to machine, for a file's provenance.
ReportJson provenanceOf(const hbFitReport& report);

} // namespace hb

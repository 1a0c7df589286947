#pragma once

#include <string>
#include <vector>

#include "report/hbHardCaseResults.h"

namespace hb {

/// A table in Markdown, a row a case: what is added up at a point, in parts of the range, in the hierarchical basis and
/// in the combination; for each way the error in parts of the range and, behind a slash, what rounding may do ("no
/// statement" where that is the range or more), bold where it is stable, "-" where it was refused or failed; the way
/// with the least error.
std::string hardCaseTable(const std::vector<hbHardCaseResults>& cases);

} // namespace hb

#pragma once

#include <string>
#include <vector>

#include "report/hbHtmlWriter.h"
#include "report/hbReportPlace.h"

/// The tables of a comparison's page; see hbComparisonPage.h. Not installed.
namespace hb {

/// The choice of a key in the report; null where there is none.
hbReportPlace choiceOf(const hbReportPlace& report, const std::string& key);

/// Whether a case's picture was compared in the picture's values. Those of other programs ("image_only") were compared
/// as images of bytes: their maximum, RMSE and PSNR cannot stand beside the others'.
bool hasPictureValues(const hbReportPlace& one);

/// The cases of a mode that were measured, in the order of the page: choices by the least error of their pictures
/// (unknown last), those of a choice by their time, the ones without picture values last.
std::vector<hbReportPlace> casesInOrder(const hbReportPlace& report, const std::string& mode);

void writeChoiceTable(hbHtmlWriter& page, const hbReportPlace& report);
void writeModeTable(hbHtmlWriter& page, const hbReportPlace& report, const std::string& mode);
void writeRecommendations(hbHtmlWriter& page, const hbReportPlace& report);
void writeFailures(hbHtmlWriter& page, const hbReportPlace& report); ///< Choices and cases; or says that there is none.
void writeHardCases(hbHtmlWriter& page, const hbReportPlace& report); ///< Nothing where none were measured.
void writeColumnMeanings(hbHtmlWriter& page, const hbReportPlace& report);

} // namespace hb

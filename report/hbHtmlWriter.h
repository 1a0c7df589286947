#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/hbReportPlace.h"

/// The unit that a figure on a page is given in: the text is the value divided by `factor`.
struct hbUnit {
  const char* name = ""; ///< "" where the value stands as it is.
  double factor = 1.0;
  int decimals = -1; ///< Digits after the point; -1, or where fewer than three would count: hb::figureText() chooses.
};

namespace hb {

/// For people: three to four significant digits, integers below a million whole; "0.0123", "45.6", "7109137",
/// "1.23e-5". A dash for what is not finite.
std::string figureText(double value);

} // namespace hb

/// Writes HTML that is well-formed XML as well: elements are closed in the order they were opened in, and what they
/// hold is escaped. Not installed: it shows nlohmann-json.
///
/// Figures and names out of a report carry the pointer to their place ("data-json"), figures the whole value besides,
/// so that a program can hold the page against the report.
class hbHtmlWriter {
public:
  using Attributes = std::initializer_list<std::pair<const char*, std::string_view>>;

  void open(const char* tag, Attributes attributes = {});
  void close(); ///< The element opened last.

  /// Text; what is no UTF-8 or cannot stand in XML appears as U+FFFD.
  void text(std::string_view text);
  void element(const char* tag, std::string_view text, Attributes attributes = {});
  void empty(const char* tag, Attributes attributes = {}); ///< An element without content: <br/>

  /// A number of the report in a unit; a dash where there is none or it is not finite.
  void figure(const hbReportPlace& place, const hbUnit& unit = {});

  /// A string of the report as it stands; a dash where there is none.
  void quote(const hbReportPlace& place);

  /// What was written; all elements must be closed.
  const std::string& html() const;

private:
  void startTag(const char* tag, Attributes attributes);

  std::string html_;
  std::vector<const char*> open_;
};

#include "report/hbHtmlWriter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace {

constexpr int kDigits = 3; ///< That count, at the least.

constexpr std::string_view kReplacement = "\xef\xbf\xbd"; // U+FFFD
constexpr std::string_view kDash = "\xe2\x80\x93";

/// Bytes of the UTF-8 sequence that begins the text; 0 where none does. Overlong forms, surrogates and what is beyond
/// U+10FFFF are none.
std::size_t sequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto tail = [&](std::size_t i) { return (byte(i) & 0xc0U) == 0x80U; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80U) return 1;
  if (first >= 0xc2U && first <= 0xdfU && tail(1)) return 2;
  const bool three = first >= 0xe0U && first <= 0xefU && tail(1) && tail(2);
  if (three && !(first == 0xe0U && second < 0xa0U) && !(first == 0xedU && second >= 0xa0U)) return 3;
  const bool four = first >= 0xf0U && first <= 0xf4U && tail(1) && tail(2) && tail(3);
  if (four && !(first == 0xf0U && second < 0x90U) && !(first == 0xf4U && second >= 0x90U)) return 4;
  return 0;
}

/// Whether XML 1.0 allows the character: no controls but tab and line ends, and not the two last ones of the plane.
bool allowed(std::string_view character) {
  if (character.size() == 1) {
    const auto byte = static_cast<unsigned char>(character[0]);
    return byte >= 0x20U || byte == '\t' || byte == '\n' || byte == '\r';
  }
  return character != "\xef\xbf\xbe" && character != "\xef\xbf\xbf";
}

void appendEscaped(std::string& to, std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = sequenceLength(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0 || !allowed(character))
      to += kReplacement;
    else if (character == "<")
      to += "&lt;";
    else if (character == ">")
      to += "&gt;";
    else if (character == "&")
      to += "&amp;";
    else if (character == "\"")
      to += "&quot;";
    else
      to += character;
    text.remove_prefix(character.size());
  }
}

} // namespace

std::string hb::figureText(double value) {
  const double size = std::abs(value);
  if (!std::isfinite(value)) return std::string(kDash);
  if (value == 0.0) return "0";
  if ((value == std::floor(value) && size < 1e9) || (size >= 99.95 && size < 1e6)) return fmt::format("{:.0f}", value);
  if (size < 0.0009995 || size >= 99.95) return fmt::format("{:.{}e}", value, kDigits - 1);
  const int decimals = kDigits - 1 - int(std::floor(std::log10(size * (1 + 0.0005)))); // 9.996 becomes 10.0
  return fmt::format("{:.{}f}", value, decimals);
}

void hbHtmlWriter::startTag(const char* tag, Attributes attributes) {
  html_.append("<").append(tag);
  for (const auto& [name, value] : attributes) {
    html_.append(" ").append(name).append("=\"");
    appendEscaped(html_, value);
    html_ += '"';
  }
}

void hbHtmlWriter::open(const char* tag, Attributes attributes) {
  startTag(tag, attributes);
  html_ += '>';
  open_.push_back(tag);
}

void hbHtmlWriter::close() {
  assert(!open_.empty());
  html_.append("</").append(open_.back()).append(">\n");
  open_.pop_back();
}

void hbHtmlWriter::text(std::string_view text) { appendEscaped(html_, text); }

void hbHtmlWriter::element(const char* tag, std::string_view content, Attributes attributes) {
  open(tag, attributes);
  text(content);
  close();
}

void hbHtmlWriter::empty(const char* tag, Attributes attributes) {
  startTag(tag, attributes);
  html_ += "/>";
}

void hbHtmlWriter::figure(const hbReportPlace& place, const hbUnit& unit) {
  const auto number = place.number();
  if (!number || !std::isfinite(*number)) return text(kDash);
  startTag("data", {{"value", place.value().dump()}, {"data-json", place.pointer()}, {"data-unit", unit.name}});
  html_ += '>';
  const double shown = *number / unit.factor;
  const bool isFixed = unit.decimals >= 0 && std::abs(shown) >= std::pow(10.0, kDigits - 1 - unit.decimals);
  text(isFixed ? fmt::format("{:.{}f}", shown, unit.decimals) : hb::figureText(shown));
  html_ += "</data>";
}

void hbHtmlWriter::quote(const hbReportPlace& place) {
  if (place.text().empty()) return text(kDash);
  startTag("span", {{"data-json", place.pointer()}});
  html_ += '>';
  text(place.text());
  html_ += "</span>";
}

const std::string& hbHtmlWriter::html() const {
  assert(open_.empty());
  return html_;
}

#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

/// A place in a comparison's report: a value, and the pointer (RFC 6901) that leads to it. What is missing is null, so
/// that places below it can be asked for as well. Not installed: it shows nlohmann-json.
class hbReportPlace {
public:
  using Json = nlohmann::ordered_json;

  /// The whole report, which must outlive the place.
  explicit hbReportPlace(const Json& report) : value_(&report) {}

  hbReportPlace operator[](const char* key) const;
  hbReportPlace operator[](std::size_t index) const;

  /// Elements of an array or object; 0 of anything else.
  std::size_t size() const { return value_->is_structured() ? value_->size() : 0; }
  bool null() const { return value_->is_null(); }
  bool truth() const { return *value_ == true; }
  std::optional<double> number() const; ///< None where it is no number.
  std::string text() const;             ///< Empty where it is no string.

  const Json& value() const { return *value_; }
  std::string pointer() const { return pointer_.to_string(); }

private:
  hbReportPlace(const Json* value, Json::json_pointer pointer) : value_(value), pointer_(std::move(pointer)) {}

  const Json* value_;
  Json::json_pointer pointer_;
};

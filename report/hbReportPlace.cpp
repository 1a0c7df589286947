#include "report/hbReportPlace.h"

namespace {

const hbReportPlace::Json kNull;

} // namespace

hbReportPlace hbReportPlace::operator[](const char* key) const {
  const bool has = value_->is_object() && value_->contains(key);
  return {has ? &value_->at(key) : &kNull, pointer_ / std::string(key)};
}

hbReportPlace hbReportPlace::operator[](std::size_t index) const {
  const bool has = value_->is_array() && index < value_->size();
  return {has ? &value_->at(index) : &kNull, pointer_ / index};
}

std::optional<double> hbReportPlace::number() const {
  return value_->is_number() ? std::optional(value_->get<double>()) : std::nullopt;
}

std::string hbReportPlace::text() const { return value_->is_string() ? value_->get<std::string>() : std::string(); }

#pragma once

/// A closed interval of values, lo <= hi.
struct hbRange {
  float lo = 0.0F;
  float hi = 0.0F;

  bool contains(float value) const { return lo <= value && value <= hi; }
  bool operator==(const hbRange&) const = default;
};

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "volume/hbContainerFormat.h"

/// The least and the greatest value of each component of one step of a dataset: the chunk RNGE.
struct hbRangeRecord {
  static constexpr hbChunkType kType{"RNGE"};
  static constexpr hbChunkKind kKind = hbChunkKind::ancillary;

  /// Of the source data values (slope and intercept applied), NaN left out; lo <= hi, or both NaN where nothing is
  /// left.
  struct Component {
    double lo = 0.0;
    double hi = 0.0;
    bool operator==(const Component&) const = default;
  };

  std::vector<Component> components;

  /// Throws hbError, beginning with `what`, unless lo <= hi or both are NaN.
  void validate(const std::string& what) const;

  /// The payload of the chunk. Throws as validate() does.
  std::vector<std::byte> encode() const;

  /// Throws hbError, beginning with `what`, for bytes that are not a valid payload, whole and nothing else.
  static hbRangeRecord decode(std::span<const std::byte> bytes, const std::string& what);

  bool operator==(const hbRangeRecord&) const = default;
};

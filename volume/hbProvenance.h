#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "volume/hbContainerFormat.h"

/// Where a file comes from, as JSON for people and programs to show: the chunk PROV. No reader depends on it.
struct hbProvenance {
  static constexpr hbChunkType kType{"PROV"};
  static constexpr hbChunkKind kKind = hbChunkKind::ancillary;
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 20U;

  std::string json = "{}"; ///< UTF-8, at most kMaxBytes.

  /// Throws hbError, beginning with `what`, for a text that is too long or not JSON.
  void validate(const std::string& what) const;

  /// The payload of the chunk: the text alone. Throws as validate() does.
  std::vector<std::byte> encode() const;

  /// Throws hbError, beginning with `what`, as validate() does.
  static hbProvenance decode(std::span<const std::byte> bytes, const std::string& what);

  bool operator==(const hbProvenance&) const = default;
};

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "volume/hbContainerFormat.h"
#include "volume/hbGeometry.h"
#include "volume/hbLatticeMapping.h"
#include "volume/hbSampleType.h"
#include "volume/hbValueMap.h"

/// What a dataset of an `.hbv` file stands for, whatever its representation: the chunk GEOM, one a dataset, at step 0.
struct hbDatasetInfo {
  static constexpr hbChunkType kType{"GEOM"};
  static constexpr hbChunkKind kKind = hbChunkKind::critical;
  static constexpr std::size_t kMaxNameBytes = 255;
  static constexpr std::size_t kMaxComponents = 65535;

  hbGeometry geometry;                             ///< Of the source samples; `space` up to kMaxNameBytes.
  hbSampleType sampleType = hbSampleType::float32; ///< Of the source.
  double slope = 1.0;                              ///< Source data value = slope * sample + intercept.
  double intercept = 0.0;
  hbValueMap valueMap; ///< From the values of the representation to those of the data.
  hbLatticeMapping mapping = hbLatticeMapping::fitted;
  std::vector<std::string> componentNames{""}; ///< One a component, "" where unknown; up to kMaxNameBytes each.

  std::size_t components() const { return componentNames.size(); }

  /// Throws hbError, beginning with `what`, for an invalid geometry or enumerator, too long names, no or too many
  /// components, a slope that is 0 or not finite, an intercept or offset that is not finite, and a scale that is not
  /// positive and finite.
  void validate(const std::string& what) const;

  /// The payload of the chunk. Throws as validate() does.
  std::vector<std::byte> encode() const;

  /// Throws hbError, beginning with `what`, for bytes that are not a valid payload, whole and nothing else.
  static hbDatasetInfo decode(std::span<const std::byte> bytes, const std::string& what);

  bool operator==(const hbDatasetInfo&) const = default;
};

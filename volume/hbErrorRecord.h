#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "volume/hbContainerFormat.h"

/// How far one step of a dataset lies from its source: the chunk ERRS; its key numbers the records of a step from 0.
///
/// Distances are in the units of the data (after the value map).
struct hbErrorRecord {
  static constexpr hbChunkType kType{"ERRS"};
  static constexpr hbChunkKind kKind = hbChunkKind::ancillary;

  /// What was compared with. The numbers are those of the file.
  enum class Reference : std::uint8_t {
    allSamples = 0,    ///< Every sample of the source.
    randomSamples = 1, ///< Randomly chosen samples of the source.
    analyticField = 2  ///< The analytic field itself, at random points.
  };

  /// How sure it is. The numbers are those of the file.
  enum class Kind : std::uint8_t {
    measured = 0,  ///< Found at the points compared.
    guaranteed = 1 ///< Bounds that hold at every point of the reference; `psnr` is a bound from below.
  };

  struct Component {
    Reference reference = Reference::allSamples;
    Kind kind = Kind::measured;
    std::uint64_t points = 0; ///< Compared.
    double max = 0.0;         ///< Largest absolute difference; NaN where not known.
    double rmse = 0.0;        ///< NaN where not known.
    double psnr = 0.0;        ///< dB, the value range as peak: infinite for equals. NaN where not known.
    bool operator==(const Component&) const = default;
  };

  std::vector<Component> components;

  /// Throws hbError, beginning with `what`, for unknown enumerators and negative errors.
  void validate(const std::string& what) const;

  /// The payload of the chunk. Throws as validate() does.
  std::vector<std::byte> encode() const;

  /// Throws hbError, beginning with `what`, for bytes that are not a valid payload, whole and nothing else.
  static hbErrorRecord decode(std::span<const std::byte> bytes, const std::string& what);

  bool operator==(const hbErrorRecord&) const = default;
};

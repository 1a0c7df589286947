#pragma once

/// How the 32-bit values that hbvol computes with stand for the values of the data: `true = offset + scale * value`.
///
/// The identity for nearly all data. 32-bit integers beyond 2^24, floats with a large common offset, and what is beyond
/// the range of a float, are centred and scaled in 64 bits first, so that a float still tells neighbouring values apart
/// and sums of them do not spend their bits on the offset.
struct hbValueMap {
  double offset = 0.0;
  double scale = 1.0; ///< Positive.

  double toTrue(double value) const { return offset + scale * value; }
  double fromTrue(double trueValue) const { return (trueValue - offset) / scale; }
  bool isIdentity() const { return offset == 0.0 && scale == 1.0; }
  bool operator==(const hbValueMap&) const = default;
};

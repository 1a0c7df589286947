// Uses hbvol::volume alone: the middle of a 2 x 2 x 2 volume, the mean of its samples.

#include <cstdio>
#include <vector>

#include "volume/hbVolumeField.h"

int main() {
  hbGeometry geometry;
  geometry.size = {2, 2, 2};
  const hbVolumeField field(hbVolume::fromSamples(geometry, std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7}));
  const float middle = 0.5F;
  float value = 0.0F;
  field.values({{&middle, 1}, {&middle, 1}, {&middle, 1}}, 0, {&value, 1});
  std::printf("%g\n", double(value));
}

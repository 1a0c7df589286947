#include "volume/hbByteWriter.h"

// Not inline: GCC 12 would unroll chains of small insertions and warn of overflows that cannot happen.
void hbByteWriter::bytes(std::span<const std::byte> values) {
  bytes_.insert(bytes_.end(), values.begin(), values.end());
}

void hbByteWriter::zeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }

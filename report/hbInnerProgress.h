#pragma once

#include "volume/hbProgress.h"

/// The progress of a part of larger work: shows nothing, and is cancelled when the whole is.
class hbInnerProgress final : public hbProgress {
public:
  explicit hbInnerProgress(const hbProgress& whole) : whole_(whole) {}

protected:
  void show(std::int64_t, std::int64_t) override {
    if (whole_.cancelled()) cancel();
  }

private:
  const hbProgress& whole_;
};

#include "volume/hbProgress.h"

#include "volume/hbError.h"

void hbProgress::advance(std::int64_t units) {
  if (cancelled_) throw hbCancelled();
  show(done_ += units, total_);
}

hbProgress& hbProgress::none() {
  static hbProgress silent;
  return silent;
}

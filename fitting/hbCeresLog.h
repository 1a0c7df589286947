#pragma once

#include <glog/logging.h>

namespace hb {

/// Ceres' own setting does not keep glog from writing warnings to stderr.
inline void silenceCeres() { FLAGS_minloglevel = google::GLOG_FATAL; }

} // namespace hb

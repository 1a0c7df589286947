#pragma once

#include <cstdint>
#include <functional>

namespace hb {

/// Calls body(i) once for every i from 0 to count-1, on all threads TBB may use, in no particular order; returns when
/// all are done. What a body throws is thrown here, once the bodies that run have ended; the rest is not begun.
///
/// One task an index at the finest, so a body should take microseconds at least. The one place where hbvol starts
/// tasks: ThreadSanitizer cannot see into Debian's TBB, so this tells it what waits for what.
void parallelFor(std::int64_t count, const std::function<void(std::int64_t)>& body);

/// How many threads parallelFor() may use here.
int parallelThreads();

} // namespace hb

// Compiled without ThreadSanitizer, see CMakeLists.txt: TBB's headers hand tasks over through code in libtbb that is
// not instrumented, which the sanitizer takes for races. The bodies are instrumented where they are written.

#include "volume/hbParallel.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#ifdef HBVOL_TELL_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace {

/// What TBB guarantees, told to ThreadSanitizer: all that came before the loop happens before every body, and every
/// body before all that comes after the loop; nothing is said between two bodies. Two addresses, two such relations.
struct Order {
#ifdef HBVOL_TELL_THREAD_SANITIZER
  static void before(char& event) { __tsan_release(&event); }
  static void after(char& event) { __tsan_acquire(&event); }
#else
  static void before(char&) {}
  static void after(char&) {}
#endif
};

struct Loop {
  char started = 0, ended = 0;
  Loop() { Order::before(started); }
  ~Loop() { Order::after(ended); }
};

struct Body {
  Loop& loop;
  explicit Body(Loop& whole) : loop(whole) { Order::after(loop.started); }
  ~Body() { Order::before(loop.ended); }
};

} // namespace

void hb::parallelFor(std::int64_t count, const std::function<void(std::int64_t)>& body) {
  Loop loop;
  tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t i) {
    const Body running(loop);
    body(i);
  });
}

int hb::parallelThreads() { return oneapi::tbb::this_task_arena::max_concurrency(); }

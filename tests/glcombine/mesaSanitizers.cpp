// What the sanitizers leave out of Mesa, which is not built with them: the small buffer that it keeps of every OSMesa
// context there ever was, and its own threads' locks, whose order the thread sanitizer sees only half of. Calls of
// hbvol's are not in the lists.

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }

// Nor do they say so on stderr, which the program's tests read.
extern "C" const char* __lsan_default_options();
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }
extern "C" const char* __tsan_default_options();
extern "C" const char* __tsan_default_options() { return "print_suppressions=0"; }

extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() { return "race:libOSMesa.so\nrace:swrast_dri.so\n"; }

// Leaks are looked for at the end of the process, when Mesa's threads (rasterisers, the cache of shaders) may be
// ending, too, on which LeakSanitizer then stumbles. So sanitized, Mesa has none.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#include <cstdlib>

namespace {
[[maybe_unused]] const bool kHasNoThreads = [] {
  return ::setenv("LP_NUM_THREADS", "0", 0) == 0 && ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 0) == 0;
}();
} // namespace
#endif

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

// Leaks are looked for at the end of the process. LeakSanitizer stumbles over a thread that is ending just then
// ("Tracer caught signal 11"): one of Mesa's (rasterisers, the cache of shaders) or one of TBB's, which are told to
// end, but not waited for. So sanitized, Mesa has none, and TBB's have ended before. In processes that have Mesa in
// them it stumbles all the same, on a loaded machine some 1 time in 100, so there it does not look at all.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#include <cstdlib>
#include <cstring>
#include <new>

#include <link.h>

#include <oneapi/tbb/global_control.h>

namespace {

class OneThreadAtTheEnd {
public:
  OneThreadAtTheEnd() {
    ::setenv("LP_NUM_THREADS", "0", 0);
    ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
  }
  ~OneThreadAtTheEnd() { oneapi::tbb::finalize(threads_, std::nothrow); }
  OneThreadAtTheEnd(const OneThreadAtTheEnd&) = delete;
  OneThreadAtTheEnd& operator=(const OneThreadAtTheEnd&) = delete;

private:
  oneapi::tbb::task_scheduler_handle threads_{oneapi::tbb::attach{}};
};

OneThreadAtTheEnd atTheEnd;

int isMesa(dl_phdr_info* library, std::size_t, void*) {
  for (const char* part : {"libOSMesa", "libEGL", "libglapi", "libLLVM", "_dri.so"})
    if (std::strstr(library->dlpi_name, part) != nullptr) return 1;
  return 0;
}

} // namespace

extern "C" int __lsan_is_turned_off();
extern "C" int __lsan_is_turned_off() { return ::dl_iterate_phdr(isMesa, nullptr); }
#endif

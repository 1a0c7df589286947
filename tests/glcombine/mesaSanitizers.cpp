// What the sanitizers leave out of Mesa, which is not built with them: the small buffer that it keeps of every OSMesa
// context there ever was, and its own threads' locks, whose order the thread sanitizer sees only half of. Calls of
// hbvol's are not in the lists.

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }

extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() { return "race:libOSMesa.so\nrace:swrast_dri.so\n"; }

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

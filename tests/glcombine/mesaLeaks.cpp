// What the address sanitizer's leak check leaves out: Mesa keeps a small buffer of every OSMesa context that ever was.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }

// OSMesa loses the buffer that a context was made current with: some 280 bytes each time, in a C
// program of four calls as well. Nothing of ours is allocated under one of its functions.

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }

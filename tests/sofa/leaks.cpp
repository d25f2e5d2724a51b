// What SOFA 25.12 allocates once per process and never frees; LeakSanitizer asks for this list.
#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions()
{
    return "leak:computeSofaPathPrefix\nleak:DefaultTaskScheduler\n";
}
#endif

// What SOFA 25.12 never frees: twice once per process, and one byte of each hexahedral force field. LeakSanitizer asks
// for this list.
#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions()
{
    return "leak:computeSofaPathPrefix\nleak:DefaultTaskScheduler\n"
           "leak:HexahedronFEMForceField<*>::HexahedronFEMForceField()\n";
}
#endif

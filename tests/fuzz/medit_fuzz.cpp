#include "filasofia/geometry/medit_reader.h"
#include "fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia::geometry;
    fuzzReader(data, size, [](std::string_view bytes) { return parseMedit(bytes, "fuzz.mesh"); });
    return fuzzReader(data, size, [](std::string_view bytes) { return parseMeditSurface(bytes, "fuzz.mesh"); });
}

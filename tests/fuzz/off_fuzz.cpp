#include "filasofia/geometry/off_reader.h"
#include "fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia::geometry;
    return fuzzReader(data, size, [](std::string_view bytes) { return parseOff(bytes, "fuzz.off"); });
}

#include "filasofia/geometry/vtk_reader.h"
#include "fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia::geometry;
    fuzzReader(data, size, [](std::string_view bytes) { return parseVtkSurface(bytes, "fuzz.vtk"); });
    return fuzzReader(data, size, [](std::string_view bytes) { return parseVtk(bytes, "fuzz.vtk"); });
}

#include "filasofia/geometry/vtk_reader.h"
#include "fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia::geometry;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    if (bytes.find("POLYDATA") != std::string_view::npos)
        return fuzzReader(data, size, [](std::string_view all) { return parseVtkSurface(all, "fuzz.vtk"); });
    return fuzzReader(data, size, [](std::string_view all) { return parseVtk(all, "fuzz.vtk"); });
}

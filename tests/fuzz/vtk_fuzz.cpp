#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/vtk_reader.h"

#include <cstddef>
#include <cstdint>

// For any bytes the reader must return a mesh that passes check(), or throw an Error. If check() throws a second Error,
// the run ends.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    setLogSink([](LogLevel, std::string_view) {});
    geometry::TetMesh mesh;
    try {
        mesh = geometry::parseVtk({reinterpret_cast<const char*>(data), size}, "fuzz.vtk");
    } catch (const Error&) {
        return 0;
    }
    check(mesh, "what was read");
    return 0;
}

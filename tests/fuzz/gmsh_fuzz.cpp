#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/gmsh_reader.h"

#include <cstddef>
#include <cstdint>

// Whatever the bytes, the reader gives a mesh that check() takes, or an Error: a second Error, thrown from check(),
// ends the run.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    setLogSink([](LogLevel, std::string_view) {});
    geometry::TetMesh mesh;
    try {
        mesh = geometry::parseGmsh({reinterpret_cast<const char*>(data), size}, "fuzz.msh");
    } catch (const Error&) {
        return 0;
    }
    check(mesh, "what was read");
    return 0;
}

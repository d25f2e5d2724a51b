#include "filasofia/core/error.h"
#include "filasofia/geometry/ply_walk.h"

#include <cstddef>
#include <cstdint>

// Our own checks of a PLY file before assimp reads it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        filasofia::geometry::walkPly({reinterpret_cast<const char*>(data), size}, "fuzz.ply");
    } catch (const filasofia::Error&) {
    }
    return 0;
}

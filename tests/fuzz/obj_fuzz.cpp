#include "filasofia/core/error.h"
#include "filasofia/geometry/obj_text.h"

#include <cstddef>
#include <cstdint>

// Our own checks of an OBJ file before assimp reads it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        (void)filasofia::geometry::checkedObj({reinterpret_cast<const char*>(data), size}, "fuzz.obj");
    } catch (const filasofia::Error&) {
    }
    return 0;
}

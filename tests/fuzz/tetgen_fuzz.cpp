#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/tetgen_reader.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

// The two files are in one input, separated by a '|'.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    setLogSink([](LogLevel, std::string_view) {});
    const std::string_view both{reinterpret_cast<const char*>(data), size};
    const std::size_t cut = std::min(both.find('|'), size);
    geometry::TetMesh mesh;
    try {
        mesh = geometry::parseTetGen({both.substr(0, cut), "fuzz.node"},
                                     {both.substr(std::min(cut + 1, size)), "fuzz.ele"});
    } catch (const Error&) {
        return 0;
    }
    check(mesh, "what was read");
    return 0;
}

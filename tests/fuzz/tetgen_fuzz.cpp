#include "filasofia/geometry/tetgen_reader.h"
#include "fuzz_reader.h"

#include <algorithm>

// The two files are in one input, separated by a '|'.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia::geometry;
    return fuzzReader(data, size, [](std::string_view both) {
        const std::size_t cut = std::min(both.find('|'), both.size());
        return parseTetGen({both.substr(0, cut), "fuzz.node"},
                           {both.substr(std::min(cut + 1, both.size())), "fuzz.ele"});
    });
}

#include "filasofia/core/error.h"
#include "filasofia/metric/catalog.h"
#include "filasofia/metric/session_file.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>

// Whatever the bytes, the reader gives a session or an Error, and of a session every measure is a finite number or
// absent with a reason.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
    metric::Session session;
    try {
        session = metric::readSession(stream, "fuzz.jsonl");
    } catch (const Error&) {
        return 0;
    }
    for (const metric::Value& value : metric::measure(session))
        if (value.value ? !std::isfinite(*value.value) : value.reason.empty()) std::abort();
    return 0;
}

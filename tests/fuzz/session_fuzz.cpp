#include "filasofia/core/error.h"
#include "filasofia/metric/catalog.h"
#include "filasofia/metric/session_file.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>

// For any bytes the reader must return a session or throw an Error, and every measure of a session must be a finite
// number or absent with a reason.
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

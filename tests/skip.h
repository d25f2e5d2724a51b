#pragma once

#include <catch2/catch.hpp>

#include <string>

namespace filasofia {

/// Reports that a test case cannot run here, if `missing`. ctest then shows the test as skipped: it looks for this word
/// (cmake/FilasofiaRoom.cmake), because Catch2 version 2 has no SKIP. Call it before the first CHECK, as a skipped test
/// cannot fail.
///     if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
inline bool skipIf(bool missing, const std::string& why)
{
    if (missing) WARN("SKIPPED: " + why);
    return missing;
}

} // namespace filasofia

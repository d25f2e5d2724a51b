#pragma once

#include "filasofia/testing/fuzz_laws.h"

#include <nlohmann/json_fwd.hpp>

namespace filasofia::app {

/// Every figure of a fuzz of laws, without what was asked for.
nlohmann::json lawsToJson(const testing::LawFuzzReport& report);

void printLaws(const testing::LawFuzzReport& report);

} // namespace filasofia::app

#pragma once

#include "bench/peers/compare.h"

#include <nlohmann/json_fwd.hpp>

namespace filasofia::peers {

/// Prints the heading; call it once.
void printHeading();
void print(const Cell& cell);
/// Prints the rest shapes in one table.
void print(const std::vector<RestCell>& rests);

nlohmann::json toJson(const std::vector<Cell>& cells, const std::vector<RestCell>& rests, int steps);

} // namespace filasofia::peers

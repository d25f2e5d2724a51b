#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace filasofia::app {

/// The number of letters that must be inserted, removed, replaced or swapped with a neighbour to turn one word into the
/// other.
int editDistance(std::string_view a, std::string_view b);

/// " (did you mean 'run'?)" with the known word nearest to `word`; empty if none is near.
std::string didYouMean(std::string_view word, const std::vector<std::string>& known);

} // namespace filasofia::app

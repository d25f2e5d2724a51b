#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace filasofia {

/// The number of letters that must be inserted, removed, replaced or swapped with a neighbour to turn one word into the
/// other.
int editDistance(std::string_view a, std::string_view b);

/// " (did you mean 'run'?)" for the known word nearest to `word`, or that of the same meaning (totalMass: mass);
/// nothing if there is none.
std::string didYouMean(std::string_view word, const std::vector<std::string>& known);

/// The same for a field that does not exist; if no known one is near, " (it has ...)" with all, if these are at
/// most 12.
std::string didYouMeanOneOf(std::string_view word, const std::vector<std::string>& known);

} // namespace filasofia

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace filasofia::peers {

struct Options {
    std::vector<int> tets = {756, 1492, 3004, 10000};
    std::vector<double> dt = {5e-3, 1e-3}; ///< [s]
    int steps = 200;
    std::string json = {}; ///< output file; empty for none
};

/// The checked options; empty if the user asked for help, which is printed. Throws an Error of one line.
std::optional<Options> readOptions(int argc, char** argv);

} // namespace filasofia::peers

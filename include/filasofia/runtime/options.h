#pragma once

#include "filasofia/runtime/simulation.h"

#include <string>
#include <vector>

/// The command line of a simulator that has options of its own.
namespace filasofia::runtime {

/// An option of a program's own, with a value.
struct OwnOption {
    std::string name = {};                 ///< "--case"
    std::string* value = nullptr;          ///< what it sets; stays as it is where the option is not given
    std::string meaning = {};              ///< for --help
    std::vector<std::string> choices = {}; ///< it must be one of these; none: it may be anything
};

/// Takes a program's own options off its command line and returns the rest, the program's name first, for run(). Both
/// "--case small" and "--case=small" are read. Throws an Error "<program>: --case must be small or medium, got 'huge'"
/// where a value is missing, given twice, or none of the choices.
std::vector<std::string> takeOptions(const std::string& program, int argc, const char* const* argv,
                                     const std::vector<OwnOption>& options);

/// What --help says of them, with what they are where they are not given.
std::string optionHelp(const std::vector<OwnOption>& options);

/// Simulation::run for a command line that was put together. Its --help leaves out what the program has of its own.
int run(Simulation& simulation, const std::vector<std::string>& words, const std::vector<OwnOption>& own = {});

} // namespace filasofia::runtime

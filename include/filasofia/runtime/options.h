#pragma once

#include "filasofia/runtime/simulation.h"

#include <string>
#include <vector>

/// The command line of a simulator that has options of its own.
namespace filasofia::runtime {

/// An option of the program, with a value.
struct OwnOption {
    std::string name = {};                 ///< "--case"
    std::string* value = nullptr;          ///< where its value goes; unchanged if the option is not given
    std::string meaning = {};              ///< for --help
    std::vector<std::string> choices = {}; ///< the value must be one of these; empty: any value
    std::string fileType = {};             ///< ".json": names of such files are choices, too
};

/// Takes a program's own options off its command line and returns the rest, beginning with the program's name, for
/// run(). Reads both "--case small" and "--case=small". Throws an Error "<program>: --case must be small or medium, got
/// 'huge'" if a value is missing, given twice, or not one of the choices.
std::vector<std::string> takeOptions(const std::string& program, int argc, const char* const* argv,
                                     const std::vector<OwnOption>& options);

/// The lines of --help for these options, with their defaults.
std::string optionHelp(const std::vector<OwnOption>& options);

/// Simulation::run for a command line in parts. Its --help leaves out the options that the program has of its own.
int run(Simulation& simulation, const std::vector<std::string>& words, const std::vector<OwnOption>& own = {});

} // namespace filasofia::runtime

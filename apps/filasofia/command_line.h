#pragma once

#include "apps/filasofia/commands.h"

namespace filasofia::app {

constexpr int kFailed = 1;  ///< exit code: the program itself failed
constexpr int kRefused = 2; ///< exit code: the user's words or files were invalid

/// Parses the words, runs the command they name and returns the exit code. Any failure is reported as one line on
/// standard error.
int runCommandLine(int argc, char** argv, const std::vector<Command>& commands);

} // namespace filasofia::app

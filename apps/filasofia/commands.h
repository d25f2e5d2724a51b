#pragma once

#include <functional>

namespace CLI {
class App;
}

/// The words of the command line. Each has its own file; main.cpp lists them.
namespace filasofia::app {

/// What a command does once its words are understood; returns the program's exit code.
using Action = std::function<int()>;

/// Adds a command and its options to the command line; sets `chosen` when the user asks for it.
using AddCommand = void (*)(CLI::App& app, Action& chosen);

void addDoctor(CLI::App& app, Action& chosen); ///< `filasofia doctor`: what this machine can do for the simulation

} // namespace filasofia::app

#pragma once

#include "filasofia/core/word.h"

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The words of the command line. Each command has its own file; main.cpp lists them.
namespace filasofia::app {

/// What an option is written to. A flag is a bool; all keep their value, the default, when not given.
using OptionTarget = std::variant<bool*, int*, double*, std::string*>;

/// One word or option a command understands.
struct Option {
    std::string name;                      ///< "--steps" (or "-n,--steps"); without dashes it is a word in its place
    OptionTarget target = {};              ///< must outlive the command line
    std::string meaning = {};              ///< for the help
    std::string type = {};                 ///< "N", "FILE", for the help; empty: chosen by the target
    std::vector<std::string> choices = {}; ///< the only legal values; empty: any
    bool required = false;
    Bound bound = {};          ///< of a number
    std::string standard = {}; ///< the default as the help shows it; empty: the target's value
};

/// One command: `filasofia <name>`.
struct Command {
    std::string name;
    std::string meaning = {};
    std::vector<Option> options = {};
    std::function<int()> run = {}; ///< called once its words are understood; returns the exit code
    std::string footer = {};       ///< after the options in the help
};

Command runCommand();    ///< a scene in a window, or headless
Command replayCommand(); ///< makes a recorded run again
Command benchCommand();  ///< tables and JSON
Command reportCommand(); ///< what an instructor reads of a session
Command fuzzCommand();   ///< does things at random and checks everything after each
Command doctorCommand(); ///< what this machine can do for the simulation, and what is missing

/// What --threads N may be; 0 leaves the choice to the engine.
inline constexpr Bound kThreads = {closed(0, 256), "-"};
/// What --threads N asks for.
inline std::optional<int> givenThreads(int threads) { return threads == 0 ? std::nullopt : std::optional(threads); }

} // namespace filasofia::app

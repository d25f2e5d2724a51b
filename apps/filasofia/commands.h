#pragma once

#include "filasofia/core/word.h"

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The commands of the command line. Each command has its own file; main.cpp lists them.
namespace filasofia::app {

/// The target of an option. A flag is a bool. If an option is not given, its target keeps its value, the default.
using OptionTarget = std::variant<bool*, int*, double*, std::string*>;

/// One positional word or option of a command.
struct Option {
    std::string name;                      ///< "--steps" (or "-n,--steps"); a name without dashes is a positional word
    OptionTarget target = {};              ///< must outlive the command line
    std::string meaning = {};              ///< text for the help
    std::string type = {};                 ///< "N", "FILE", for the help; chosen by the target if empty
    std::vector<std::string> choices = {}; ///< the only legal values; any value if empty
    bool required = false;
    Bound bound = {};          ///< legal range, if the target is a number
    std::string standard = {}; ///< the default as the help shows it; the target's value if empty
};

/// One command: `filasofia <name>`.
struct Command {
    std::string name;
    std::string meaning = {};
    std::vector<Option> options = {};
    std::function<int()> run = {}; ///< called after the words have been parsed; returns the exit code
    std::string footer = {};       ///< printed after the options in the help
};

Command runCommand();     ///< runs a scene in a window, or headless
Command replayCommand();  ///< replays a recorded run
Command benchCommand();   ///< measures and writes tables and JSON
Command reportCommand();  ///< writes an instructor's report of a session
Command filmCommand();    ///< films the experts of all trainers
Command fuzzCommand();    ///< makes random cuts and checks everything after each
Command tissuesCommand(); ///< lists the tissue library
Command saveCommand();    ///< writes a recorded run as a scene file
Command meshCommand();    ///< meshes an image of a patient, in Python
Command sceneCommand();   ///< makes a scene file of an image of a patient, in Python
Command schemaCommand();  ///< prints the JSON Schema of scene files
Command doctorCommand();  ///< reports what this machine offers for the simulation, and what is missing

/// Whether Python knows the rest of the words: `filasofia mesh` and `filasofia scene`.
bool isForPython(int argc, char** argv);
/// This process becomes Python's. Returns only with an Error: if there is no Python.
[[noreturn]] void handOverToPython(int argc, char** argv);

/// Legal range of --threads; 0 leaves the choice to the engine.
inline constexpr Bound kThreads = {closed(0, 256), "-"};
/// The number of threads that --threads asks for; empty for 0.
inline std::optional<int> givenThreads(int threads) { return threads == 0 ? std::nullopt : std::optional(threads); }

} // namespace filasofia::app

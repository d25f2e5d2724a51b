#pragma once

#include "filasofia/runtime/simulation.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// What a trainee sees before and after a session. Names are text that somebody typed, of any length.
namespace filasofia::prefab {

/// What was chosen on a start screen.
struct StartChoice {
    std::string trainee = {};
    int caseIndex = 0;  ///< [-], of the cases
    int difficulty = 0; ///< [-], of the difficulties
    int device = 0;     ///< [-], of the devices
    std::uint64_t seed = 1;
};

struct StartScreenDef {
    std::string title = "Filasofia";
    std::vector<std::string> cases = {};                ///< to choose from; none: no choice
    std::vector<std::string> difficulties = {};         ///< the same
    std::vector<std::string> devices = {};              ///< the same
    StartChoice choice = {};                            ///< what stands there at first
    std::function<void(const StartChoice&)> start = {}; ///< on the main thread, when Start is pressed
};

/// Holds the simulation paused until Start is pressed, and is gone then.
class StartScreen {
public:
    StartScreen(runtime::Simulation& simulation, StartScreenDef def); ///< before a run

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

/// A window with nothing but a start screen: what was chosen, or nothing where it was closed. Main thread.
std::optional<StartChoice> askAtStart(StartScreenDef def, const window::WindowDef& window = {});

/// A number on an end screen.
struct ResultLine {
    std::string name = {};
    std::string value = {}; ///< with its unit
};

/// Hidden until show(): the results, and where the session was written.
class EndScreen {
public:
    explicit EndScreen(runtime::Simulation& simulation); ///< before a run
    /// Any thread.
    void show(std::string title, std::vector<ResultLine> results, std::string sessionFile = {});
    /// Its button was pressed; on the main thread. To be set before a run.
    void onClose(std::function<void()> close);
    /// The same for a second button, for another patient at once; not set: there is none.
    void onAgain(std::function<void()> again);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab

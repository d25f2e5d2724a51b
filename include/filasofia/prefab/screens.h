#pragma once

#include "filasofia/runtime/simulation.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// What a trainee sees before and after a session. Names are typed text of any length.
namespace filasofia::prefab {

/// The choices made on a start screen.
struct StartChoice {
    std::string trainee = {};
    int caseIndex = 0;  ///< [-], index of the case
    int difficulty = 0; ///< [-], index of the difficulty
    int device = 0;     ///< [-], index of the device
    std::uint64_t seed = 1;
};

struct StartScreenDef {
    std::string title = "Filasofia";
    std::vector<std::string> cases = {};                ///< to choose from; empty: no choice
    std::vector<std::string> difficulties = {};         ///< the same
    std::vector<std::string> devices = {};              ///< the same
    StartChoice choice = {};                            ///< the initial choice
    std::function<void(const StartChoice&)> start = {}; ///< called on the main thread when Start is pressed
};

/// Keeps the simulation paused until Start is pressed, and then disappears.
class StartScreen {
public:
    StartScreen(runtime::Simulation& simulation, StartScreenDef def); ///< before a run

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

/// Opens a window with only a start screen. Returns the choice, or nothing if the window was closed. Main thread.
std::optional<StartChoice> askAtStart(StartScreenDef def, const window::WindowDef& window = {});

/// A number on an end screen.
struct ResultLine {
    std::string name = {};
    std::string value = {}; ///< with its unit
};

/// The results and the name of the session's file; hidden until show().
class EndScreen {
public:
    explicit EndScreen(runtime::Simulation& simulation); ///< before a run
    /// Any thread.
    void show(std::string title, std::vector<ResultLine> results, std::string sessionFile = {});
    /// The function is called on the main thread when the Close button is pressed. Set it before a run.
    void onClose(std::function<void()> close);
    /// The same for a second button, which asks for the next patient; if it is not set, there is no such button.
    void onAgain(std::function<void()> again);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab

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

/// How a trainee has done in a case so far.
struct CaseHistory {
    std::vector<double> values = {};  ///< what counts of each session, the oldest first: scores, or times [s]
    bool scored = false;              ///< scores, the higher the better; else times, the lower the better
    std::string best = {}, last = {}; ///< as a person reads them; empty: there was none
};

struct StartScreenDef {
    std::string title = "Filasofia";
    std::vector<std::string> cases = {};                ///< to choose from; empty: no choice
    std::vector<std::string> difficulties = {};         ///< the same
    std::vector<std::string> devices = {};              ///< the same
    StartChoice choice = {};                            ///< the initial choice
    std::function<void(const StartChoice&)> start = {}; ///< called on the main thread when Start is pressed
    /// A PNG or JPEG file for each case, drawn above its name, best with 128 x 96 pixels; that of the chosen case is
    /// also behind the screen. Empty: cases are a list.
    std::vector<std::string> pictures = {};
    std::string controls = {}; ///< lines of text: which keys do what
    /// How the trainee of a choice has done in its case; empty: that is not shown. Called on the main thread when the
    /// choice changes.
    std::function<CaseHistory(const StartChoice&)> history = {};
};

/// Keeps the simulation paused until Start is pressed, with the mouse or Enter, and then disappears.
class StartScreen {
public:
    /// Before a run. Throws an Error if a picture cannot be read, has more than 256 pixels per side, or if there is not
    /// one for each case.
    StartScreen(runtime::Simulation& simulation, StartScreenDef def);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

/// Opens a window with only a start screen, by `open` as Simulation::useWindow does. Returns the choice, or nothing if
/// the window was closed. Main thread.
std::optional<StartChoice>
askAtStart(StartScreenDef def, const window::WindowDef& window = {},
           const std::function<std::unique_ptr<window::Window>(const window::WindowDef&)>& open = {});

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
    /// Adds a button that leaves the screen open; the function is called on the main thread. Set it before a run.
    void addButton(std::string name, std::function<void()> pressed);
    /// The trainee's own sessions of this case, this one the last; drawn as a curve if there are two. Any thread.
    void setHistory(CaseHistory history);
    /// A line below the results: where a file was written, what went wrong. Any thread.
    void say(std::string line);
    /// Hides a shown screen, or shows it again. Any thread.
    void setVisible(bool visible);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab

#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/overlays.h"
#include "filasofia/prefab/screens.h"
#include "filasofia/runtime/simulation.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

/// The program around a trainer's sessions: its options, start and end screens, keys, session files, pictures.
namespace filasofia::prefab {

struct TrainerProgram; // what sessions need of their command line

/// What one session is about: from the command line, or from the start screen.
struct Training {
    std::string trainee = {}; ///< text that somebody typed
    int caseIndex = 0;        ///< [-], of the cases
    int difficulty = 0;       ///< [-], of the difficulties
    int seed = 1;             ///< [-], in [0, 999999999]
    std::string motion = {};  ///< one of the trainer's planned motions; empty: a person moves
    bool device = false;      ///< a haptic device is to be held, or its motion file is played
    std::string file = {};    ///< where the session goes: a .jsonl file that is not there yet, or the one asked for
    std::shared_ptr<TrainerProgram> program = {};
};

struct TrainerDef {
    std::string name = "trainer";               ///< of the program: in errors, help and session files
    std::string about = {};                     ///< what one does, in a line, for --help
    std::string hands = {};                     ///< lines for --help: which keys move what
    std::vector<std::string> cases = {};        ///< words without spaces; at least one
    std::vector<std::string> difficulties = {}; ///< the same
    std::vector<std::string> motions = {};      ///< planned ones, the same; may be none
    window::WindowDef window = {};
    /// For --check-seeds: why nobody could treat this patient; empty: somebody could.
    std::function<std::string(int caseIndex, int seed)> problem = {};
};
constexpr auto fields(const TrainerDef*)
{
    using T = TrainerDef;
    return describe("TrainerDef", field("name", &T::name, "of the program"), field("about", &T::about, "for --help"),
                    field("hands", &T::hands, "for --help"), field("cases", &T::cases, "to choose from"),
                    field("difficulties", &T::difficulties, "to choose from"),
                    field("motions", &T::motions, "planned ones"), field("window", &T::window, "of every session"));
}

/// One session in the hands of the trainer. To be made before a run.
class TrainingSession {
public:
    TrainingSession(runtime::Simulation& simulation, const Training& training);

    /// T switches guidance on and off. To be called before run().
    void guide(Guidance& guidance, bool on);
    /// The end, for Task::over: a planned motion ends the run, a person gets the end screen, with what `results` says.
    void over(const std::string& how, const std::function<std::vector<ResultLine>()>& results);
    /// What writes a picture of that name into the folder of --pictures, as HandMove wants it; nothing without one.
    [[nodiscard]] std::function<void()> picture(const std::string& name) const;
    /// Simulation::run with the words of the command line; it ends after as many steps, where --steps does not say and
    /// they are not 0: a planned motion's. Returns the exit code.
    int run(int steps = 0);
    /// --steps was given: a planned motion may not come to its end.
    [[nodiscard]] bool cutShort() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // the simulation's callbacks have it too
};

/// For a main(): reads --case, --difficulty, --seed, --motion, --trainee, --session, --pictures, --check-seeds and what
/// Simulation::run reads, and calls `train` for every session: once headless or with a planned motion; else after each
/// start screen, and for the next seed where the trainee asks for the next patient (R), until one closes the start
/// screen. Returns the exit code: 0, what `train` returned if not 0, or 2 after one line that says what is wrong.
int runTrainer(int argc, const char* const* argv, const TrainerDef& def,
               const std::function<int(const Training&)>& train);

} // namespace filasofia::prefab

#pragma once

#include "filasofia/prefab/trainer.h"
#include "filasofia/runtime/options.h"

#include <string>
#include <vector>

namespace filasofia::prefab {

/// The keys of every trainer, as lines of text.
extern const std::string kTrainerKeys;
/// Seeds are less than this.
inline constexpr int kMaxSeeds = 1'000'000'000;
/// The devices offered by a start screen, with the drivers' names; the first means no device.
extern const std::vector<std::string> kDevices;

inline const std::string& at(const std::vector<std::string>& words, int place)
{
    return words[static_cast<std::size_t>(place)];
}

/// A trainer's command line, and what its start screens have changed of it.
struct TrainerProgram {
    TrainerDef def;
    std::vector<TrainerCase> cases; ///< the trainer's own, then those of files
    std::string newCase;
    std::string caseName, difficulty, motion = "hand", trainee, session, pictures, seed = "1", checkSeeds;
    std::vector<std::string> rest; ///< for Simulation::run
    int device = 0;                ///< index in kDevices, as chosen on the screen
    bool another = false;          ///< the trainee asked for the next patient

    /// Takes the Def, and reads the words. Throws an Error about what is wrong in either, before any window opens.
    TrainerProgram(const TrainerDef& asked, int argc, const char* const* argv);

    [[nodiscard]] bool has(const char* word) const; ///< whether an option for Simulation::run was given
    [[nodiscard]] bool wantsHelp() const;
    [[nodiscard]] bool planned() const;   ///< whether a planned motion moves the tools
    [[nodiscard]] int devices() const;    ///< how many haptic devices hold instruments, or motion files are played
    [[nodiscard]] bool hasWindow() const; ///< whether sessions are seen in a window
    [[nodiscard]] int caseIndex() const;  ///< in `cases`
    [[nodiscard]] const TrainerCase& chosen() const { return cases[static_cast<std::size_t>(caseIndex())]; }
    [[nodiscard]] int difficultyIndex() const;
    [[nodiscard]] int seedNumber() const; ///< that of the case, if it has one
    [[nodiscard]] int help();             ///< prints the help; returns the exit code
    [[nodiscard]] int check() const;      ///< does --check-seeds; returns the exit code
    [[nodiscard]] int writeCase() const;  ///< does --new-case; returns the exit code
    /// The table of results, beside the sessions.
    [[nodiscard]] std::string resultsFile() const;
    /// Asks for trainee, case and seed. Returns false if the window was closed.
    bool ask();

private:
    void parse(int argc, const char* const* argv);
    void findCases();
    void addCase(TrainerCase added);
    [[nodiscard]] std::vector<std::string> caseNames() const;
    [[nodiscard]] std::vector<runtime::OwnOption> options();
    [[nodiscard]] std::string motions() const; ///< "hand, expert, clumsy"
    [[nodiscard]] std::vector<std::string> pictureFiles() const;
};

} // namespace filasofia::prefab

#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/overlays.h"
#include "filasofia/prefab/screens.h"
#include "filasofia/runtime/simulation.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// The program around a trainer's sessions: its options, start and end screens, keys, session files and pictures.
namespace filasofia::prefab {

struct TrainerProgram; // what sessions need of their command line

/// A number of a trainer's rules that a case file may change.
struct TrainerSetting {
    enum class Kind { Number, Whole, Flag };
    std::string name = {};    ///< a word
    std::string meaning = {}; ///< one line
    std::string unit = {};
    Range range = {};
    Kind kind = Kind::Number;
    std::vector<double> usual = {};      ///< without a case file, per difficulty
    std::vector<std::string> cases = {}; ///< the cases that have it; empty: all
};

/// The settings of rules that differ by difficulty: one for each entry of their fields() list.
template <HasFields Rules, class List>
std::vector<TrainerSetting> settingsOf(const List& byDifficulty, const std::vector<std::string>& cases = {})
{
    std::vector<TrainerSetting> out;
    forEachField<Rules>([&](const auto& each) {
        using Value = std::remove_cvref_t<decltype(std::declval<Rules>().*(each.member))>;
        using Kind = TrainerSetting::Kind;
        static_assert(std::is_arithmetic_v<Value>, "rules are numbers and flags");
        constexpr Kind kKind = std::is_same_v<Value, bool> ? Kind::Flag
                               : std::is_integral_v<Value> ? Kind::Whole
                                                           : Kind::Number;
        TrainerSetting& made = out.emplace_back(TrainerSetting{.name = std::string(each.name),
                                                               .meaning = std::string(each.meaning),
                                                               .unit = std::string(each.unit),
                                                               .range = each.range,
                                                               .kind = kKind,
                                                               .cases = cases});
        for (const Rules& rules : byDifficulty) made.usual.push_back(static_cast<double>(rules.*(each.member)));
    });
    return out;
}

/// A case of a trainer: one of its own, or one that a file makes of it.
struct TrainerCase {
    std::string name = {};                       ///< a word
    int base = 0;                                ///< [-], index of the trainer's own case
    std::filesystem::path file = {};             ///< empty: it is that case
    std::string picture = {};                    ///< a file; empty: that of the own case
    std::optional<int> seed = {};                ///< [-] the case has this patient only
    std::map<std::string, double> settings = {}; ///< those that differ, by name; flags are 0 or 1
};

/// The settings of one session, from the command line or the start screen.
struct Training {
    std::string trainee = {}; ///< typed text
    int caseIndex = 0;        ///< [-], index of the trainer's own case
    int difficulty = 0;       ///< [-], index of the difficulty
    int seed = 1;             ///< [-], in [0, 999999999]
    std::string motion = {};  ///< one of the trainer's planned motions; empty: a person moves
    int devices = 0;          ///< [-] haptic devices that are used, or whose motion files are played
    std::string file = {};    ///< the session's .jsonl file: a new one, or the one asked for
    std::shared_ptr<TrainerProgram> program = {};
    TrainerCase chosen = {}; ///< the case, with what its file changes

    /// What sessions call the task: `own` in the trainer's own case, the case's name in that of a file; and the
    /// difficulty.
    [[nodiscard]] std::string task(const std::string& own) const;
    /// The rules of the session: the usual ones of its difficulty, with what the case file changes.
    template <HasFields Rules> [[nodiscard]] Rules rules(Rules usual) const
    {
        forEachField<Rules>([&](const auto& each) {
            using Value = std::remove_cvref_t<decltype(usual.*(each.member))>;
            const auto changed = chosen.settings.find(std::string(each.name));
            if (changed != chosen.settings.end()) usual.*(each.member) = static_cast<Value>(changed->second);
        });
        return usual;
    }
};

struct TrainerDef {
    std::string name = "trainer";               ///< the program's name in errors, help and session files
    std::string about = {};                     ///< one line for --help: what the trainee does
    std::string hands = {};                     ///< lines for --help: which keys move what
    std::vector<std::string> cases = {};        ///< words without spaces; at least one
    std::vector<std::string> difficulties = {}; ///< words without spaces; at least one
    std::vector<std::string> motions = {};      ///< planned motions, words without spaces; may be empty
    /// A picture for each case, for the start screen: a PNG or JPEG file, or an asset by its name (runtime/assets.h);
    /// empty: none.
    std::vector<std::string> pictures = {};
    window::WindowDef window = {};
    /// Opens the windows of start screens and sessions, as Simulation::useWindow does; empty: window::openWindow.
    std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> openWindow = {};
    /// What case files may change; settingsOf() makes them of rules. Two may have the same name if they have no case in
    /// common.
    std::vector<TrainerSetting> settings = {};
    /// Reads a case file: scene::loadCase. Empty: the trainer takes none.
    std::function<TrainerCase(const std::filesystem::path& file, const TrainerDef& def)> readCase = {};
    /// For --check-seeds: why this patient cannot be treated; empty if it can.
    std::function<std::string(int caseIndex, int seed)> problem = {};
};
constexpr auto fields(const TrainerDef*)
{
    using T = TrainerDef;
    return describe(
        "TrainerDef", field("name", &T::name, "the program's name"), field("about", &T::about, "one line for --help"),
        field("hands", &T::hands, "keys, for --help"), field("cases", &T::cases, "to choose from"),
        field("difficulties", &T::difficulties, "to choose from"), field("motions", &T::motions, "planned motions"),
        field("pictures", &T::pictures, "of the cases"), field("window", &T::window, "the window of every session"));
}

/// What is kept of a session for the trainee's learning curve.
struct TrainingResult {
    bool done = false;                ///< the whole task
    double seconds = 0.0;             ///< [s], simulated
    std::optional<double> score = {}; ///< [-], the higher the better; if there is none, the time counts
};

/// One session of a trainer. Construct it before a run.
class TrainingSession {
public:
    TrainingSession(runtime::Simulation& simulation, const Training& training);

    /// Lets the key T switch guidance on and off. Call it before run().
    void guide(Guidance& guidance, bool on);
    /// The tracker that writes the session's file: it is closed when the trainee asks for the report or the replay. It
    /// outlives this. Call it before run().
    void records(MetricTracker& tracker);
    /// Draws the paths of the replay; call it from inside the function given to Simulation::dress().
    void dress(visual::VisualServer& server);
    /// Ends the session, for Task::over: a planned motion ends the run; for a person physics is paused, and the end
    /// screen shows `results`, the trainee's learning curve, and the ways to the report and the replay. `result` goes
    /// into the table NAME_results.csv beside the session's file.
    void over(const std::string& how, const std::function<std::vector<ResultLine>()>& results,
              const TrainingResult& result = {});
    /// A function for HandMove that writes a picture of this name into the folder of --pictures; empty if there is no
    /// such folder.
    [[nodiscard]] std::function<void()> picture(const std::string& name) const;
    /// Simulation::run with the words of the command line. If `steps` is not 0 (the length of a planned motion) and
    /// --steps was not given, the run ends after as many steps. Returns the exit code.
    int run(int steps = 0);
    /// Whether --steps was given, so that a planned motion may not reach its end.
    [[nodiscard]] bool cutShort() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

/// For a main(): reads --case, --difficulty, --seed, --motion, --trainee, --session, --pictures, --check-seeds,
/// --new-case and the options of Simulation::run, and calls `train` for every session. Beside the trainer's own cases
/// there are those of case files: that of --case, and those in the folder cases/NAME of the assets. It is called once
/// if the run is headless or has a planned motion. Otherwise it is called after each start screen, and for the next
/// seed if the trainee asks for the next patient (R), until a start screen is closed. Returns the exit code: 0, what
/// `train` returned if not 0, or 2 after one line that says what is wrong.
int runTrainer(int argc, const char* const* argv, const TrainerDef& def,
               const std::function<int(const Training&)>& train);

} // namespace filasofia::prefab

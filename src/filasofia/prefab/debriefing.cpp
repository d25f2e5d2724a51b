#include "filasofia/prefab/debriefing.h"

#include "filasofia/core/date.h"
#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/metric/session_file.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/prefab/trainer_program.h"
#include "filasofia/prefab/training_results.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace filasofia::prefab {

Debriefing::Debriefing(runtime::Simulation& simulation, EndScreen& end, const Training& training)
    : end_(end), training_(training), replay_(simulation)
{
    end.addButton("Replay (V)", [asked = asked_] { asked->replay = true; });
    end.addButton("Report (P)", [asked = asked_] { asked->report = true; });
}

void Debriefing::begin(const TrainingResult& result)
{
    result_ = result;
    begun_ = true;
}

void Debriefing::press(const event::KeyEvent& key)
{
    if (!begun_) return;
    if (key.key == event::KeyCode::V) asked_->replay = true;
    if (key.key == event::KeyCode::P) asked_->report = true;
}

void Debriefing::follow()
{
    if (!begun_) return;
    if (!std::exchange(kept_, true)) keepResult();
    if (asked_->report.exchange(false)) writeReport();
    if (asked_->replay.exchange(false)) openReplay();
    if (const auto said = report_.poll()) end_.say(*said);
    if (const auto session = expert_.poll()) replay_.setExpert(*session);
    if (const auto news = expert_.news()) replay_.say(*news);
}

void Debriefing::keepResult()
{
    const TrainerProgram& program = *training_.program;
    const std::string &caseName = training_.chosen.name,
                      &difficulty = at(program.def.difficulties, training_.difficulty);
    try {
        appendResult(program.resultsFile(), {dateNow(), training_.trainee, caseName, difficulty, training_.seed,
                                             result_.done, result_.seconds, result_.score, training_.file});
        end_.setHistory(historyOf(readResults(program.resultsFile()), training_.trainee, caseName, difficulty));
    } catch (const Error& problem) {
        end_.say(text("The result is not kept: ", problem.what()));
    }
}

void Debriefing::writeReport()
{
    if (report_.writing()) return;
    if (tracker_ != nullptr) tracker_->close();
    end_.say(report_.write(training_.file));
}

void Debriefing::openReplay()
{
    if (replay_.isOpen()) return;
    if (tracker_ != nullptr) tracker_->close();
    try {
        replay_.setOwn(metric::readSession(training_.file));
        replay_.say(findExpert());
    } catch (const Error& problem) { // without the session there are no paths
        replay_.say(problem.what());
    }
    end_.setVisible(false);
    replay_.open([this] { end_.setVisible(true); });
}

std::string Debriefing::findExpert()
{
    const TrainerDef& def = training_.program->def;
    if (std::ranges::find(def.motions, "expert") == def.motions.end()) return {};
    const std::string& difficulty = at(def.difficulties, training_.difficulty);
    const TrainerCase& chosen = training_.chosen;
    const std::string name = text(def.name, "_", chosen.name, "_", difficulty, "_", training_.seed, ".jsonl");
    const std::filesystem::path file = std::filesystem::path(training_.file).parent_path() / "experts" / name;
    std::error_code none;
    if (!chosen.file.empty() && last_write_time(file, none) < last_write_time(chosen.file, none))
        std::filesystem::remove(file, none); // the expert of another version of the case
    return expert_.find(file.string(), {"--case", chosen.file.empty() ? chosen.name : chosen.file.string(),
                                        "--difficulty", difficulty, "--seed", text(training_.seed), "--motion",
                                        "expert", "--trainee", "expert", "--headless", "--no-picture"});
}

} // namespace filasofia::prefab

#include "filasofia/prefab/trainer_program.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/prefab/training_results.h"
#include "filasofia/runtime/assets.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace filasofia::prefab {
namespace {

int placeOf(const std::vector<std::string>& words, const std::string& word)
{
    return static_cast<int>(std::ranges::find(words, word) - words.begin());
}

void check(const TrainerDef& def)
{
    validate(def, "trainer");
    if (def.cases.empty() || def.difficulties.empty())
        fail("trainer: cases and difficulties must have at least one entry each");
    for (const auto& [words, field] :
         {std::pair{&def.cases, "cases"}, {&def.difficulties, "difficulties"}, {&def.motions, "motions"}})
        for (const std::string& word : *words)
            if (word.empty() || word.find_first_of(" \t\n") != std::string::npos)
                fail("trainer: ", field, " must be words without spaces, got ", shownWord(word));
}

} // namespace

const std::string kTrainerKeys =
    "T switches guidance, Space pauses, R calls the next patient, H shows these keys, Escape ends the session.\n"
    "At the end, V shows the replay, and P writes and opens the report.";
const std::vector<std::string> kDevices = {"mouse and keys", "forcedimension", "openhaptics"};

TrainerProgram::TrainerProgram(const TrainerDef& asked, int argc, const char* const* argv) : def(asked)
{
    prefab::check(def);
    caseName = def.cases.front();
    difficulty = def.difficulties.front();
    parse(argc, argv);
}

std::string TrainerProgram::motions() const
{
    std::string all = "hand";
    for (const std::string& planned : def.motions) all += ", " + planned;
    return all;
}

std::vector<runtime::OwnOption> TrainerProgram::options()
{
    return {{"--case", &caseName, "the case", def.cases},
            {"--difficulty", &difficulty, "the difficulty", def.difficulties},
            {"--seed", &seed, "the number that chooses the patient"},
            {"--motion", &motion, "what moves the tools: " + motions() + ", or a device's motion file"},
            {"--trainee", &trainee, "the trainee's name, for the session"},
            {"--session", &session,
             "a .jsonl file for 'filasofia report'; default: " + def.name + "_CASE_SEED_NUMBER.jsonl"},
            {"--pictures", &pictures, "a folder for pictures of a planned motion"},
            {"--check-seeds", &checkSeeds, "check whether the patients of seeds 1 to N can be treated, and end"}};
}

bool TrainerProgram::has(const char* word) const
{
    return std::ranges::any_of(
        rest, [&](const std::string& each) { return each == word || each.starts_with(text(word, "=")); });
}

bool TrainerProgram::wantsHelp() const { return has("--help") || has("-h"); }
bool TrainerProgram::planned() const { return std::ranges::find(def.motions, motion) != def.motions.end(); }

bool TrainerProgram::hasWindow() const { return !has("--headless") && !has("--no-picture"); }
int TrainerProgram::caseIndex() const { return placeOf(def.cases, caseName); }
int TrainerProgram::difficultyIndex() const { return placeOf(def.difficulties, difficulty); }

int TrainerProgram::seedNumber() const
{
    return wholeNumber(def.name + ": --seed", seed, {closed(0, kMaxSeeds - 1), "-"});
}

void TrainerProgram::parse(int argc, const char* const* argv)
{
    rest = runtime::takeOptions(def.name, argc, argv, options());
    if (wantsHelp()) return;
    static_cast<void>(seedNumber()); // reports errors before any window opens
    if (motion != "hand" && !planned()) {
        std::error_code problem; // a name that is too long is not a file either
        if (!std::filesystem::is_regular_file(motion, problem))
            fail(def.name, ": --motion must be ", motions(), " or a motion file, but there is no file ",
                 shownWord(motion));
        rest.insert(rest.end(), {"--motion", motion});
    }
    if (!pictures.empty() && !std::filesystem::is_directory(pictures))
        fail(def.name, ": --pictures must be a folder, got ", shownWord(pictures));
    if (!pictures.empty() && ::access(pictures.c_str(), W_OK) != 0)
        fail(def.name, ": --pictures: the folder ", shownWord(pictures), " cannot be written to");
}

int TrainerProgram::help()
{
    std::printf("%s\n\n%s\n%s%s\n\nThe other options are common to all simulations:\n\n", def.about.c_str(),
                runtime::optionHelp(options()).c_str(), def.hands.c_str(), kTrainerKeys.c_str());
    std::fflush(stdout);
    runtime::Simulation simulation;
    return runtime::run(simulation, rest, options());
}

int TrainerProgram::check() const
{
    const int count = wholeNumber(def.name + ": --check-seeds", checkSeeds, {closed(1, 1'000'000), "-"});
    int good = 0;
    for (int each = 1; each <= count; ++each) {
        const std::string problem = def.problem ? def.problem(caseIndex(), each) : std::string();
        good += problem.empty();
        if (!problem.empty()) std::printf("seed %d: %s\n", each, problem.c_str());
    }
    std::printf("%d of %d patients can be treated\n", good, count);
    return good == count ? 0 : 1;
}

std::string TrainerProgram::resultsFile() const
{
    return (std::filesystem::path(session).parent_path() / (def.name + "_results.csv")).string();
}

std::vector<std::string> TrainerProgram::pictureFiles() const
{
    std::vector<std::string> files;
    std::error_code none;
    for (const std::string& picture : def.pictures)
        files.push_back(std::filesystem::is_regular_file(picture, none) ? picture : runtime::asset(picture));
    return files;
}

bool TrainerProgram::ask()
{
    const bool choosesDevice = !has("--device") && !has("--motion");
    const auto history = [this, results = readResults(resultsFile())](const StartChoice& choice) {
        return historyOf(results, choice.trainee, at(def.cases, choice.caseIndex),
                         at(def.difficulties, choice.difficulty));
    };
    const auto chosen = askAtStart({.title = def.window.title,
                                    .cases = def.cases,
                                    .difficulties = def.difficulties,
                                    .devices = choosesDevice ? kDevices : std::vector<std::string>{},
                                    .choice = {.trainee = trainee,
                                               .caseIndex = caseIndex(),
                                               .difficulty = difficultyIndex(),
                                               .device = device,
                                               .seed = static_cast<std::uint64_t>(seedNumber())},
                                    .pictures = pictureFiles(),
                                    .controls = def.hands + kTrainerKeys,
                                    .history = history},
                                   def.window, def.openWindow);
    if (!chosen) return false;
    trainee = chosen->trainee;
    caseName = at(def.cases, chosen->caseIndex);
    difficulty = at(def.difficulties, chosen->difficulty);
    device = chosen->device;
    seed = text(chosen->seed % kMaxSeeds);
    return true;
}

} // namespace filasofia::prefab

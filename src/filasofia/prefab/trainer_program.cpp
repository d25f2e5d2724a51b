#include "filasofia/prefab/trainer_program.h"

#include "filasofia/core/error.h"
#include "filasofia/core/listed.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/whole_file.h"
#include "filasofia/core/word.h"
#include "filasofia/prefab/trainer_settings.h"
#include "filasofia/prefab/training_results.h"
#include "filasofia/runtime/assets.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace filasofia::prefab {
namespace {

constexpr const char* kCaseFile = ".json";

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
    for (const TrainerSetting& each : def.settings)
        if (each.usual.size() != def.difficulties.size())
            fail("trainer: setting ", shownWord(each.name), " must have a value for each of the ",
                 def.difficulties.size(), " difficulties, got ", each.usual.size());
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
    findCases();
    parse(argc, argv);
}

void TrainerProgram::findCases()
{
    for (int i = 0; i < static_cast<int>(def.cases.size()); ++i)
        cases.push_back(
            {.name = at(def.cases, i), .base = i, .picture = def.pictures.empty() ? "" : at(def.pictures, i)});
    if (!def.readCase) return;
    for (const std::string& file : runtime::assetsIn("cases/" + def.name, kCaseFile)) addCase(def.readCase(file, def));
}

void TrainerProgram::addCase(TrainerCase added)
{
    if (added.name.find_first_of(" \t\n") != std::string::npos)
        fail(added.file.string(), ": the name of a case file must be a word without spaces");
    const auto known = std::ranges::find(cases, added.name, &TrainerCase::name);
    if (known != cases.end() && known->file.empty())
        fail(added.file.string(), ": a case file must not have the name of the trainer's own case ", added.name);
    if (added.picture.empty()) added.picture = cases[static_cast<std::size_t>(added.base)].picture;
    if (known != cases.end())
        *known = std::move(added);
    else
        cases.push_back(std::move(added));
}

std::vector<std::string> TrainerProgram::caseNames() const
{
    std::vector<std::string> names;
    for (const TrainerCase& each : cases) names.push_back(each.name);
    return names;
}

std::string TrainerProgram::motions() const
{
    std::string all = "hand";
    for (const std::string& planned : def.motions) all += ", " + planned;
    return all;
}

std::vector<runtime::OwnOption> TrainerProgram::options()
{
    return {{"--case", &caseName, "the case", caseNames(), def.readCase ? kCaseFile : ""},
            {"--difficulty", &difficulty, "the difficulty", def.difficulties},
            {"--seed", &seed, "the number that chooses the patient"},
            {"--motion", &motion,
             "what moves the tools: " + motions() + ", or a device's motion file, or several: FILE,FILE"},
            {"--trainee", &trainee, "the trainee's name, for the session"},
            {"--session", &session,
             "a .jsonl file for 'filasofia report'; default: " + def.name + "_CASE_SEED_NUMBER.jsonl"},
            {"--pictures", &pictures, "a folder for pictures of a planned motion"},
            {"--check-seeds", &checkSeeds, "check whether the patients of seeds 1 to N can be treated, and end"},
            {"--new-case", &newCase, "write a case file with all settings of the case and the difficulty, and end"}};
}

bool TrainerProgram::has(const char* word) const
{
    return std::ranges::any_of(
        rest, [&](const std::string& each) { return each == word || each.starts_with(text(word, "=")); });
}

bool TrainerProgram::wantsHelp() const { return has("--help") || has("-h"); }
bool TrainerProgram::planned() const { return std::ranges::find(def.motions, motion) != def.motions.end(); }

int TrainerProgram::devices() const
{
    const auto count = [](std::string_view names) { return static_cast<int>(listed(names).size()); };
    if (device > 0) return count(at(kDevices, device));
    if (motion != "hand") return planned() ? 0 : count(motion);
    std::string_view names;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        constexpr std::string_view kOption = "--device";
        const std::string_view word = rest[i];
        if (word == kOption && i + 1 < rest.size()) names = rest[i + 1];
        if (word.starts_with(text(kOption, "="))) names = word.substr(kOption.size() + 1);
    }
    return count(names);
}

bool TrainerProgram::hasWindow() const { return !has("--headless") && !has("--no-picture"); }
int TrainerProgram::caseIndex() const { return placeOf(caseNames(), caseName); }
int TrainerProgram::difficultyIndex() const { return placeOf(def.difficulties, difficulty); }

int TrainerProgram::seedNumber() const
{
    if (chosen().seed) return *chosen().seed;
    return wholeNumber(def.name + ": --seed", seed, {closed(0, kMaxSeeds - 1), "-"});
}

void TrainerProgram::parse(int argc, const char* const* argv)
{
    rest = runtime::takeOptions(def.name, argc, argv, options());
    if (wantsHelp()) return;
    if (def.readCase && caseName.ends_with(kCaseFile)) {
        TrainerCase read = def.readCase(caseName, def);
        caseName = read.name;
        addCase(std::move(read));
    }
    static_cast<void>(seedNumber()); // reports errors before any window opens
    if (chosen().seed && seed != "1" && seed != text(*chosen().seed))
        fail(def.name, ": --seed must not be given, as the case ", caseName, " has the seed ", *chosen().seed, ", got ",
             shownWord(seed));
    if (!newCase.empty() && !def.readCase) fail(def.name, ": takes no case files");
    if (motion != "hand" && !planned()) {
        std::error_code problem; // a name that is too long is not a file either
        for (const std::string& file : listed(motion))
            if (!std::filesystem::is_regular_file(file, problem))
                fail(def.name, ": --motion must be ", motions(), " or a motion file, but there is no file ",
                     shownWord(file));
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
        const std::string problem = def.problem ? def.problem(chosen().base, each) : std::string();
        good += problem.empty();
        if (!problem.empty()) std::printf("seed %d: %s\n", each, problem.c_str());
    }
    std::printf("%d of %d patients can be treated\n", good, count);
    return good == count ? 0 : 1;
}

int TrainerProgram::writeCase() const
{
    if (!newCase.ends_with(kCaseFile)) fail(def.name, ": --new-case must be a .json file, got ", shownWord(newCase));
    if (std::filesystem::exists(newCase))
        fail(def.name, ": --new-case: there is a file ", shownWord(newCase), " already");
    writeWhole(newCase, caseText(def, chosen(), difficultyIndex()));
    std::printf("%s: written; change it, and begin it with --case %s\n", newCase.c_str(), newCase.c_str());
    return 0;
}

std::string TrainerProgram::resultsFile() const
{
    return (std::filesystem::path(session).parent_path() / (def.name + "_results.csv")).string();
}

std::vector<std::string> TrainerProgram::pictureFiles() const
{
    std::vector<std::string> files;
    std::error_code none;
    if (def.pictures.empty()) return files;
    for (const TrainerCase& each : cases)
        files.push_back(std::filesystem::is_regular_file(each.picture, none) ? each.picture
                                                                             : runtime::asset(each.picture));
    return files;
}

bool TrainerProgram::ask()
{
    const bool choosesDevice = !has("--device") && !has("--motion");
    const auto history = [this, results = readResults(resultsFile())](const StartChoice& choice) {
        return historyOf(results, choice.trainee, cases[static_cast<std::size_t>(choice.caseIndex)].name,
                         at(def.difficulties, choice.difficulty));
    };
    const auto choice = askAtStart({.title = def.window.title,
                                    .cases = caseNames(),
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
    if (!choice) return false;
    trainee = choice->trainee;
    caseName = cases[static_cast<std::size_t>(choice->caseIndex)].name;
    difficulty = at(def.difficulties, choice->difficulty);
    device = choice->device;
    seed = text(choice->seed % kMaxSeeds);
    return true;
}

} // namespace filasofia::prefab

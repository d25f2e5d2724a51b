#include "filasofia/prefab/trainer.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/metric/session_file.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/prefab/plain_window.h"
#include "filasofia/runtime/file_failed_event.h"
#include "filasofia/runtime/options.h"

#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>

namespace filasofia::prefab {
namespace {

const std::string kKeys =
    "T switches guidance, Space pauses, R calls the next patient, H shows these keys, Escape ends the session.";
constexpr int kMaxSeeds = 1'000'000'000;
/// The devices offered by a start screen, with the drivers' names; the first means no device.
const std::vector<std::string> kDevices = {"mouse and keys", "forcedimension", "openhaptics"};

int placeOf(const std::vector<std::string>& words, const std::string& word)
{
    return static_cast<int>(std::ranges::find(words, word) - words.begin());
}
const std::string& at(const std::vector<std::string>& words, int place)
{
    return words[static_cast<std::size_t>(place)];
}

/// Whether the session recorded nothing.
bool isEmptySession(const std::string& file)
{
    try {
        const metric::Session session = metric::readSession(file);
        return session.events.empty() &&
               std::ranges::all_of(session.tracks, [](const metric::Track& track) { return track.samples.empty(); });
    } catch (const Error&) {
        return false; // not a readable session, so it is kept
    }
}

/// If a session is refused before it begins, removes the file that was made for it, unless the user named it.
int trainOnce(const std::function<int(const Training&)>& train, const Training& training, bool ownName)
{
    constexpr int kRefused = 2;
    int code = kRefused;
    try {
        code = train(training);
    } catch (const Error& error) {
        runtime::report(error);
    }
    std::error_code none;
    if (code == kRefused && ownName && isEmptySession(training.file)) std::filesystem::remove(training.file, none);
    return code;
}

} // namespace

struct TrainerProgram {
    TrainerDef def;
    std::string caseName, difficulty, motion = "hand", trainee, session, pictures, seed = "1", checkSeeds;
    std::vector<std::string> rest; ///< for Simulation::run
    int device = 0;                ///< index in kDevices, as chosen on the screen
    bool another = false;          ///< the trainee asked for the next patient

    /// "hand, expert, clumsy".
    [[nodiscard]] std::string motions() const
    {
        std::string all = "hand";
        for (const std::string& planned : def.motions) all += ", " + planned;
        return all;
    }
    [[nodiscard]] std::vector<runtime::OwnOption> options()
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
    [[nodiscard]] bool has(const char* word) const
    {
        return std::ranges::any_of(
            rest, [&](const std::string& each) { return each == word || each.starts_with(text(word, "=")); });
    }
    [[nodiscard]] bool wantsHelp() const { return has("--help") || has("-h"); }
    [[nodiscard]] bool planned() const { return std::ranges::find(def.motions, motion) != def.motions.end(); }
    [[nodiscard]] int seedNumber() const
    {
        return wholeNumber(def.name + ": --seed", seed, {closed(0, kMaxSeeds - 1), "-"});
    }

    void parse(int argc, const char* const* argv)
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

    [[nodiscard]] int help()
    {
        std::printf("%s\n\n%s\n%s%s\n\nThe other options are common to all simulations:\n\n", def.about.c_str(),
                    runtime::optionHelp(options()).c_str(), def.hands.c_str(), kKeys.c_str());
        std::fflush(stdout);
        runtime::Simulation simulation;
        return runtime::run(simulation, rest, options());
    }

    [[nodiscard]] int check() const
    {
        const int count = wholeNumber(def.name + ": --check-seeds", checkSeeds, {closed(1, 1'000'000), "-"});
        int good = 0;
        for (int each = 1; each <= count; ++each) {
            const std::string problem = def.problem ? def.problem(placeOf(def.cases, caseName), each) : std::string();
            good += problem.empty();
            if (!problem.empty()) std::printf("seed %d: %s\n", each, problem.c_str());
        }
        std::printf("%d of %d patients can be treated\n", good, count);
        return good == count ? 0 : 1;
    }

    /// Asks for trainee, case and seed. Returns false if the window was closed.
    bool ask()
    {
        const bool choosesDevice = !has("--device") && !has("--motion");
        const auto chosen = askAtStart({.title = def.window.title,
                                        .cases = def.cases,
                                        .difficulties = def.difficulties,
                                        .devices = choosesDevice ? kDevices : std::vector<std::string>{},
                                        .choice = {.trainee = trainee,
                                                   .caseIndex = placeOf(def.cases, caseName),
                                                   .difficulty = placeOf(def.difficulties, difficulty),
                                                   .device = device,
                                                   .seed = static_cast<std::uint64_t>(seedNumber())}},
                                       def.window);
        if (!chosen) return false;
        trainee = chosen->trainee;
        caseName = at(def.cases, chosen->caseIndex);
        difficulty = at(def.difficulties, chosen->difficulty);
        device = chosen->device;
        seed = text(chosen->seed % kMaxSeeds);
        return true;
    }
};

struct TrainingSession::Impl {
    Impl(runtime::Simulation& sim, const Training& asked)
        : simulation(sim), training(asked), program(*asked.program), end(sim)
    {
    }

    void press(const event::KeyEvent& key)
    {
        using event::KeyCode;
        if (!key.pressed || key.repeat) return;
        if (key.key == KeyCode::T && guidance != nullptr) guidance->setOn(guided = !guided);
        if (key.key == KeyCode::Space) simulation.pause(!simulation.paused());
        if (key.key == KeyCode::R) next();
        if (key.key == KeyCode::H) keysShown = !keysShown;
        if (key.key == KeyCode::Escape) simulation.finish("ended");
    }
    void drawKeys() const
    {
        if (!keysShown) return;
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({screen.x - 12.0F, 12.0F}, ImGuiCond_Always, {1.0F, 0.0F});
        if (ImGui::Begin("keys", nullptr, kPlain)) {
            ImGui::PushTextWrapPos(0.6F * screen.x);
            ImGui::TextUnformatted((program.def.hands + kKeys).c_str());
            ImGui::PopTextWrapPos();
        }
        ImGui::End();
    }
    void next()
    {
        program.another = true;
        simulation.finish("next patient");
    }

    runtime::Simulation& simulation;
    const Training training;
    TrainerProgram& program;
    EndScreen end;
    Guidance* guidance = nullptr;
    bool guided = false; // used by the thread that delivers events
    std::atomic<bool> unwritten = false, keysShown = false;
};

TrainingSession::TrainingSession(runtime::Simulation& simulation, const Training& training)
    : impl_(std::make_shared<Impl>(simulation, training))
{
    const auto weak = std::weak_ptr(impl_);
    impl_->end.onClose([&simulation] { simulation.finish("closed"); });
    impl_->end.onAgain([weak] {
        if (const auto impl = weak.lock()) impl->next();
    });
    simulation.on<event::KeyEvent>([weak](const event::KeyEvent& key) {
        if (const auto impl = weak.lock()) impl->press(key);
    });
    simulation.show(visual::GuiDef{.name = "keys", .renderCallback = [weak] {
                                       if (const auto impl = weak.lock()) impl->drawKeys();
                                   }});
    simulation.on<runtime::FileFailedEvent>([weak](const runtime::FileFailedEvent&) {
        if (const auto impl = weak.lock()) impl->unwritten = true;
    });
}

void TrainingSession::guide(Guidance& guidance, bool on)
{
    impl_->guidance = &guidance;
    guidance.setOn(impl_->guided = on);
}

void TrainingSession::over(const std::string& how, const std::function<std::vector<ResultLine>()>& results)
{
    if (!impl_->training.motion.empty()) return impl_->simulation.finish(how);
    std::vector<ResultLine> lines = {{"Trainee", impl_->training.trainee}};
    for (ResultLine& line : results()) lines.push_back(std::move(line));
    if (impl_->unwritten)
        lines.push_back({"Session", "incomplete: a file could not be written"});
    else
        lines.push_back({"Report", text("filasofia report ", impl_->training.file)});
    impl_->end.show(how, std::move(lines), impl_->training.file);
}

std::function<void()> TrainingSession::picture(const std::string& name) const
{
    if (impl_->program.pictures.empty()) return {};
    return [&simulation = impl_->simulation, file = text(impl_->program.pictures, "/", name, ".png")] {
        simulation.screenshot(file);
    };
}

int TrainingSession::run(int steps)
{
    const TrainerProgram& program = impl_->program;
    std::vector<std::string> words = {program.rest.front()};
    // What the recording stores about the session. Our words come first: the user's last word may lack its value.
    words.insert(words.end(),
                 {text("--seed=", program.seed), text("--session=", program.def.name, " ", program.caseName)});
    if (!program.trainee.empty()) words.push_back("--trainee=" + program.trainee);
    if (program.device > 0) words.insert(words.end(), {"--device", at(kDevices, program.device)});
    if (steps > 0 && !cutShort()) words.insert(words.end(), {"--steps", text(steps)});
    words.insert(words.end(), program.rest.begin() + 1, program.rest.end());
    return runtime::run(impl_->simulation, words);
}

bool TrainingSession::cutShort() const { return impl_->program.has("--steps"); }

int runTrainer(int argc, const char* const* argv, const TrainerDef& def,
               const std::function<int(const Training&)>& train)
try {
    const auto program = std::make_shared<TrainerProgram>();
    validate(def, "trainer");
    if (def.cases.empty() || def.difficulties.empty())
        fail("trainer: cases and difficulties must have at least one entry each");
    for (const auto& [words, field] :
         {std::pair{&def.cases, "cases"}, {&def.difficulties, "difficulties"}, {&def.motions, "motions"}})
        for (const std::string& word : *words)
            if (word.empty() || word.find_first_of(" \t\n") != std::string::npos)
                fail("trainer: ", field, " must be words without spaces, got ", shownWord(word));
    program->def = def;
    program->caseName = def.cases.front();
    program->difficulty = def.difficulties.front();
    program->parse(argc, argv);
    if (program->wantsHelp()) return program->help();
    if (!program->checkSeeds.empty()) return program->check();
    const auto session = [&] {
        program->another = false;
        const int seed = program->seedNumber();
        const Training training{.trainee = program->trainee,
                                .caseIndex = placeOf(def.cases, program->caseName),
                                .difficulty = placeOf(def.difficulties, program->difficulty),
                                .seed = seed,
                                .motion = program->planned() ? program->motion : std::string(),
                                .device = program->device > 0 || program->has("--device") || program->has("--motion"),
                                .file = program->session.empty()
                                            ? unusedSessionFile(text(def.name, "_", program->caseName, "_", seed))
                                            : program->session,
                                .program = program};
        return trainOnce(train, training, program->session.empty());
    };
    if (program->planned() || program->has("--headless") || program->has("--no-picture")) return session();
    while (program->another || program->ask()) {
        if (const int problem = session(); problem != 0 || !program->session.empty()) return problem;
        if (program->another) program->seed = text((program->seedNumber() + 1) % kMaxSeeds);
    }
    return 0;
} catch (const Error& error) {
    return runtime::report(error);
}

} // namespace filasofia::prefab

#include "filasofia/prefab/trainer.h"

#include "filasofia/core/text.h"
#include "filasofia/metric/session_file.h"
#include "filasofia/prefab/debriefing.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/prefab/plain_window.h"
#include "filasofia/prefab/trainer_program.h"
#include "filasofia/runtime/file_failed_event.h"
#include "filasofia/runtime/options.h"

#include <imgui.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <optional>

namespace filasofia::prefab {
namespace {

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

/// The settings of the next session.
Training trainingOf(const std::shared_ptr<TrainerProgram>& program)
{
    const TrainerDef& def = program->def;
    const std::string file = text(def.name, "_", program->caseName, "_", program->seedNumber());
    return {.trainee = program->trainee,
            .caseIndex = program->chosen().base,
            .difficulty = program->difficultyIndex(),
            .seed = program->seedNumber(),
            .motion = program->planned() ? program->motion : std::string(),
            .devices = program->devices(),
            .file = program->session.empty() ? unusedSessionFile(file) : program->session,
            .program = program,
            .chosen = program->chosen()};
}

} // namespace

std::string Training::task(const std::string& own) const
{
    return text(chosen.file.empty() ? own : chosen.name, " ", at(program->def.difficulties, difficulty));
}

struct TrainingSession::Impl {
    Impl(runtime::Simulation& sim, const Training& asked)
        : simulation(sim), training(asked), program(*asked.program), end(sim)
    {
    }

    void press(const event::KeyEvent& key)
    {
        using event::KeyCode;
        if (!key.pressed || key.repeat || (debriefing && debriefing->replaying())) return;
        if (debriefing) debriefing->press(key);
        if (key.key == KeyCode::T && guidance != nullptr) guidance->setOn(guided = !guided);
        if (key.key == KeyCode::Space && !over) simulation.pause(!simulation.paused());
        if (key.key == KeyCode::R) next();
        if (key.key == KeyCode::H) keysShown = !keysShown;
        if (key.key == KeyCode::Escape) simulation.finish("ended");
    }
    void draw()
    {
        if (keysShown) drawKeys();
        if (debriefing) debriefing->follow();
    }
    void drawKeys() const
    {
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({screen.x - 12.0F, 12.0F}, ImGuiCond_Always, {1.0F, 0.0F});
        if (ImGui::Begin("keys", nullptr, kPlain)) {
            ImGui::PushTextWrapPos(0.6F * screen.x);
            ImGui::TextUnformatted((program.def.hands + kTrainerKeys).c_str());
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
    std::optional<Debriefing> debriefing; ///< if a person is at a window
    Guidance* guidance = nullptr;
    bool guided = false; // used by the thread that delivers events
    std::atomic<bool> unwritten = false, keysShown = false, over = false;
};

TrainingSession::TrainingSession(runtime::Simulation& simulation, const Training& training)
    : impl_(std::make_shared<Impl>(simulation, training))
{
    const auto weak = std::weak_ptr(impl_);
    if (impl_->program.def.openWindow) simulation.useWindow(impl_->program.def.openWindow);
    impl_->end.onClose([&simulation] { simulation.finish("closed"); });
    impl_->end.onAgain([weak] {
        if (const auto impl = weak.lock()) impl->next();
    });
    simulation.on<event::KeyEvent>([weak](const event::KeyEvent& key) {
        if (const auto impl = weak.lock()) impl->press(key);
    });
    simulation.show(visual::GuiDef{.name = "keys", .renderCallback = [weak] {
                                       if (const auto impl = weak.lock()) impl->draw();
                                   }});
    simulation.on<runtime::FileFailedEvent>([weak](const runtime::FileFailedEvent&) {
        if (const auto impl = weak.lock()) impl->unwritten = true;
    });
    // After the keys above: they must see whether a replay is open before it closes.
    if (training.motion.empty() && impl_->program.hasWindow())
        impl_->debriefing.emplace(simulation, impl_->end, training);
}

void TrainingSession::records(MetricTracker& tracker)
{
    if (impl_->debriefing) impl_->debriefing->records(tracker);
}

void TrainingSession::dress(visual::VisualServer& server)
{
    if (impl_->debriefing) impl_->debriefing->dress(server);
}

void TrainingSession::guide(Guidance& guidance, bool on)
{
    impl_->guidance = &guidance;
    guidance.setOn(impl_->guided = on);
}

void TrainingSession::over(const std::string& how, const std::function<std::vector<ResultLine>()>& results,
                           const TrainingResult& result)
{
    if (!impl_->training.motion.empty()) return impl_->simulation.finish(how);
    std::vector<ResultLine> lines = {{"Trainee", impl_->training.trainee}};
    for (ResultLine& line : results()) lines.push_back(std::move(line));
    if (impl_->unwritten) lines.push_back({"Session", "incomplete: a file could not be written"});
    impl_->over = true;
    if (impl_->debriefing) impl_->simulation.pause(true); // what comes later is no part of the session
    impl_->end.show(how, std::move(lines), impl_->training.file);
    if (impl_->debriefing) impl_->debriefing->begin(result);
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
                 {text("--seed=", program.seedNumber()), text("--session=", program.def.name, " ", program.caseName)});
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
    const auto program = std::make_shared<TrainerProgram>(def, argc, argv);
    if (program->wantsHelp()) return program->help();
    if (!program->newCase.empty()) return program->writeCase();
    if (!program->checkSeeds.empty()) return program->check();
    const bool ownName = program->session.empty();
    if (program->planned() || !program->hasWindow()) return trainOnce(train, trainingOf(program), ownName);
    while (program->another || program->ask()) {
        program->another = false;
        if (const int problem = trainOnce(train, trainingOf(program), ownName); problem != 0 || !ownName)
            return problem;
        if (program->another) program->seed = text((program->seedNumber() + 1) % kMaxSeeds);
    }
    return 0;
} catch (const Error& error) {
    return runtime::report(error);
}

} // namespace filasofia::prefab

#include "filasofia/prefab/screens.h"

#include "filasofia/prefab/plain_window.h"
#include "filasofia/prefab/task.h"
#include "filasofia/prefab/turns.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

namespace filasofia::prefab {
namespace {

constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;

/// In the middle of the picture. Typed text is never a title, because ImGui reads ids from titles.
bool beginPanel(const char* id)
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({0.5F * screen.x, 0.5F * screen.y}, ImGuiCond_Always, {0.5F, 0.5F});
    return ImGui::Begin(id, nullptr, kPanel | ImGuiWindowFlags_NoTitleBar);
}

void choose(const char* label, const std::vector<std::string>& from, int& chosen)
{
    if (from.empty()) return;
    chosen = std::clamp(chosen, 0, static_cast<int>(from.size()) - 1);
    if (!ImGui::BeginCombo(label, shown(from[static_cast<std::size_t>(chosen)], 40).c_str())) return;
    for (int i = 0; i < static_cast<int>(from.size()); ++i) {
        ImGui::PushID(i); // two entries may have the same text
        if (ImGui::Selectable(shown(from[static_cast<std::size_t>(i)], 40).c_str(), i == chosen)) chosen = i;
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

} // namespace

struct StartScreen::Impl {
    Impl(runtime::Simulation& sim, StartScreenDef asked) : simulation(sim), def(std::move(asked)), choice(def.choice)
    {
        // A name longer than the field is kept whole unless it is edited.
        const std::size_t size = std::min(choice.trainee.size(), typed.size() - 1);
        std::copy_n(choice.trainee.begin(), size, typed.begin());
    }

    void draw()
    {
        if (started) return;
        if (beginPanel("start")) {
            line(shown(def.title, 60));
            ImGui::Separator();
            if (ImGui::InputText("Trainee", typed.data(), typed.size())) choice.trainee = typed.data();
            choose("Case", def.cases, choice.caseIndex);
            choose("Difficulty", def.difficulties, choice.difficulty);
            choose("Device", def.devices, choice.device);
            ImGui::InputScalar("Seed", ImGuiDataType_U64, &choice.seed);
            if (ImGui::Button("Start")) {
                started = true;
                if (def.start) def.start(choice);
                simulation.pause(false);
            }
        }
        ImGui::End();
    }

    runtime::Simulation& simulation;
    const StartScreenDef def;
    StartChoice choice; // main thread only, as everything here
    std::array<char, 256> typed = {};
    bool started = false;
};

StartScreen::StartScreen(runtime::Simulation& simulation, StartScreenDef def)
    : impl_(std::make_shared<Impl>(simulation, std::move(def)))
{
    simulation.pause(true);
    simulation.show(visual::GuiDef{.name = "start", .renderCallback = [impl = impl_] { impl->draw(); }});
}

std::optional<StartChoice> askAtStart(StartScreenDef def, const window::WindowDef& window)
{
    runtime::Simulation lobby({.window = window, .look = {.mouse = false, .keys = false}});
    std::optional<StartChoice> chosen;
    def.start = [&, start = std::move(def.start)](const StartChoice& choice) {
        chosen = choice;
        if (start) start(choice);
        lobby.finish("started");
    };
    const StartScreen screen(lobby, std::move(def));
    lobby.dress([](visual::VisualServer& server) {
        visual::addEndoscopeLook(server, {{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}}, visual::Quality::Low);
    });
    lobby.run({});
    return chosen;
}

struct EndScreen::Impl {
    void draw()
    {
        turns.wait([this] { drawNow(); });
    }
    void drawNow()
    {
        if (!visible) return;
        const std::function<void()>* pressed = nullptr;
        if (beginPanel("end")) {
            line(shown(title, 60));
            ImGui::Separator();
            if (!results.empty() && ImGui::BeginTable("results", 2, ImGuiTableFlags_SizingFixedFit)) {
                for (const ResultLine& result : results) {
                    ImGui::TableNextColumn();
                    line(shown(result.name, 40));
                    ImGui::TableNextColumn();
                    line(shown(result.value, 40));
                }
                ImGui::EndTable();
            }
            if (!file.empty()) line("Session: " + shown(file, 100));
            if (ImGui::Button("Close")) pressed = &close;
            if (again) {
                ImGui::SameLine();
                if (ImGui::Button("Next patient")) pressed = &again;
            }
        }
        ImGui::End();
        if (pressed == nullptr) return;
        visible = false;
        if (*pressed) (*pressed)();
    }

    Turns turns; // guards the members below; show() is called within steps
    bool visible = false;
    std::string title;
    std::vector<ResultLine> results;
    std::string file;
    std::function<void()> close;
    std::function<void()> again;
};

EndScreen::EndScreen(runtime::Simulation& simulation) : impl_(std::make_shared<Impl>())
{
    simulation.show(visual::GuiDef{.name = "end", .renderCallback = [impl = impl_] { impl->draw(); }});
}

void EndScreen::show(std::string title, std::vector<ResultLine> results, std::string sessionFile)
{
    impl_->turns.soon([impl = impl_.get(), title = std::move(title), results = std::move(results),
                       sessionFile = std::move(sessionFile)] {
        impl->title = title;
        impl->results = results;
        impl->file = sessionFile;
        impl->visible = true;
    });
}

void EndScreen::onClose(std::function<void()> close)
{
    impl_->turns.soon([impl = impl_.get(), close = std::move(close)] { impl->close = close; });
}

void EndScreen::onAgain(std::function<void()> again)
{
    impl_->turns.soon([impl = impl_.get(), again = std::move(again)] { impl->again = again; });
}

} // namespace filasofia::prefab

#include "filasofia/prefab/screens.h"

#include "filasofia/core/error.h"
#include "filasofia/prefab/gui_image.h"
#include "filasofia/prefab/plain_window.h"
#include "filasofia/prefab/task.h"
#include "filasofia/prefab/turns.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <utility>

namespace filasofia::prefab {
namespace {

constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;

constexpr ImU32 kMainButton = IM_COL32(30, 120, 120, 255); ///< what most people press

/// In the middle of the picture. Typed text is never a title, because ImGui reads ids from titles.
bool beginPanel(const char* id)
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({0.5F * screen.x, 0.5F * screen.y}, ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowBgAlpha(0.88F);
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

constexpr int kMostPictureSide = 256; ///< [px]: a picture has a vertex per pixel

std::vector<visual::Image> picturesOf(const StartScreenDef& def)
{
    if (def.pictures.empty()) return {};
    if (def.pictures.size() != def.cases.size())
        fail("start screen: pictures must have one entry for each of the ", def.cases.size(), " cases, got ",
             def.pictures.size());
    std::vector<visual::Image> out;
    for (const std::string& file : def.pictures) {
        out.push_back(visual::loadImage(file));
        if (const int side = std::max(out.back().width, out.back().height); side > kMostPictureSide)
            fail("start screen: the picture '", file, "' must have at most ", kMostPictureSide,
                 " pixels per side, got ", side);
    }
    return out;
}

/// A curve of at least two values, with what it shows.
void drawCurve(const CaseHistory& history)
{
    if (history.values.size() < 2) return;
    std::vector<float> values;
    for (const double value : history.values) values.push_back(static_cast<float>(value));
    line(text("Your ", values.size(), " sessions: ", history.scored ? "score" : "time of those that were done",
              history.best.empty() ? "" : text(", best ", shown(history.best, 20))));
    ImGui::PlotLines("##curve", values.data(), static_cast<int>(values.size()), 0, nullptr, FLT_MAX, FLT_MAX,
                     {20.0F * ImGui::GetFontSize(), 3.5F * ImGui::GetFontSize()});
}

} // namespace

struct StartScreen::Impl {
    Impl(runtime::Simulation& sim, StartScreenDef asked)
        : simulation(sim), def(std::move(asked)), pictures(picturesOf(def)), choice(def.choice)
    {
        choice.caseIndex = std::clamp(choice.caseIndex, 0, std::max(static_cast<int>(def.cases.size()) - 1, 0));
        // A name longer than the field is kept whole unless it is edited.
        const std::size_t size = std::min(choice.trainee.size(), typed.size() - 1);
        std::copy_n(choice.trainee.begin(), size, typed.begin());
    }

    void draw()
    {
        if (started) return;
        drawBackdrop();
        bool entered = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
        if (beginPanel("start")) {
            line(shown(def.title, 60));
            ImGui::Separator();
            lookUp();
            drawCards();
            ImGui::BeginGroup();
            drawChoices();
            ImGui::EndGroup();
            ImGui::SameLine(0.0F, 2.0F * ImGui::GetFontSize());
            ImGui::BeginGroup();
            if (!histories.empty()) drawCurve(histories[static_cast<std::size_t>(choice.caseIndex)]);
            ImGui::PushStyleColor(ImGuiCol_Button, kMainButton);
            entered |= ImGui::Button("Start", {8.0F * ImGui::GetFontSize(), 2.0F * ImGui::GetFontSize()});
            ImGui::PopStyleColor();
            ImGui::EndGroup();
            drawControls();
        }
        ImGui::End();
        if (entered) start();
    }
    void start()
    {
        started = true;
        if (def.start) def.start(choice);
        simulation.pause(false);
    }
    /// The picture of the case all over the window, dark and out of focus.
    void drawBackdrop() const
    {
        if (pictures.empty()) return;
        const visual::Image& image = pictures[static_cast<std::size_t>(choice.caseIndex)];
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        const auto across = static_cast<float>(image.width), down = static_cast<float>(image.height);
        const float scale = std::max(screen.x / across, screen.y / down);
        const ImVec2 from = {0.5F * (screen.x - scale * across), 0.5F * (screen.y - scale * down)};
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        drawImage(list, from, {from.x + scale * across, from.y + scale * down}, image);
        list.AddRectFilled({0.0F, 0.0F}, screen, IM_COL32(0, 0, 0, 110));
    }
    void drawChoices()
    {
        ImGui::PushItemWidth(14.0F * ImGui::GetFontSize());
        if (ImGui::InputText("Trainee", typed.data(), typed.size())) choice.trainee = typed.data();
        if (pictures.empty()) choose("Case", def.cases, choice.caseIndex);
        choose("Difficulty", def.difficulties, choice.difficulty);
        choose("Device", def.devices, choice.device);
        ImGui::InputScalar("Seed", ImGuiDataType_U64, &choice.seed);
        ImGui::PopItemWidth();
    }
    void drawControls() const
    {
        if (def.controls.empty()) return;
        ImGui::Separator();
        ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(175, 180, 185, 255));
        line(def.controls);
        ImGui::PopStyleColor();
    }
    /// How the trainee has done, if trainee or difficulty have changed.
    void lookUp()
    {
        if (!def.history || def.cases.empty()) return;
        if (!histories.empty() && lookedUp.trainee == choice.trainee && lookedUp.difficulty == choice.difficulty)
            return;
        lookedUp = choice;
        histories.clear();
        for (lookedUp.caseIndex = 0; lookedUp.caseIndex < static_cast<int>(def.cases.size()); ++lookedUp.caseIndex)
            histories.push_back(def.history(lookedUp));
    }
    /// Cases as pictures, three in a row.
    void drawCards()
    {
        for (int i = 0; i < static_cast<int>(pictures.size()); ++i) {
            if (i % 3 != 0) ImGui::SameLine();
            ImGui::PushID(i);
            drawCard(i);
            ImGui::PopID();
        }
    }
    /// [px], so that the rows of cards take little more than half of the window.
    [[nodiscard]] float cardWidth() const
    {
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        const auto rows = static_cast<float>((def.cases.size() + 2) / 3);
        const float high = 0.55F * screen.y / rows - 2.5F * ImGui::GetTextLineHeightWithSpacing();
        return std::clamp(high / 0.75F, 4.0F * ImGui::GetFontSize(), 0.29F * screen.x);
    }
    void drawCard(int index)
    {
        const auto at = static_cast<std::size_t>(index);
        const float row = ImGui::GetTextLineHeightWithSpacing(), width = cardWidth(), high = 0.75F * width;
        if (ImGui::InvisibleButton("card", {width, high + row * (histories.empty() ? 1.2F : 2.2F)}))
            choice.caseIndex = index;
        const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddRectFilled(from, to, ImGui::GetColorU32(ImGuiCol_FrameBg));
        drawImage(list, from, {to.x, from.y + high}, pictures[at]);
        const auto write = [&](float below, ImGuiCol color, const std::string& words) {
            list.AddText({from.x + 6.0F, from.y + high + below}, ImGui::GetColorU32(color), words.c_str());
        };
        list.PushClipRect(from, to, true);
        write(2.0F, ImGuiCol_Text, shown(def.cases[at], 40));
        if (!histories.empty()) write(2.0F + row, ImGuiCol_TextDisabled, saidOf(histories[at]));
        list.PopClipRect();
        const bool chosen = index == choice.caseIndex, hovered = ImGui::IsItemHovered();
        if (chosen || hovered)
            list.AddRect(from, to, ImGui::GetColorU32(chosen ? ImGuiCol_CheckMark : ImGuiCol_TextDisabled), 0.0F, 0,
                         chosen ? 3.0F : 1.0F);
    }
    static std::string saidOf(const CaseHistory& history)
    {
        if (history.last.empty()) return "not tried yet";
        return text(history.best.empty() ? "" : text("best ", shown(history.best, 20), ", "), "last ",
                    shown(history.last, 20));
    }

    runtime::Simulation& simulation;
    const StartScreenDef def;
    const std::vector<visual::Image> pictures;
    std::vector<CaseHistory> histories; ///< one for each case, of `lookedUp`
    StartChoice lookedUp;
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

std::optional<StartChoice>
askAtStart(StartScreenDef def, const window::WindowDef& window,
           const std::function<std::unique_ptr<window::Window>(const window::WindowDef&)>& open)
{
    runtime::Simulation lobby({.window = window, .look = {.mouse = false, .keys = false}});
    std::optional<StartChoice> chosen;
    def.start = [&, start = std::move(def.start)](const StartChoice& choice) {
        chosen = choice;
        if (start) start(choice);
        lobby.finish("started");
    };
    const StartScreen screen(lobby, std::move(def));
    if (open) lobby.useWindow(open);
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
            drawCurve(history);
            if (!said.empty()) line(shown(said, 100));
            if (ImGui::Button("Close")) pressed = &close;
            if (again) {
                ImGui::SameLine();
                if (ImGui::Button("Next patient")) pressed = &again;
            }
            for (const auto& [name, action] : others) {
                ImGui::SameLine();
                if (ImGui::Button(name.c_str())) pressed = &action;
            }
        }
        ImGui::End();
        if (pressed == nullptr) return;
        if (pressed == &close || pressed == &again) visible = false;
        if (*pressed) (*pressed)();
    }

    Turns turns; // guards the members below; show() is called within steps
    bool visible = false;
    std::string title;
    std::vector<ResultLine> results;
    std::string file;
    CaseHistory history;
    std::string said;
    std::function<void()> close;
    std::function<void()> again;
    std::vector<std::pair<std::string, std::function<void()>>> others;
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

void EndScreen::addButton(std::string name, std::function<void()> pressed)
{
    impl_->turns.soon([impl = impl_.get(), name = shown(name, 40), pressed = std::move(pressed)] {
        impl->others.emplace_back(name, pressed);
    });
}

void EndScreen::setHistory(CaseHistory history)
{
    impl_->turns.soon([impl = impl_.get(), history = std::move(history)] { impl->history = history; });
}

void EndScreen::say(std::string line)
{
    impl_->turns.soon([impl = impl_.get(), line = std::move(line)] { impl->said = line; });
}

void EndScreen::setVisible(bool visible)
{
    impl_->turns.soon([impl = impl_.get(), visible] { impl->visible = visible; });
}

} // namespace filasofia::prefab

#pragma once

#include "filasofia/core/log.h"
#include "gui_person.h"

#include <imgui.h>

namespace filasofia::visual {

/// A panel at a known place, with one of each item that a person can use.
struct Panel {
    char note[64] = "";
    float force = 1.0F;
    bool cutting = false;
    int clicks = 0;
    ImVec2 place = {10, 10};
    ImVec2 noteAt, sliderAt, boxAt, buttonAt; ///< [px], their centres in the Gui, in the last frame

    void draw()
    {
        const auto middle = [] {
            const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
            return ImVec2{0.5F * (low.x + high.x), 0.5F * (low.y + high.y)};
        };
        ImGui::SetNextWindowPos({10, 10}, ImGuiCond_Once);
        ImGui::SetNextWindowSize({200, 160}, ImGuiCond_Once);
        ImGui::Begin("Forceps");
        place = ImGui::GetWindowPos();
        ImGui::PushItemWidth(110);
        ImGui::InputText("note", note, sizeof note);
        noteAt = middle();
        ImGui::SliderFloat("force", &force, 0.0F, 5.0F, "%.1f N");
        sliderAt = middle();
        ImGui::PopItemWidth();
        ImGui::Checkbox("cutting", &cutting);
        boxAt = middle();
        if (ImGui::Button("count")) ++clicks;
        buttonAt = middle();
        ImGui::End();
    }
};

struct GuiScene {
    explicit GuiScene(ViewDef view = {}) : server({.backend = Backend::Null, .width = 320, .height = 240})
    {
        gui = &server.add(GuiDef{.name = "panel", .renderCallback = [this] { panel.draw(); }},
                          server.add(view, server.add(CameraDef{})));
        person.look();
    }

    VisualServer server;
    Panel panel;
    Gui* gui = nullptr;
    GuiPerson person{server};
};

/// Collects the log while it lives.
class Logged {
public:
    Logged()
    {
        setLogSink([this](LogLevel, std::string_view line) { lines.emplace_back(line); });
    }
    ~Logged() { setLogSink({}); }

    std::vector<std::string> lines;
};

} // namespace filasofia::visual

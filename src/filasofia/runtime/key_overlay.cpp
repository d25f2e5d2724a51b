#include "filasofia/runtime/key_overlay.h"

#include "filasofia/runtime/run_keys.h"
#include "filasofia/visual/gui.h"
#include "filasofia/visual/visual_server.h"

#include <imgui.h>

namespace filasofia::runtime {
namespace {

void drawKeys()
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({0.5F * screen.x, 0.5F * screen.y}, ImGuiCond_Always, {0.5F, 0.5F});
    constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar |
                                        ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing;
    if (ImGui::Begin("keys", nullptr, kPlain) && ImGui::BeginTable("list", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const KeyLine& line : keyLines()) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.keys.data(), line.keys.data() + line.keys.size());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.meaning.data(), line.meaning.data() + line.meaning.size());
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

} // namespace

void KeyOverlay::toggle()
{
    if (gui_)
        gui_->setVisible(!gui_->visible());
    else
        gui_ = &visual_.add(visual::GuiDef{.name = "keys", .renderCallback = drawKeys});
}

} // namespace filasofia::runtime

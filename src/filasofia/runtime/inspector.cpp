#include "filasofia/runtime/inspector.h"

#include "filasofia/visual/visual_server.h"

#include <imgui.h>

#include <cstdio>
#include <filesystem>

namespace filasofia::runtime {

Inspector::Inspector(Simulation::Impl& impl, visual::VisualServer& visual)
    : impl_(impl), visual_(visual), rates_(impl), bodies_(impl), hands_(impl), scene_(impl)
{
}

Inspector::~Inspector()
{
    impl_.feed.watch(false);
    if (gui_) visual_.remove(*gui_);
}

void Inspector::setOpen(bool open)
{
    if (open == open_) return;
    open_ = open;
    impl_.feed.read([](const physics::StepReport&) {}); // drops reports of the last time it was open
    impl_.feed.watch(open);
    if (open) rates_.restart();
    if (open && !gui_)
        gui_ = &visual_.add(visual::GuiDef{.name = "inspector", .renderCallback = [this] { drawPanel(); }});
    if (gui_) gui_->setVisible(open);
}

bool Inspector::handle(const event::Event& event)
{
    const auto* key = dynamic_cast<const event::KeyEvent*>(&event);
    if (!key || key->key != event::KeyCode::F1) return false;
    if (key->pressed && !key->repeat) setOpen(!open_);
    return true;
}

void Inspector::beforePicture()
{
    if (!open_) return;
    impl_.feed.read([this](const physics::StepReport& report) { rates_.add(report); });
    rates_.addPicture(visual_.statistics().lastGuiSeconds);
    drawScene();
}

void Inspector::drawScene()
{
    try {
        scene_.draw(show, visual_);
    } catch (const Error& error) { // a body may be removed while it is drawn
        problem_ = error.what();
    }
}

void Inspector::afterPicture(bool drawn)
{
    if (drawn) rates_.countDrawn();
    if (std::exchange(screenshotAsked_, false)) takeScreenshot();
}

void Inspector::drawPanel()
{
    const float letter = ImGui::GetFontSize();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({0.7F * letter, 0.7F * letter}, ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize({std::min(21.0F * letter, screen.x), std::min(64.0F * letter, screen.y - 1.4F * letter)},
                             ImGuiCond_FirstUseEver);
    bool stays = true;
    if (ImGui::Begin("Inspector  (F1)", &stays)) {
        ImGui::PushItemWidth(-7.5F * letter);
        drawRun();
        if (ImGui::CollapsingHeader("Rates", ImGuiTreeNodeFlags_DefaultOpen)) rates_.draw();
        if (ImGui::CollapsingHeader("Show", ImGuiTreeNodeFlags_DefaultOpen)) drawShow();
        if (hands_.any() && ImGui::CollapsingHeader("Haptics", ImGuiTreeNodeFlags_DefaultOpen)) hands_.draw();
        if (ImGui::CollapsingHeader("Bodies", ImGuiTreeNodeFlags_DefaultOpen)) bodies_.draw();
        ImGui::PopItemWidth();
    }
    ImGui::End();
    if (!stays) setOpen(false);
}

void Inspector::drawRun()
{
    const bool paused = rates_.paused();
    if (ImGui::Button(paused ? "Resume" : "Pause")) impl_.setPaused(!paused);
    ImGui::SameLine();
    if (ImGui::Button("Step")) impl_.pause.askSingleStep();
    ImGui::SameLine();
    if (ImGui::Button("Reset")) impl_.reset();
    ImGui::SameLine();
    if (ImGui::Button("Screenshot")) askForScreenshot();
    if (!screenshot_.empty()) ImGui::TextDisabled("%s", screenshot_.c_str());
    const std::string& problem = problem_.empty() ? bodies_.problem() : problem_;
    if (!problem.empty()) ImGui::TextWrapped("%s", problem.c_str());
}

void Inspector::drawShow()
{
    ImGui::Checkbox("wireframe", &show.wireframe);
    ImGui::SameLine();
    ImGui::Checkbox("collision models", &show.collision);
    ImGui::Checkbox("contacts", &show.contacts);
    ImGui::SameLine();
    ImGui::Checkbox("forces", &show.forces);
    if (show.forces) {
        auto millimetres = float(1e3 * scene_.scaleOf(show));
        if (ImGui::SliderFloat("arrow [mm/N]", &millimetres, 0.01F, 1e4F, "%.3g", ImGuiSliderFlags_Logarithmic))
            show.metresPerNewton = 1e-3 * double(millimetres);
    }
    const auto views = visual_.views();
    if (views.empty()) return;
    int quality = static_cast<int>(views.front()->def().quality);
    if (ImGui::Combo("quality", &quality, "low\0medium\0high\0")) {
        for (visual::View* view : views) {
            visual::ViewDef def = view->def();
            def.quality = static_cast<visual::Quality>(quality);
            view->set(def);
        }
    }
}

void Inspector::takeScreenshot()
{
    try {
        std::filesystem::path file;
        for (int number = 1; number < 10000; ++number) {
            char name[32];
            std::snprintf(name, sizeof name, "filasofia_%04d.png", number);
            file = std::filesystem::path(screenshotFolder) / name;
            if (!std::filesystem::exists(file)) break;
        }
        gui_->setVisible(false); // the picture shows the scene without the panel
        drawScene();
        const visual::Image image = visual_.capture();
        gui_->setVisible(open_);
        visual::savePng(image, file);
        screenshot_ = file.string();
    } catch (const std::exception& problem) {
        gui_->setVisible(open_);
        problem_ = problem.what();
    }
}

} // namespace filasofia::runtime

#pragma once

#include "filasofia/runtime/inspector_bodies.h"
#include "filasofia/runtime/inspector_hands.h"
#include "filasofia/runtime/inspector_rates.h"
#include "filasofia/runtime/inspector_scene.h"

namespace filasofia::visual {
class Gui;
}

namespace filasofia::runtime {

/// The Gui of a live run that F1 opens: rates and where the time goes, the bodies and what can be changed about them,
/// and the forces between them. Main thread. It reads Frames and a feed of step reports and acts through commands;
/// physics does not know about it.
class Inspector {
public:
    Inspector(Simulation::Impl& impl, visual::VisualServer& visual);
    ~Inspector();
    Inspector(const Inspector&) = delete;
    Inspector& operator=(const Inspector&) = delete;

    [[nodiscard]] bool open() const { return open_; }
    void setOpen(bool open);
    /// Returns true for F1, which opens and closes the panel.
    bool handle(const event::Event& event);

    /// Call it before each picture: reads the step reports that have come, and draws into the scene.
    void beforePicture();
    /// Call it after each picture: takes the screenshot that was asked for.
    void afterPicture(bool drawn);

    InspectorShow show;                 ///< what it draws into the scene
    std::string screenshotFolder = "."; ///< files are called filasofia_0001.png and so on
    /// Takes a screenshot after the next picture.
    void askForScreenshot() { screenshotAsked_ = true; }
    /// The text of the last Error; empty if there was none.
    [[nodiscard]] const std::string& problem() const { return problem_; }
    [[nodiscard]] const std::string& lastScreenshot() const { return screenshot_; }

private:
    void drawPanel();
    void drawRun();
    void drawShow();
    void drawScene();
    void takeScreenshot();

    Simulation::Impl& impl_;
    visual::VisualServer& visual_;
    visual::Gui* gui_ = nullptr; ///< made when the panel is first opened
    InspectorRates rates_;
    InspectorBodies bodies_;
    InspectorHands hands_;
    InspectorScene scene_;
    bool open_ = false;
    bool screenshotAsked_ = false;
    std::string problem_;
    std::string screenshot_;
};

} // namespace filasofia::runtime

#pragma once

#include "filasofia/runtime/inspector_bodies.h"
#include "filasofia/runtime/inspector_hands.h"
#include "filasofia/runtime/inspector_rates.h"
#include "filasofia/runtime/inspector_scene.h"

namespace filasofia::visual {
class Gui;
}

namespace filasofia::runtime {

/// The Gui behind F1 in a live run: how fast it goes and where the time goes, what the bodies are and what can be
/// changed about them, what they do to each other. Main thread. It reads Frames and a feed of step reports and acts by
/// commands: physics does not know it.
class Inspector {
public:
    Inspector(Simulation::Impl& impl, visual::VisualServer& visual);
    ~Inspector();
    Inspector(const Inspector&) = delete;
    Inspector& operator=(const Inspector&) = delete;

    [[nodiscard]] bool open() const { return open_; }
    void setOpen(bool open);
    /// True for F1, which opens and closes it.
    bool handle(const event::Event& event);

    /// Before each picture: takes in what has come, and draws into the scene.
    void beforePicture();
    /// After it: the screenshot that was asked for.
    void afterPicture(bool drawn);

    InspectorShow show;                 ///< what it draws into the scene
    std::string screenshotFolder = "."; ///< files are called filasofia_0001.png and so on
    /// After the next picture.
    void askForScreenshot() { screenshotAsked_ = true; }
    /// What went wrong last, as an Error said it.
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
    visual::Gui* gui_ = nullptr; ///< made when it is first opened
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

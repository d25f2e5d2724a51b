#pragma once

namespace filasofia::visual {
class Gui;
class VisualServer;
} // namespace filasofia::visual

namespace filasofia::runtime {

/// The list of keys over the picture, which H shows. Main thread.
class KeyOverlay {
public:
    explicit KeyOverlay(visual::VisualServer& visual) : visual_(visual) {}
    void toggle();

private:
    visual::VisualServer& visual_;
    visual::Gui* gui_ = nullptr; ///< made when it is first shown
};

} // namespace filasofia::runtime

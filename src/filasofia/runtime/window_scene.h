#pragma once

#include "filasofia/runtime/simulation_impl.h"

#include <functional>

namespace filasofia::runtime {

/// The window that the user has chosen, or that the backend needs; null without one.
std::unique_ptr<window::Window> openWindow(const Simulation::Impl& impl, const window::WindowDef& def,
                                           visual::Backend backend);

/// A window, if there is one, and the visual server that draws the simulation into it. One thread, which need not be
/// the main one.
class WindowScene {
public:
    /// Shows the bodies; without a window, in pictures of the size of `def`.
    WindowScene(Simulation::Impl& impl, std::unique_ptr<window::Window> window, const window::WindowDef& def,
                visual::Backend backend, Simulation::Impl::Framed framed = Simulation::Impl::Framed::AtStart);

    /// Passes the person's input to `take`, and follows the size of the window.
    void input(const std::function<void(std::unique_ptr<event::Event>)>& take);
    [[nodiscard]] bool closed() const { return window_ && window_->shouldClose(); }
    [[nodiscard]] visual::VisualServer& visual() { return *visual_; }

private:
    const DrawnBindings drawn_;
    std::unique_ptr<window::Window> window_;
    window::WindowSize size_;
    std::unique_ptr<visual::VisualServer> visual_; ///< after the window, so that it is destroyed first
};

} // namespace filasofia::runtime

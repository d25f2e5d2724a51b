#include "filasofia/runtime/window_scene.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

constexpr int kLargestPicture = 8192; // [px], the largest size that a visual server takes

} // namespace

std::unique_ptr<window::Window> openWindow(const Simulation::Impl& impl, const window::WindowDef& def,
                                           visual::Backend backend)
{
    if (impl.picture.openWindow) return impl.picture.openWindow(def);
    return backend == visual::Backend::Window ? window::openWindow(def) : nullptr;
}

WindowScene::WindowScene(Simulation::Impl& impl, std::unique_ptr<window::Window> window, const window::WindowDef& def,
                         visual::Backend backend, Simulation::Impl::Framed framed)
    : drawn_(impl.bindings), window_(std::move(window)),
      size_(window_ ? window_->size() : window::WindowSize{def.width, def.height})
{
    visual_ = std::make_unique<visual::VisualServer>(
        visual::VisualServerDef{.backend = backend,
                                .width = size_.width,
                                .height = size_.height,
                                .nativeWindow = window_ ? window_->nativeWindow() : nullptr});
    if (window_) visual_->setGuiScale(window_->scale());
    impl.bindings.forgetRemoved(impl.physics);
    impl.bindings.addPending(*visual_);
    impl.dressScene(*visual_, framed);
}

void WindowScene::input(const std::function<void(std::unique_ptr<event::Event>)>& take)
{
    if (!window_) return;
    window_->poll(take);
    window_->setTextInput(visual_->wantsText());
    if (const window::WindowSize now = window_->size(); now != size_) {
        size_ = now;
        visual_->resize(std::clamp(now.width, 1, kLargestPicture), std::clamp(now.height, 1, kLargestPicture));
    }
}

} // namespace filasofia::runtime

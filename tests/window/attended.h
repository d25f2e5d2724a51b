#pragma once

#include "filasofia/window/window.h"

#include "window/x11_person.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace filasofia::window {

/// A real window with a person who is asked what to do each time the run looks for input.
class Attended final : public Window {
public:
    using Act = std::function<void(Person&)>;
    Attended(const WindowDef& def, Act act)
        : inner_(openWindow(def)), person_(inner_->nativeWindow()), act_(std::move(act))
    {
    }
    [[nodiscard]] void* nativeWindow() const override { return inner_->nativeWindow(); }
    [[nodiscard]] WindowSize size() const override { return inner_->size(); }
    [[nodiscard]] double scale() const override { return inner_->scale(); }
    void poll(const event::EventSink& sink) override
    {
        act_(person_);
        inner_->poll(sink);
    }
    [[nodiscard]] bool shouldClose() const override { return inner_->shouldClose(); }
    void setTitle(const std::string& title) override { inner_->setTitle(title); }

private:
    std::unique_ptr<Window> inner_;
    Person person_;
    Act act_;
};

} // namespace filasofia::window

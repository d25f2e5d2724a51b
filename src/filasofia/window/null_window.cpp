#include "filasofia/window/null_window.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/validate.h"
#include "filasofia/event/input_events.h"

namespace filasofia::window {

NullWindow::NullWindow(const WindowDef& def) : title_(def.title), size_{def.width, def.height}
{
    validate(def, text("window '", def.title, "'"));
}

void NullWindow::inject(std::unique_ptr<event::Event> event)
{
    FILASOFIA_ASSERT(event != nullptr);
    injected_.push_back(std::move(event));
}

void NullWindow::poll(const event::EventSink& sink)
{
    while (!injected_.empty()) {
        std::unique_ptr<event::Event> event = std::move(injected_.front());
        injected_.pop_front();
        if (const auto* own = dynamic_cast<const event::WindowEvent*>(event.get())) {
            if (own->kind == event::WindowEvent::Kind::Resized) size_ = {own->width, own->height};
            if (own->kind == event::WindowEvent::Kind::CloseRequested) shouldClose_ = true;
        }
        sink(std::move(event));
    }
}

} // namespace filasofia::window

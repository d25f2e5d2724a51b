#include "filasofia/visual/gui.h"

#include "filasofia/core/validate.h"
#include "filasofia/event/input_events.h"
#include "filasofia/visual/overlays.h"

namespace filasofia::visual {
namespace {

struct Place {
    double x = 0.0, y = 0.0; // [px], in the window
};

Place placeOf(const event::Event& event)
{
    if (const auto* move = dynamic_cast<const event::MouseMoveEvent*>(&event)) return {move->x, move->y};
    if (const auto* button = dynamic_cast<const event::MouseButtonEvent*>(&event)) return {button->x, button->y};
    if (const auto* wheel = dynamic_cast<const event::MouseWheelEvent*>(&event)) return {wheel->x, wheel->y};
    return {};
}

} // namespace

Gui::Gui(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Gui::~Gui() = default;
const std::string& Gui::name() const { return impl_->def.name; }
View* Gui::view() const { return impl_->view; }
void Gui::setRenderCallback(RenderCallback callback) { impl_->surface.callback.set(std::move(callback)); }

void Gui::setScale(double scale)
{
    GuiDef changed{.name = impl_->def.name, .scale = scale};
    validate(changed, text("gui '", changed.name, "'"));
    impl_->def.scale = scale;
}

bool Gui::visible() const { return impl_->visible; }

void Gui::setVisible(bool visible)
{
    if (impl_->visible && !visible) impl_->surface.releaseAll();
    impl_->visible = visible;
}

bool Gui::handle(const event::Event& event)
{
    if (!impl_->visible || impl_->surface.callback.empty()) return false;
    const Place place = placeOf(event);
    return impl_->surface.take(event, place.x - impl_->area.left, place.y - impl_->area.top);
}

} // namespace filasofia::visual

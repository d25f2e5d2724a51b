#include "filasofia/event/event.h"

#include "filasofia/event/input_events.h"

namespace filasofia::event {

std::string_view name(EventType type)
{
    switch (type) {
    case EventType::PhysicsUpdate:
        return "PhysicsUpdate";
    case EventType::VisualUpdate:
        return "VisualUpdate";
    case EventType::MouseButton:
        return "MouseButton";
    case EventType::MouseMove:
        return "MouseMove";
    case EventType::MouseWheel:
        return "MouseWheel";
    case EventType::Key:
        return "Key";
    case EventType::TextInput:
        return "TextInput";
    case EventType::Window:
        return "Window";
    case EventType::Contact:
        return "Contact";
    case EventType::Cut:
        return "Cut";
    case EventType::Tear:
        return "Tear";
    case EventType::Intersection:
        return "Intersection";
    case EventType::Bleeding:
        return "Bleeding";
    case EventType::Burn:
        return "Burn";
    case EventType::Energy:
        return "Energy";
    case EventType::Duct:
        return "Duct";
    case EventType::Clip:
        return "Clip";
    case EventType::Break:
        return "Break";
    case EventType::Distension:
        return "Distension";
    case EventType::FileFailed:
        return "FileFailed";
    case EventType::Device:
        return "Device";
    case EventType::Controller:
        return "Controller";
    case EventType::Custom1:
        return "Custom1";
    case EventType::Custom2:
        return "Custom2";
    case EventType::Custom3:
        return "Custom3";
    case EventType::Custom4:
        return "Custom4";
    }
    return "unknown";
}

Event::~Event() = default;

std::optional<MergeKey> Event::mergeKey() const { return std::nullopt; }

void Event::absorb(const Event&) noexcept {}

void MouseMoveEvent::absorb(const Event& older) noexcept
{
    // Without this, a mouse-driven device that follows the displacements would lag behind the hand whenever it is
    // called late.
    if (const auto* move = dynamic_cast<const MouseMoveEvent*>(&older)) {
        dx += move->dx;
        dy += move->dy;
    }
}

} // namespace filasofia::event

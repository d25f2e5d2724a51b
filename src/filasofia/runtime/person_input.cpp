#include "filasofia/runtime/person_input.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

using event::KeyCode;

constexpr double kNotch = 10.0; ///< [px], mouse movement that one notch of the wheel stands for

constexpr std::pair<KeyCode, Vec3> kMoves[] = {
    {KeyCode::Left, {-1, 0, 0}}, {KeyCode::Right, {1, 0, 0}},   {KeyCode::Up, {0, 1, 0}},
    {KeyCode::Down, {0, -1, 0}}, {KeyCode::PageUp, {0, 0, -1}}, {KeyCode::PageDown, {0, 0, 1}},
};

} // namespace

std::optional<device::PersonInput> PersonInputReader::readKey(const event::KeyEvent& key)
{
    const bool ours = std::ranges::any_of(kMoves, [&](const auto& move) { return move.first == key.key; });
    if (!ours || (key.pressed && (key.modifiers.control || key.modifiers.alt || key.modifiers.super)))
        return std::nullopt;
    if (key.pressed)
        keys_.insert(key.key);
    else
        keys_.erase(key.key);
    Vec3 push;
    for (const auto& [code, way] : kMoves)
        if (keys_.contains(code)) push += way;
    return device::PersonInput{.push = push};
}

std::optional<device::PersonInput> PersonInputReader::read(const event::Event& event)
{
    using event::MouseButton;
    if (const auto* key = dynamic_cast<const event::KeyEvent*>(&event)) return readKey(*key);
    if (const auto* button = dynamic_cast<const event::MouseButtonEvent*>(&event)) {
        if (button->button == MouseButton::Right) {
            held_ = button->pressed;
            if (!held_) buttons_ = 0;
        } else if (held_ && button->button == MouseButton::Left) {
            buttons_ = button->pressed ? 1 : 0;
        } else {
            return std::nullopt;
        }
        return device::PersonInput{.buttons = buttons_};
    }
    if (const auto* move = dynamic_cast<const event::MouseMoveEvent*>(&event); move && held_)
        return move->modifiers.control ? device::PersonInput{.turned = {-move->dy, -move->dx, 0.0}}
                                       : device::PersonInput{.moved = {move->dx, -move->dy, 0.0}};
    if (const auto* wheel = dynamic_cast<const event::MouseWheelEvent*>(&event); wheel && held_)
        return wheel->modifiers.control ? device::PersonInput{.turned = {0.0, 0.0, kNotch * wheel->dy}}
                                        : device::PersonInput{.moved = {0.0, 0.0, -kNotch * wheel->dy}};
    if (const auto* window = dynamic_cast<const event::WindowEvent*>(&event);
        window &&
        window->kind == event::WindowEvent::Kind::FocusLost) { // a release in another window does not reach us
        const bool moving = held_ || !keys_.empty();
        held_ = false;
        buttons_ = 0;
        keys_.clear();
        if (moving) return device::PersonInput{.push = Vec3{}, .buttons = 0u};
    }
    return std::nullopt;
}

} // namespace filasofia::runtime

#include "filasofia/visual/imgui_input.h"

#include "filasofia/core/log.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <utility>

namespace filasofia::visual {
namespace {

using namespace event;

constexpr std::size_t kMaxWaiting = 8192; // reached after about a minute without a drawn frame

constexpr std::array<std::pair<ImGuiKey, KeyCode>, ImGuiKey_COUNT> kKeys = {{
    {ImGuiKey_Tab, KeyCode::Tab},
    {ImGuiKey_LeftArrow, KeyCode::Left},
    {ImGuiKey_RightArrow, KeyCode::Right},
    {ImGuiKey_UpArrow, KeyCode::Up},
    {ImGuiKey_DownArrow, KeyCode::Down},
    {ImGuiKey_PageUp, KeyCode::PageUp},
    {ImGuiKey_PageDown, KeyCode::PageDown},
    {ImGuiKey_Home, KeyCode::Home},
    {ImGuiKey_End, KeyCode::End},
    {ImGuiKey_Insert, KeyCode::Insert},
    {ImGuiKey_Delete, KeyCode::Delete},
    {ImGuiKey_Backspace, KeyCode::Backspace},
    {ImGuiKey_Space, KeyCode::Space},
    {ImGuiKey_Enter, KeyCode::Enter},
    {ImGuiKey_Escape, KeyCode::Escape},
    {ImGuiKey_KeyPadEnter, KeyCode::KeypadEnter},
    {ImGuiKey_A, KeyCode::A},
    {ImGuiKey_C, KeyCode::C},
    {ImGuiKey_V, KeyCode::V},
    {ImGuiKey_X, KeyCode::X},
    {ImGuiKey_Y, KeyCode::Y},
    {ImGuiKey_Z, KeyCode::Z},
}};

int indexOf(MouseButton button) // ImGui's order is left, right, middle
{
    switch (button) {
    case MouseButton::Left:
        return 0;
    case MouseButton::Right:
        return 1;
    case MouseButton::Middle:
        return 2;
    case MouseButton::Back:
        return 3;
    case MouseButton::Forward:
        return 4;
    }
    return 0;
}

unsigned heldBits(const MouseButtons& held)
{
    return unsigned(held.left) | unsigned(held.right) << 1U | unsigned(held.middle) << 2U | unsigned(held.back) << 3U |
           unsigned(held.forward) << 4U;
}

/// Whether one of ImGui's windows is at this place. ImGui's own answer (WantCaptureMouse) is about the mouse in the
/// last frame.
bool windowAt(const ImGuiContext& context, double x, double y)
{
    if (context.OpenPopupStack.Size > 0) return true; // a click beside a popup closes it, and is for nothing else
    const ImVec2 place{float(x), float(y)};
    return std::any_of(context.Windows.begin(), context.Windows.end(), [&](const ImGuiWindow* window) {
        return window->Active && !window->Hidden && (window->Flags & ImGuiWindowFlags_NoMouseInputs) == 0 &&
               window->OuterRectClipped.Contains(place);
    });
}

bool isLetter(KeyCode key) { return (key >= KeyCode::A && key <= KeyCode::Digit9) || key == KeyCode::Space; }

/// Whether pressing a key does more than typing its letter.
bool isAction(const std::optional<Modifiers>& held, KeyCode key, bool down)
{
    return down && (!isLetter(key) || (held && (held->control || held->super)));
}

bool contains(const std::vector<KeyCode>& keys, KeyCode key)
{
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

} // namespace

struct ImguiInput::Frame {
    bool moved = false, wheeled = false, typed = false, acted = false;
    unsigned buttons = 0;
    std::vector<KeyCode> keys, actions; ///< keys that changed, and keys pressed for an action
};

void ImguiInput::mapKeys(ImGuiIO& io)
{
    for (const auto& [theirs, ours] : kKeys) io.KeyMap[theirs] = static_cast<int>(ours);
}

void ImguiInput::push(Input input)
{
    if (waiting_.size() >= kMaxWaiting) {
        logWarning("gui: more than ", kMaxWaiting, " inputs wait for a frame: they are dropped");
        releaseAll();
    }
    waiting_.push_back(std::move(input));
}

void ImguiInput::pushPlace(Place place, std::optional<Modifiers> modifiers)
{
    // A mouse path without an event in between is replaced by its end.
    if (!waiting_.empty() && std::holds_alternative<Place>(waiting_.back().what)) waiting_.pop_back();
    push({place, modifiers});
}

bool ImguiInput::takeMove(const MouseMoveEvent& move, Place place, const ImGuiContext& context)
{
    // A button may have been released outside the window, without an event.
    const unsigned held = heldBits(move.buttons);
    ours_ &= held;
    others_ &= held;
    pushPlace(place, move.modifiers);
    return ours_ != 0 || (others_ == 0 && windowAt(context, place.x, place.y));
}

bool ImguiInput::takeButton(const MouseButtonEvent& button, Place place, const ImGuiContext& context)
{
    const int index = indexOf(button.button);
    const unsigned bit = 1U << unsigned(index);
    pushPlace(place, button.modifiers);
    if (!button.pressed) { // ends what its press began, wherever that was
        const bool taken = (ours_ & bit) != 0;
        ours_ &= ~bit;
        others_ &= ~bit;
        push({Button{index, false}, button.modifiers});
        return taken;
    }
    const bool taken = ours_ != 0 || (others_ == 0 && windowAt(context, place.x, place.y));
    (taken ? ours_ : others_) |= bit;
    push({Button{index, true}, button.modifiers}); // even elsewhere, because it takes the focus from ImGui's windows
    return taken;
}

bool ImguiInput::takeKey(const KeyEvent& key, const ImGuiContext& context)
{
    const auto ours = std::find(ourKeys_.begin(), ourKeys_.end(), key.key);
    bool taken = ours != ourKeys_.end();
    if (key.pressed && !key.repeat) {
        taken = context.IO.WantCaptureKeyboard || context.IO.WantTextInput;
        if (taken && ours == ourKeys_.end()) ourKeys_.push_back(key.key);
    } else if (!key.pressed && taken) {
        ourKeys_.erase(ours);
    }
    // ImGui repeats pressed keys by itself.
    if (!key.repeat && key.key != KeyCode::Unknown) push({Key{key.key, key.pressed}, key.modifiers});
    return taken;
}

bool ImguiInput::take(const Event& event, double x, double y, const ImGuiContext& context)
{
    const Place place{x, y};
    if (const auto* move = dynamic_cast<const MouseMoveEvent*>(&event)) return takeMove(*move, place, context);
    if (const auto* button = dynamic_cast<const MouseButtonEvent*>(&event)) return takeButton(*button, place, context);
    if (const auto* wheel = dynamic_cast<const MouseWheelEvent*>(&event)) {
        pushPlace(place, wheel->modifiers);
        push({Wheel{wheel->dx, wheel->dy}, wheel->modifiers});
        return ours_ != 0 || (others_ == 0 && windowAt(context, x, y));
    }
    if (const auto* key = dynamic_cast<const KeyEvent*>(&event)) return takeKey(*key, context);
    if (const auto* typed = dynamic_cast<const TextInputEvent*>(&event)) {
        push({Text{typed->text}, std::nullopt});
        return context.IO.WantTextInput;
    }
    if (const auto* window = dynamic_cast<const WindowEvent*>(&event);
        window && window->kind == WindowEvent::Kind::FocusLost)
        releaseAll(); // the releases go to another window
    return false;
}

void ImguiInput::leave()
{
    if (ours_ == 0) pushPlace({-FLT_MAX, -FLT_MAX}, std::nullopt);
}

void ImguiInput::releaseAll()
{
    waiting_.clear();
    ours_ = others_ = 0;
    ourKeys_.clear();
    waiting_.push_back({AllUp{}, Modifiers{}});
}

/// Whether the frame can take this input as well, so that ImGui still sees each input for what it was.
bool ImguiInput::fits(const Input& input, const Frame& frame)
{
    if (std::holds_alternative<Place>(input.what)) return frame.buttons == 0 && !frame.wheeled;
    if (const auto* button = std::get_if<Button>(&input.what)) {
        const bool again = (frame.buttons & 1U << unsigned(button->index)) != 0;
        const bool endsDrag = !button->down && frame.moved; // the end point must be seen before the release
        return !again && !endsDrag && !frame.typed && !frame.acted;
    }
    if (std::holds_alternative<Wheel>(input.what)) return frame.buttons == 0;
    if (const auto* key = std::get_if<Key>(&input.what)) {
        // A letter is recognised by its text, so that it may go down and up in one frame: typing must not wait for
        // frames.
        const bool acts = isAction(input.modifiers, key->code, key->down);
        const bool again = contains(acts ? frame.keys : frame.actions, key->code);
        return !again && frame.buttons == 0 && !(frame.typed && acts);
    }
    if (std::holds_alternative<Text>(input.what)) return !frame.acted && frame.buttons == 0;
    return frame.buttons == 0 && frame.keys.empty() && !frame.typed; // AllUp
}

void ImguiInput::give(const Input& input, Frame& frame, ImGuiIO& io)
{
    if (const auto* place = std::get_if<Place>(&input.what)) {
        const ImVec2 now{float(place->x), float(place->y)};
        frame.moved = frame.moved || now.x != io.MousePos.x || now.y != io.MousePos.y;
        io.MousePos = now;
    } else if (const auto* button = std::get_if<Button>(&input.what)) {
        io.MouseDown[button->index] = button->down;
        frame.buttons |= 1U << unsigned(button->index);
    } else if (const auto* wheel = std::get_if<Wheel>(&input.what)) {
        io.MouseWheelH += float(wheel->dx);
        io.MouseWheel += float(wheel->dy);
        frame.wheeled = true;
    } else if (const auto* key = std::get_if<Key>(&input.what)) {
        io.KeysDown[static_cast<int>(key->code)] = key->down;
        frame.keys.push_back(key->code);
        if (isAction(input.modifiers, key->code, key->down)) {
            frame.actions.push_back(key->code);
            frame.acted = true;
        }
    } else if (const auto* typed = std::get_if<Text>(&input.what)) {
        io.AddInputCharactersUTF8(typed->text.c_str());
        frame.typed = true;
    } else {
        std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
        std::fill(std::begin(io.MouseDown), std::end(io.MouseDown), false);
        frame.acted = true;
    }
    if (!input.modifiers) return;
    io.KeyShift = input.modifiers->shift;
    io.KeyCtrl = input.modifiers->control;
    io.KeyAlt = input.modifiers->alt;
    io.KeySuper = input.modifiers->super;
}

void ImguiInput::apply(ImGuiIO& io)
{
    Frame frame;
    for (; !waiting_.empty() && fits(waiting_.front(), frame); waiting_.pop_front()) give(waiting_.front(), frame, io);
}

} // namespace filasofia::visual

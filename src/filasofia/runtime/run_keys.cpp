#include "filasofia/runtime/run_keys.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <array>

namespace filasofia::runtime {
namespace {

using event::KeyCode;

struct BoundKey {
    KeyCode key;
    RunAction action;
};
constexpr BoundKey kBound[] = {
    {KeyCode::Space, RunAction::Pause},    {KeyCode::N, RunAction::Step},       {KeyCode::R, RunAction::Reset},
    {KeyCode::F12, RunAction::Screenshot}, {KeyCode::P, RunAction::Screenshot}, {KeyCode::Escape, RunAction::Quit},
    {KeyCode::H, RunAction::Help},
};

// visual/orbit_camera.h handles the camera's lines; they are repeated here so that there is one list.
constexpr KeyLine kLines[] = {
    {"Left drag", "turn the camera"},
    {"Middle drag, Shift + left drag", "shift the camera"},
    {"Wheel", "nearer and farther"},
    {"Right drag, arrow keys", "move the hand of a haptic interface that is the mouse"},
    {"Ctrl + right drag, wheel", "turn that hand; the wheel turns it about its own axis"},
    {"Left click, right held", "the button of that hand: jaws close or open"},
    {"F", "frame all that is shown"},
    {"Home", "the camera back to where it was at the start"},
    {"Space", "pause and go on"},
    {"N", "one step, while paused"},
    {"R", "everything back to the start"},
    {"Ctrl + R", "read the scene file of `filasofia run` again"},
    {"F12, P", "write a picture into the working folder"},
    {"F1", "the inspector: rates, stages, bodies, forces"},
    {"H", "this list of keys"},
    {"Escape", "end the run"},
};

} // namespace

std::span<const KeyLine> keyLines() { return kLines; }

std::string keyHelp()
{
    std::size_t width = 0;
    for (const KeyLine& line : kLines) width = std::max(width, line.keys.size());
    std::string help;
    for (const auto& [keys, meaning] : kLines)
        help += text(keys, std::string(width + 2 - keys.size(), ' '), meaning, "\n");
    return help;
}

std::optional<RunAction> actionOf(const event::KeyEvent& key)
{
    const event::Modifiers& held = key.modifiers;
    if (!key.pressed || key.repeat || held.control || held.alt || held.super) return std::nullopt;
    const auto* found = std::ranges::find(kBound, key.key, &BoundKey::key);
    if (found == std::end(kBound)) return std::nullopt;
    return found->action;
}

} // namespace filasofia::runtime

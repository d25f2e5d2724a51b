#pragma once

#include "filasofia/event/input_events.h"

#include <deque>
#include <optional>
#include <variant>
#include <vector>

struct ImGuiContext;
struct ImGuiIO;

namespace filasofia::visual {

/// Input that ImGui has not seen yet. ImGui 1.86 looks once per frame at what is pressed: a click that begins and ends
/// between two frames would be lost, and a letter before a backspace would come after it. So each frame gets as much
/// input as keeps its meaning, and the rest waits for the next.
class ImguiInput {
public:
    /// Maps our keys to those that ImGui knows.
    static void mapKeys(ImGuiIO& io);

    /// Takes an event whose place is in pixels of the Gui. Returns true if it is for the Gui, so that nobody else
    /// should act on it. The context is as the last frame left it.
    bool take(const event::Event& event, double x, double y, const ImGuiContext& context);
    /// The mouse is over something else.
    void leave();
    /// Drops waiting input and releases all keys and buttons.
    void releaseAll();

    /// Gives a frame its part of the input.
    void apply(ImGuiIO& io);
    [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

private:
    struct Place {
        double x = 0.0, y = 0.0;
    };
    struct Button {
        int index = 0;
        bool down = false;
    };
    struct Wheel {
        double dx = 0.0, dy = 0.0;
    };
    struct Key {
        event::KeyCode code = event::KeyCode::Unknown;
        bool down = false;
    };
    struct Text {
        std::string text;
    };
    struct AllUp {};
    struct Input {
        std::variant<Place, Button, Wheel, Key, Text, AllUp> what;
        std::optional<event::Modifiers> modifiers; ///< not given: unchanged
    };
    struct Frame; ///< what a frame has been given so far

    bool takeMove(const event::MouseMoveEvent& move, Place place, const ImGuiContext& context);
    bool takeButton(const event::MouseButtonEvent& button, Place place, const ImGuiContext& context);
    bool takeKey(const event::KeyEvent& key, const ImGuiContext& context);
    void push(Input input);
    void pushPlace(Place place, std::optional<event::Modifiers> modifiers);
    static bool fits(const Input& input, const Frame& frame);
    static void give(const Input& input, Frame& frame, ImGuiIO& io);

    std::deque<Input> waiting_;
    unsigned ours_ = 0;                   ///< mouse buttons that were pressed on the Gui, one bit each
    unsigned others_ = 0;                 ///< those that were pressed elsewhere
    std::vector<event::KeyCode> ourKeys_; ///< keys that were pressed for the Gui
};

} // namespace filasofia::visual

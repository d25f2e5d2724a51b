#include "filasofia/filasofia.h"

#include "window/x11_person.h"

#include <imgui.h>

namespace typing_test {

using namespace filasofia;
using window::Person;
using window::VirtualDisplay;

TEST_CASE("a person clicks into a Gui of a real window, types")
{
    const VirtualDisplay display;
    Simulation sim({.window = {.title = "typing", .width = 320, .height = 240}});
    sim.show(sim.add(RigidBodyDef{.mesh = shapes::box({20_mm, 20_mm, 20_mm})}));
    void* native = nullptr;
    sim.useWindow([&](const window::WindowDef& def) {
        auto window = window::openWindow(def);
        native = window->nativeWindow();
        return window;
    });
    int keys = 0, clicks = 0; // events that reach the scene
    sim.on<KeyEvent>([&](const KeyEvent&) { ++keys; });
    sim.on<MouseButtonEvent>([&](const MouseButtonEvent&) { ++clicks; });
    char note[32] = "";
    bool writing = false;
    std::unique_ptr<Person> person;
    enum { Waiting, Clicking, Typing } doing = Waiting;
    sim.dress([&](visual::VisualServer& server) {
        server.add(GuiDef{.renderCallback = [&] {
            ImGui::SetNextWindowPos({10, 10});
            ImGui::SetNextWindowSize({200, 100});
            ImGui::Begin("Note");
            ImGui::InputText("text", note, sizeof note);
            writing = ImGui::IsItemActive();
            const ImVec2 low = ImGui::GetItemRectMin();
            ImGui::End();
            // The person sees the field, clicks into it and types as soon as it has the focus.
            if (doing == Waiting) {
                person = std::make_unique<Person>(native);
                person->moveMouse(int(low.x) + 20, int(low.y) + 8);
                person->button(1, true);
                person->button(1, false);
                doing = Clicking;
            } else if (doing == Clicking && writing) {
                doing = Typing;
            } else if (doing == Typing && std::string(note).empty() && ImGui::GetFrameCount() % 8 == 0) {
                for (const char* key : {"o", "k"}) {
                    person->key(key, true);
                    person->key(key, false);
                }
            }
            if (std::string(note).size() >= 2) sim.finish("typed");
        }});
    });
    const RunReport report = sim.run({.backend = visual::Backend::Window, .seconds = 60});
    CHECK(report.finished == "typed");
    CHECK(std::string(note).substr(0, 2) == "ok");
    CHECK(keys == 0);
    CHECK(clicks == 0);
}

} // namespace typing_test

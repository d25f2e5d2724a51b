#include "filasofia/core/error.h"
#include "gui_scene.h"

namespace gui_test {

using namespace filasofia;
using namespace filasofia::visual;
using event::KeyCode;

TEST_CASE("a click presses a button, however fast it was")
{
    GuiScene scene;
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y); // all between two frames
    scene.person.look();
    CHECK(scene.panel.clicks == 1);
    scene.person.click(scene.panel.boxAt.x, scene.panel.boxAt.y);
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y);
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y);
    scene.person.look(12);
    CHECK(scene.panel.clicks == 3);
    CHECK(scene.panel.cutting);
}

TEST_CASE("a drag moves a slider, and a window by its title")
{
    GuiScene scene;
    scene.person.move(scene.panel.sliderAt.x, scene.panel.sliderAt.y);
    scene.person.press();
    scene.person.move(scene.panel.sliderAt.x + 300, scene.panel.sliderAt.y); // far beyond its end
    scene.person.release();
    scene.person.look(6);
    CHECK(scene.panel.force == Approx(5.0F));
    scene.person.move(100, 18);
    scene.person.press();
    scene.person.move(120, 48);
    scene.person.look();
    scene.person.release();
    scene.person.look();
    CHECK(scene.panel.place.x == 30.0F);
    CHECK(scene.panel.place.y == 40.0F);
}

TEST_CASE("typed text arrives in the order of the keys between it")
{
    GuiScene scene;
    scene.person.click(scene.panel.noteAt.x, scene.panel.noteAt.y);
    scene.person.look();
    scene.person.type("a");
    scene.person.type("x");
    scene.person.stroke(KeyCode::Backspace);
    scene.person.type("b\xc3\xa9"); // b, and e with an acute accent
    scene.person.stroke(KeyCode::Home);
    scene.person.type("0");
    scene.person.look(12);
    CHECK(std::string(scene.panel.note) == "0ab\xc3\xa9");
    scene.person.stroke(KeyCode::A, {.control = true}); // select all, cut, paste twice
    scene.person.stroke(KeyCode::X, {.control = true});
    scene.person.stroke(KeyCode::V, {.control = true});
    scene.person.stroke(KeyCode::V, {.control = true});
    scene.person.look(16);
    CHECK(std::string(scene.panel.note) == "0ab\xc3\xa9"
                                           "0ab\xc3\xa9");
}

TEST_CASE("a thousand typed letters arrive, all of them")
{
    VisualServer server({.backend = Backend::Null, .width = 320, .height = 240});
    std::vector<char> text(2048, '\0');
    server.add(GuiDef{.renderCallback =
                          [&] {
                              ImGui::Begin("long");
                              ImGui::SetKeyboardFocusHere();
                              ImGui::InputText("text", text.data(), text.size());
                              ImGui::End();
                          }},
               server.add(ViewDef{}, server.add(CameraDef{})));
    GuiPerson person(server);
    person.look();
    std::string typed;
    for (int i = 0; i < 1000; ++i) {
        const char letter = static_cast<char>('a' + i % 26);
        const auto code = static_cast<KeyCode>(static_cast<int>(KeyCode::A) + i % 26);
        person.key(code, true);
        person.type(std::string(1, letter));
        person.key(code, false);
        typed += letter;
    }
    person.look(100);
    CHECK(std::string(text.data()) == typed);
}

TEST_CASE("the Gui takes its own events and leaves the rest to the scene")
{
    GuiScene scene;
    CHECK_FALSE(scene.person.move(300, 200));
    CHECK_FALSE(scene.person.press());      // beside the panel
    CHECK_FALSE(scene.person.move(50, 50)); // that drag stays with the scene, even over the panel
    CHECK_FALSE(scene.person.release());
    CHECK(scene.person.move(50, 100));
    CHECK(scene.person.wheel(1.0));
    CHECK(scene.person.press());
    CHECK(scene.person.move(310, 200)); // and this one with the Gui
    CHECK(scene.person.release());
    CHECK_FALSE(scene.person.move(310, 201));
    CHECK_FALSE(scene.person.wheel(1.0));
    CHECK_FALSE(scene.person.key(KeyCode::H, true));
    CHECK_FALSE(scene.person.key(KeyCode::H, false));
    CHECK_FALSE(scene.person.type("h"));
    scene.person.look(12);

    CHECK_FALSE(scene.person.key(KeyCode::W, true)); // pressed for the scene, so its release is the scene's
    scene.person.click(scene.panel.noteAt.x, scene.panel.noteAt.y);
    scene.person.look();
    CHECK(scene.person.type("h"));
    CHECK(scene.person.key(KeyCode::H, true));
    CHECK_FALSE(scene.person.key(KeyCode::W, false));
    scene.person.stroke(KeyCode::Escape);
    scene.person.look();
    CHECK(scene.person.key(KeyCode::H, false)); // its press was taken by the Gui
    CHECK_FALSE(scene.person.key(KeyCode::H, true));
}

TEST_CASE("a Gui in a corner of the window counts its pixels from there")
{
    GuiScene scene({.viewport = {.left = 0.25, .top = 0.25, .width = 0.75, .height = 0.75}});
    CHECK_FALSE(scene.person.move(50, 50)); // left of the view
    scene.person.click(80 + scene.panel.buttonAt.x, 60 + scene.panel.buttonAt.y);
    scene.person.look();
    CHECK(scene.panel.clicks == 1);
    scene.server.resize(640, 480);
    scene.person.look(1);
    scene.person.click(160 + scene.panel.buttonAt.x, 120 + scene.panel.buttonAt.y);
    scene.person.look();
    CHECK(scene.panel.clicks == 2);
}

TEST_CASE("a Gui over the whole window is there without any view")
{
    VisualServer server({.backend = Backend::Null, .width = 320, .height = 240});
    Panel panel;
    Gui& gui = server.add(GuiDef{.renderCallback = [&] { panel.draw(); }});
    CHECK(gui.view() == nullptr);
    GuiPerson person(server);
    person.look();
    CHECK_FALSE(server.wantsText());
    person.click(panel.noteAt.x, panel.noteAt.y);
    person.look();
    CHECK(server.wantsText());
    person.click(panel.buttonAt.x, panel.buttonAt.y);
    person.look();
    CHECK(panel.clicks == 1);
    CHECK_FALSE(server.wantsText());
}

TEST_CASE("an upper Gui keeps the mouse from a lower one, a hidden one does not")
{
    GuiScene scene;
    int upper = 0;
    Gui& above = scene.server.add(GuiDef{.name = "above",
                                         .renderCallback =
                                             [&] {
                                                 ImGui::SetNextWindowPos({0, 0});
                                                 ImGui::SetNextWindowSize({320, 240});
                                                 ImGui::Begin("all");
                                                 if (ImGui::IsMouseClicked(0)) ++upper;
                                                 ImGui::End();
                                             }},
                                  *scene.gui->view());
    scene.person.look();
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y);
    scene.person.look();
    CHECK(scene.panel.clicks == 0);
    CHECK(upper == 1);
    above.setVisible(false);
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y);
    scene.person.look();
    CHECK(scene.panel.clicks == 1);
    CHECK(upper == 1);
    scene.server.remove(above);
    CHECK_THROWS_WITH(scene.server.remove(*scene.gui->view()), Catch::Contains("gui 'panel' lies on it"));
}

TEST_CASE("keys and buttons are released when the window loses the focus")
{
    GuiScene scene;
    scene.person.move(scene.panel.sliderAt.x, scene.panel.sliderAt.y);
    scene.person.press();
    scene.person.look();
    event::WindowEvent lost;
    lost.kind = event::WindowEvent::Kind::FocusLost;
    CHECK_FALSE(scene.server.handle(lost));
    scene.person.look();
    const float before = scene.panel.force;
    CHECK_FALSE(scene.person.move(310, 230));
    scene.person.look();
    CHECK(scene.panel.force == before);
}

TEST_CASE("wrong Guis are Errors")
{
    GuiScene scene, other;
    View& view = *scene.gui->view();
    CHECK_THROWS_WITH(scene.server.add(GuiDef{.name = "tiny", .scale = 0.0}, view),
                      "gui 'tiny': scale must be in [0.5, 8], got 0");
    CHECK_THROWS_WITH(scene.gui->setScale(std::nan("")), Catch::Contains("gui 'panel': scale"));
    CHECK_THROWS_WITH(scene.server.setGuiScale(9.0), "visual server: guiScale must be in [0.5, 8], got 9");
    CHECK_THROWS_WITH(scene.server.add(GuiDef{}, *other.gui->view()), Catch::Contains("belongs to another server"));
    CHECK_THROWS_WITH(scene.server.remove(*other.gui), Catch::Contains("does not belong to this server"));
    CHECK_THROWS_WITH(scene.server.add(CanvasDef{.name = "c", .width = 0.0}),
                      "canvas 'c': width must be in (0, 10000] m, got 0");
    CHECK_THROWS_WITH(scene.server.add(CanvasDef{.name = "c", .height = std::nan("")}), Catch::Contains("height"));
    CHECK_THROWS_WITH(scene.server.add(CanvasDef{.name = "c", .pixelWidth = 100000}),
                      "canvas 'c': pixelWidth must be in [16, 4096] px, got 100000");
    scene.server.render();                        // drawing goes on
    CHECK(ImGui::GetCurrentContext() == nullptr); // no context is left behind
}

} // namespace gui_test

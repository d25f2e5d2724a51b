#include "gui_person.h"
#include "little_scene.h"
#include "pictures.h"

#include <imgui.h>

namespace gui_picture_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

void vitalSigns(const char* patient)
{
    float curve[80];
    for (int i = 0; i < 80; ++i) {
        const double beat = std::fmod(0.05 * i, 1.0);
        curve[i] =
            float(std::exp(-400 * (beat - 0.3) * (beat - 0.3)) - 0.25 * std::exp(-300 * (beat - 0.4) * (beat - 0.4)));
    }
    ImGui::Text("%s", patient);
    ImGui::TextColored({0.3F, 0.8F, 0.8F, 1.0F}, "72 /min   120/80 mmHg");
    ImGui::PlotLines("##ecg", curve, 80, 0, nullptr, -0.4F, 1.1F, {ImGui::GetContentRegionAvail().x, 60});
    ImGui::ProgressBar(0.62F, {-1, 0}, "fluid 62 %");
}

/// The items that a person uses in the picture test.
struct Tools {
    char note[32] = "";
    float grip = 1.5F;
    bool cut = false;
    int taken = 0;

    void draw()
    {
        ImGui::SetNextWindowPos({8, 8}, ImGuiCond_Once);
        ImGui::SetNextWindowSize({190, 148}, ImGuiCond_Once);
        ImGui::Begin("Instruments");
        ImGui::PushItemWidth(100);
        ImGui::InputText("note", note, sizeof note);
        ImGui::SliderFloat("grip", &grip, 0.0F, 5.0F, "%.1f N");
        ImGui::PopItemWidth();
        ImGui::Checkbox("cutting", &cut);
        ImGui::SameLine();
        if (ImGui::Button("Biopsy")) ++taken;
        ImGui::Text("%d taken", taken);
        ImGui::End();
    }
};

} // namespace

TEST_CASE("a Gui that was typed into, clicked and dragged looks as it should")
{
    LittleScene scene;
    Tools tools;
    scene.server.add(GuiDef{.name = "tools", .renderCallback = [&] { tools.draw(); }}, *scene.look.view);
    GuiPerson person(scene.server);
    person.look();
    checkPicture(scene.server.capture(), "gui_untouched");
    person.click(60, 50); // into the note
    person.look();
    for (const char* letter : {"p", "o", "l", "y", "p"}) person.type(letter);
    person.look();
    person.move(60, 80); // the slider
    person.press();
    person.move(100, 80);
    person.look();
    person.release();
    person.click(30, 106);  // the checkbox
    person.click(130, 106); // the button, twice
    person.click(130, 106);
    person.look(10);
    CHECK(std::string(tools.note) == "polyp");
    CHECK(tools.grip > 3.0F);
    CHECK(tools.cut);
    CHECK(tools.taken == 2);
    checkPicture(scene.server.capture(), "gui_used");
}

TEST_CASE("a Gui is cut off at its view's edges and drawn larger on a finer screen")
{
    LittleScene scene;
    scene.look.view->set({.name = "corner",
                          .viewport = {.left = 0.5, .top = 0.5, .width = 0.5, .height = 0.5},
                          .quality = Quality::Low});
    scene.server.setGuiScale(1.5);
    scene.server.add(GuiDef{.name = "large",
                            .renderCallback =
                                [] {
                                    ImGui::SetNextWindowPos({60, 40});
                                    ImGui::SetNextWindowSize({200, 70});
                                    ImGui::Begin("Large");
                                    ImGui::TextUnformatted("reaches beyond");
                                    ImGui::End();
                                }},
                     *scene.look.view);
    const Image image = scene.server.capture();
    CHECK(brightnessAt(image, 100, 60) == 0);
    checkPicture(image, "gui_scaled");
    scene.server.setGuiScale(1.0);
    CHECK(scene.server.capture() != image);
}

TEST_CASE("a Canvas in the scene is sharp, and hidden by bodies in front of it")
{
    LittleScene scene;
    lookFromFront(scene);
    Canvas& canvas = scene.server.add(CanvasDef{.name = "monitor",
                                                .width = 0.24,
                                                .height = 0.14,
                                                .pixelWidth = 320,
                                                .pixelHeight = 187,
                                                .scale = 1.25,
                                                .renderCallback = [] { vitalSigns("Patient 7"); }});
    scene.body.setPose({{-0.07, -0.04, 0}, {}});
    canvas.setPose({{0.03, 0.03, -0.02}, normalized(Quat{0.98, 0.05, -0.2, 0.0})});
    const Image image = scene.server.capture();
    checkPicture(image, "canvas");
    canvas.setVisible(false);
    const Image without = scene.server.capture();
    CHECK(difference(image, without) > 40);
    canvas.setVisible(true);
    CHECK(scene.server.capture() == image);
    scene.body.setPose({{0.02, 0, 0}, {}});
    canvas.attachTo(scene.body); // follows the body
    CHECK(scene.server.capture() != image);
    scene.server.remove(canvas);
    scene.body.setPose({{-0.07, -0.04, 0}, {}});
    CHECK(scene.server.capture() == without);
}

TEST_CASE("a Canvas follows its callback, and white on it is white")
{
    LittleScene scene;
    lookFromFront(scene);
    scene.body.setVisible(false);
    float red = 1.0F;
    Canvas& canvas = scene.server.add(
        CanvasDef{.pixelWidth = 64, .pixelHeight = 48, .window = false, .renderCallback = [&] {
                      ImGui::GetBackgroundDrawList()->AddRectFilled({0, 0}, {64, 48}, ImColor(red, 1.0F, 1.0F));
                  }});
    const Image white = scene.server.capture();
    CHECK(brightnessAt(white, 160, 120) >= 225);
    CHECK(brightnessAt(white, 5, 5) == 0);
    red = 0.0F;
    const auto cyan = scene.server.capture().pixel(160, 120);
    CHECK(cyan[0] + 40 < cyan[1]); // not 0: the view's tone mapping desaturates such bright colours
    canvas.setRenderCallback({});
    CHECK(brightness(scene.server.capture()) == 0.0);
}

TEST_CASE("debug drawings look as they should: hidden by the body, or on top")
{
    LittleScene scene;
    lookFromFront(scene);
    DebugDraw& debug = scene.server.debug();
    const auto draw = [&] {
        debug.line({-0.12, -0.02, 0}, {0.12, -0.02, 0}, {.color = {0.1, 0.9, 0.2}, .width = 3});
        debug.line({-0.12, -0.03, 0}, {0.12, -0.03, 0}, {.color = {0.9, 0.9, 0.2}, .width = 1, .onTop = true});
        debug.point({0.09, 0.05, 0}, {.color = {1, 1, 1}, .width = 12});
        debug.arrow({-0.1, 0.02, 0.03}, {-0.03, 0.06, 0.03});
        debug.frame({{0.02, 0.01, 0.05}, {}}, 0.04, {.width = 2.5, .onTop = true});
        debug.box({{-0.052, -0.052, -0.052}, {0.052, 0.052, 0.052}}, {}, {.color = {0.2, 0.5, 1}, .width = 1.5});
        debug.text({0.09, 0.05, 0}, "2.5 N", {.color = {1, 1, 1}});
    };
    draw();
    const Image image = scene.server.capture();
    checkPicture(image, "debug_drawings");
    draw();
    CHECK(scene.server.capture() == image);
    scene.look.view->set({.name = "left", .viewport = {.width = 0.5}, .quality = Quality::Low});
    scene.server.add(ViewDef{.name = "right", .viewport = {.left = 0.5, .width = 0.5}, .quality = Quality::Low},
                     *scene.look.camera);
    draw();
    const Image both = scene.server.capture();
    CHECK(difference(both, image) > 40);
    for (int x = 20; x < 140; x += 30) CHECK(both.pixel(x, 140) == both.pixel(x + 160, 140)); // in every view
}

TEST_CASE("an oblique debug line is as wide at its ends as in its middle, in a view of any place")
{
    LittleScene scene;
    lookFromFront(scene);
    scene.body.setVisible(false);
    scene.server.debug().line({-0.1, -0.06, 0.0}, {-0.02, 0.05, 0.02}, {.width = 14});
    const Image image = scene.server.capture();
    const auto widthAt = [&](int y) {
        int lit = 0;
        for (int x = 0; x < image.width; ++x) lit += brightnessAt(image, x, y) > 60;
        return lit;
    };
    CHECK(widthAt(90) > 14); // an oblique section
    CHECK(widthAt(90) < 20); // wider by at most 1 / cos of the slope
    for (int y = 95; y < 150; ++y) CHECK(std::abs(widthAt(y) - widthAt(90)) <= 2);
}

TEST_CASE("Guis, Canvases and debug drawings come and go, and servers with them")
{
    LittleScene first;
    const Image before = first.server.capture();
    std::vector<Gui*> guis;
    std::vector<Canvas*> canvases;
    for (int i = 0; i < 40; ++i) {
        const auto text = [] { ImGui::Text("text"); };
        guis.push_back(&first.server.add(GuiDef{.renderCallback = text}));
        canvases.push_back(&first.server.add(CanvasDef{.pixelWidth = 64, .pixelHeight = 64, .renderCallback = text}));
        if (i % 3 == 0) first.server.render();
        if (i % 2 == 0) {
            first.server.remove(*guis.front());
            guis.erase(guis.begin());
            first.server.debug().text({}, "gone");
        }
    }
    CHECK(first.server.capture() != before);
    for (Gui* gui : guis) first.server.remove(*gui);
    for (Canvas* canvas : canvases) first.server.remove(*canvas);
    CHECK(first.server.capture() == before);
    for (int i = 0; i < 5; ++i) {
        LittleScene scene;
        scene.server.add(GuiDef{.renderCallback = [] { ImGui::ShowDemoWindow(); }});
        scene.server.add(CanvasDef{.renderCallback = [] { ImGui::Text("text"); }});
        scene.server.debug().point({}, {.keep = true});
        CHECK(scene.server.capture() != before);
    }
}

} // namespace gui_picture_test

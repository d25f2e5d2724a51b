#include "gui_scene.h"

#include <atomic>
#include <thread>

namespace render_callback_test {

using namespace filasofia;
using namespace filasofia::visual;

TEST_CASE("a callback that throws ends alone, and is replaced by one that does not")
{
    const Logged log;
    GuiScene scene;
    int calls = 0;
    scene.gui->setRenderCallback([&] {
        ++calls;
        ImGui::Begin("half"); // its End is never reached
        throw std::runtime_error("no forceps");
    });
    scene.person.look(5);
    CHECK(calls == 1);
    REQUIRE(log.lines.size() >= 1);
    CHECK(log.lines[0] == "gui 'panel': renderCallback: no forceps; it is not called again");
    scene.gui->setRenderCallback([&] { throw 7; });
    scene.person.look(5);
    CHECK(log.lines.back().find("gui 'panel': renderCallback: it threw something that is not a std::exception") == 0);
    scene.gui->setRenderCallback([&] { scene.panel.draw(); });
    scene.person.look();
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y);
    scene.person.look();
    CHECK(scene.panel.clicks == 1);
}

TEST_CASE("what a callback begins and does not end is ended for it, and logged once")
{
    const Logged log;
    GuiScene scene;
    int calls = 0;
    scene.gui->setRenderCallback([&] {
        ++calls;
        ImGui::Begin("open");
        ImGui::BeginChild("inner");
        ImGui::TreePush("deep");
        ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 0.5F);
    });
    scene.person.look(5);
    CHECK(calls == 5);
    REQUIRE(log.lines.size() == 1);
    CHECK(log.lines[0].find("missing EndChild") != std::string::npos);
}

TEST_CASE("ImGui's own assertions end the callback, not the program")
{
    const auto wrong = GENERATE(0, 1, 2, 3, 4, 5);
    CAPTURE(wrong);
    const Logged log;
    GuiScene scene;
    int calls = 0;
    scene.gui->setRenderCallback([&] {
        ++calls;
        if (wrong == 0) ImGui::End();
        if (wrong == 1) ImGui::PopID();
        if (wrong == 2) ImGui::Begin("");
        if (wrong == 3) ImGui::NewFrame();
        if (wrong == 4) ImGui::PopStyleColor();
        if (wrong == 5) {
            ImGui::SetNextWindowSize({200, 100});
            ImGui::Begin("a");
            ImGui::BeginTable("t", 2);
            ImGui::End();
        }
    });
    scene.person.look(3);
    CHECK(calls == 1);
    REQUIRE(!log.lines.empty());
    CHECK(log.lines[0].find("gui 'panel': renderCallback: ImGui was called wrongly: ") == 0);
    scene.gui->setRenderCallback([&] { scene.panel.draw(); });
    scene.person.look();
    scene.person.click(scene.panel.buttonAt.x, scene.panel.buttonAt.y);
    scene.person.look();
    CHECK(scene.panel.clicks == 1);
}

TEST_CASE("a callback may be replaced from another thread, and the old one never runs after that")
{
    GuiScene scene;
    std::atomic<bool> stop = false, wrong = false;
    std::atomic<int> replaced = 0;
    std::thread other([&] {
        while (!stop) {
            auto alive = std::make_shared<std::atomic<bool>>(true);
            scene.gui->setRenderCallback([alive, &wrong] {
                ImGui::Begin("a");
                ImGui::Text("text");
                ImGui::End();
                if (!*alive) wrong = true;
            });
            scene.gui->setRenderCallback({});
            *alive = false; // the old callback must not run any more
            ++replaced;
        }
    });
    for (int i = 0; i < 200 || replaced < 100; ++i) scene.server.render();
    stop = true;
    other.join();
    CHECK_FALSE(wrong);
}

TEST_CASE("a callback may replace itself")
{
    GuiScene scene;
    int first = 0, second = 0;
    scene.gui->setRenderCallback([&, name = std::string("lives to its end")] {
        scene.gui->setRenderCallback([&] { ++second; });
        first += int(name.size());
    });
    scene.person.look(3);
    CHECK(first == 16);
    CHECK(second == 2);
}

TEST_CASE("a callback may not draw or remove its caller, and can add more")
{
    const Logged log;
    GuiScene scene;
    scene.gui->setRenderCallback([&] { scene.server.render(); });
    scene.person.look(1);
    scene.gui->setRenderCallback([&] { scene.server.remove(*scene.gui); });
    scene.person.look(1);
    REQUIRE(log.lines.size() == 2);
    CHECK(log.lines[0].find("render() must not be called from a renderCallback") != std::string::npos);
    CHECK(log.lines[1].find("remove() must not be called from a renderCallback") != std::string::npos);
}

} // namespace render_callback_test

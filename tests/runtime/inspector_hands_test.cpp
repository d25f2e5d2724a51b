#include "filasofia/runtime/inspector_hands.h"

#include "filasofia/filasofia.h"

#include "runtime/fake_device.h"
#include "visual/gui_person.h"

#include <imgui.h>

namespace inspector_hands_test {

using namespace filasofia;
using namespace filasofia::runtime;

TEST_CASE("originThrough() puts a hand at a place, whatever scale and directions")
{
    const Quat turn = axisAngle({1, 2, 3}, 0.7);
    const Vec3 place{0.1, 0.2, 0.3}, hand{0.01, -0.02, 0.03};
    const Pose origin = originThrough(place, hand, 2.5, turn);
    CHECK(distance(device::inScene({.scale = 2.5, .origin = origin}, {{hand, {}}}).pose.position, place) < 1e-15);
}

TEST_CASE("the inspector shows a hand, and its button puts the hand where the body is")
{
    Simulation::Impl impl({});
    const BodyId body = impl.physics.add(
        RigidBodyDef{.name = "tool", .elements = {{{0.1, 0, 0}, {}}}, .dynamic = true, .mass = GivenInertia{}});
    const HapticId hand = impl.haptics.add({.origin = Pose{}, .body = body}, std::make_unique<FakeDevice>([](double) {
                                               return device::DeviceSample{.hand = {{{0.02, 0, 0}, {}}}};
                                           }),
                                           impl.physics);
    impl.haptics.begin({.headless = true}, {.rate = 1000}, impl.clock, [](auto) {});
    const auto step = [&](int count) {
        for (int i = 0; i < count; ++i) {
            impl.beforeStep(1e-3);
            impl.afterStep(impl.physics.step(1e-3));
        }
    };
    step(5);
    visual::VisualServer visual({.backend = Backend::Null, .width = 800, .height = 600});
    InspectorHands hands(impl);
    CHECK(hands.any());
    ImVec2 low, high;
    visual.add(GuiDef{.name = "hands", .renderCallback = [&] {
                          ImGui::SetNextWindowPos({0, 0});
                          ImGui::SetNextWindowSize({500, 580});
                          ImGui::Begin("hands");
                          hands.draw();
                          low = ImGui::GetItemRectMin(); // the button is the last item
                          high = ImGui::GetItemRectMax();
                          ImGui::End();
                      }});
    visual::GuiPerson person(visual);
    person.look();
    REQUIRE(high.x > low.x);
    const Vec3 before = impl.physics.latest()->rigidBody(body)->poses[0].position;
    CHECK(before.x > 0.09);
    person.click(0.5 * (low.x + high.x), 0.5 * (low.y + high.y));
    person.look();
    CHECK(distance(impl.haptics.def(hand).origin->position, before - Vec3{0.02, 0, 0}) < 1e-12);
    step(5);
    CHECK(distance(impl.haptics.state(hand).hand.pose.position, before) < 1e-12);
    impl.haptics.end();
}

} // namespace inspector_hands_test

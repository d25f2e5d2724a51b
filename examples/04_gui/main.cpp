#include <filasofia/filasofia.h>

#include <imgui.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {"Gui", 640, 480}});
    SoftBodyDef def{.name = "tissue", .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {10, 6, 10}), .collision = {{}}};
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}}; // pinned at its bottom
    sim.show(sim.add(def), {.subdivision = 2});
    RigidBodyDef tool{.name = "probe", .elements = {{{0, 45_mm, 0}}}, .mesh = shapes::capsule(4_mm, 40_mm)};
    tool.collision = {{}};
    const BodyId probe = sim.add(tool);
    sim.show(probe, {.material = MetalMaterial{.roughness = 0.5}});
    std::atomic<float> depth = 7.0f, force = 0.0f; // [mm], [N]: physics and events run in other threads
    const auto poseAt = [&](double t) { return Pose{{0, 39_mm - 1_mm * depth * std::min(2.0 * t, 1.0), 0}}; };
    sim.everyStep([&](double t) { sim.physics().setPose(probe, poseAt(t)); });
    sim.on<ContactEvent>([&](const ContactEvent& touch) { force = static_cast<float>(touch.pair.normalForce); });
    const auto panel = [&] {
        ImGui::SetNextWindowPos({12, 12});
        ImGui::Begin("Probe", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
        if (float asked = depth; ImGui::SliderFloat("depth", &asked, 0.0f, 12.0f, "%.1f mm")) depth = asked;
        ImGui::ProgressBar(force / 2.0f, {}, "");
        ImGui::End();
    };
    sim.show(GuiDef{.renderCallback = panel});
    sim.dress([&](VisualServer& server) {
        addEndoscopeLook(server, {{-30_mm, -12_mm, -30_mm}, {30_mm, 44_mm, 30_mm}});
        CanvasDef label{.width = 22_mm, .height = 9_mm, .pixelWidth = 220, .pixelHeight = 90, .scale = 3};
        label.renderCallback = [&] { ImGui::Text("%.2f N", static_cast<double>(force)); };
        sim.follow(server.add(label), probe, {.offset = {{17_mm, -6_mm, 0}}});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1000: see --help
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 1.0 || (force > 0.3f && force < 2.0f) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}

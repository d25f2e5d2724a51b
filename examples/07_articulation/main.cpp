#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {.title = "Jaws"}, .look = {.around = Box{{-0.02, 0, -0.01}, {0.02, 0.07, 0.01}}}});
    SoftBodyDef soft{.name = "cube", .mesh = shapes::block({14_mm, 14_mm, 14_mm}), .collision = {{}}, .friction = 0.6};
    soft.pose.position.y = 7.2_mm;
    const BodyId cube = sim.add(soft);
    RigidBodyDef table{.name = "table", .mesh = shapes::box({60_mm, 10_mm, 40_mm}), .collision = {{}}};
    table.elements = {{{0, -5_mm, 0}}};
    // A shaft and two jaws on hinges that close with 3 N mm each.
    RigidBodyDef tool{.name = "gripper", .mesh = shapes::box({3_mm, 28_mm, 10_mm}), .mass = Density{7800}};
    for (const int side : {1, -1}) {
        JointDef hinge{.child = side > 0 ? 1 : 2, .start = side * 30_deg, .command = JointForce{-0.003 * side}};
        hinge.parentOffset.position = {side * 5_mm, -20_mm, 0};
        hinge.childOffset.position.y = 12_mm;
        hinge.damping = 0.002;
        tool.articulation.joints.push_back(hinge);
        tool.collision.push_back({.element = hinge.child});
    }
    const BodyId gripper = sim.add(tool);
    sim.show(gripper, {.surface = shapes::cylinder(6_mm, 40_mm), .material = MetalMaterial{}});
    for (const int jaw : {1, 2}) sim.show(gripper, {.surface = tool.mesh, .element = jaw, .material = MetalMaterial{}});
    sim.show(cube, {.subdivision = 1});
    sim.show(sim.add(table), {.material = TissueMaterial{.baseColor = {0.1, 0.3, 0.3}, .wetness = 0, .vessels = 0}});
    sim.everyStep([&](double time) { // closed by 0.5 s, lifted from 0.7 s to 1.3 s
        sim.physics().setPose(gripper, {{0, 50_mm + 30_mm * std::clamp((time - 0.7) / 0.6, 0.0, 1.0), 0}});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1500: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const auto& jaw = frame->rigidBody(gripper)->joints[0];
    const auto lowest = std::ranges::min(frame->softBody(cube)->positions, {}, &Vec3::y);
    std::printf("%.2f N mm on a jaw, the cube is %.1f mm above the table\n", 1e3 * jaw.load, lowest.y * 1e3);
    return frame->time < 1.4 || (jaw.load > 0.0025 && lowest.y > 25_mm && lowest.y < 31_mm) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}

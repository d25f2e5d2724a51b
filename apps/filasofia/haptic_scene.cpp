#include "apps/filasofia/haptic_scene.h"

namespace filasofia::app {

void addHaptics(Simulation& sim, int subdivision)
{
    const BodyId tissue = sim.add(SoftBodyDef{.name = "tissue",
                                              .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {10, 6, 10}),
                                              .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.4},
                                              .attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}},
                                              .collision = {{}}});
    const BodyId tool = sim.add(RigidBodyDef{.name = "tool",
                                             .elements = {{{0, 40_mm, 0}, {}}},
                                             .mesh = shapes::capsule(6_mm, 30_mm),
                                             .dynamic = true,
                                             .mass = TotalMass{0.05},
                                             .gravity = false,
                                             .collision = {{}}});
    sim.show(tissue, {.subdivision = subdivision});
    sim.show(tool, {.material = MetalMaterial{}});
    sim.add(HapticInterfaceDef{.name = "hand",
                               .device = ScriptedDevice{.motion = asset("motions/press.csv"), .loop = true},
                               .body = tool,
                               .coupling = {.linearStiffness = 400}});
}

} // namespace filasofia::app

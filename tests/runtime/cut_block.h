#pragma once

#include "filasofia/filasofia.h"

#include <algorithm>
#include <array>

namespace filasofia::runtime {

/// A block whose lower side is held, and an edge that cuts it from above within 0.2 s.
struct CutBlock {
    Simulation sim;
    BodyId tissue, knife;

    CutBlock(int threads, std::array<int, 3> cells) : sim(SimulationDef{.physics = {.rate = 500, .threads = threads}})
    {
        tissue = sim.add(SoftBodyDef{.name = "tissue",
                                     .mesh = shapes::block({40_mm, 12_mm, 30_mm}, cells),
                                     .attachments = {{.box = Box{{-1, -1, -1}, {1, -5.9_mm, 1}}}},
                                     .dynamicTopology = true});
        RigidBodyDef blade{.name = "knife"};
        blade.collision = {{.mesh = shapes::sheet(20_mm, 20_mm, {1, 1}), .cutting = true}};
        blade.elements = {{{0, 40_mm, 0}, upright()}};
        knife = sim.add(blade);
        sim.everyStep([this](double time) {
            sim.physics().setPose(knife, {{0, 40_mm - std::min(0.2, time) * 165_mm, 0}, upright()});
        });
    }
    static Quat upright() { return axisAngle({1, 0, 0}, 90_deg); }
};

} // namespace filasofia::runtime

#include "filasofia/prefab/fingers.h"

#include <utility>

namespace filasofia::prefab {

void Fingers::reach(runtime::Simulation& simulation, BodyId body, int firstElement, const frame::SoftBodyFrame& thread,
                    std::vector<int> those)
{
    open(simulation);
    nodes = std::move(those);
    for (const int node : nodes)
        simulation.physics().setPose(body, Pose{thread.positions[static_cast<std::size_t>(node)]}, firstElement++);
}

void Fingers::close(runtime::Simulation& simulation, BodyId body, int firstElement, BodyId thread, double stiffness)
{
    for (const int node : nodes)
        grips.push_back(simulation.physics().attach(
            thread, {.nodes = {node}, .stiffness = stiffness, .to = body, .element = firstElement++}));
}

void Fingers::open(runtime::Simulation& simulation)
{
    for (const AttachmentId grip : grips) simulation.physics().release(grip);
    nodes.clear();
    grips.clear();
}

} // namespace filasofia::prefab

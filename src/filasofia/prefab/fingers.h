#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/runtime/simulation.h"

#include <vector>

namespace filasofia::prefab {

/// Fingers that hold nodes of a thread where they are. They touch nothing.
struct Fingers {
    std::vector<int> nodes = {};
    std::vector<AttachmentId> grips = {};

    /// Brings elements of a body to these nodes, from this element on; close() may follow in the next step.
    void reach(runtime::Simulation& simulation, BodyId body, int firstElement, const frame::SoftBodyFrame& thread,
               std::vector<int> those);
    void close(runtime::Simulation& simulation, BodyId body, int firstElement, BodyId thread, double stiffness);
    void open(runtime::Simulation& simulation);
};

} // namespace filasofia::prefab

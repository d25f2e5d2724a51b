#pragma once

#include "filasofia/core/body_id.h"

#include <sofa/simulation/Node.h>

namespace filasofia::sofaengine {

/// An engine that has a graph of SOFA, for tune().
class GraphOwner {
public:
    virtual ~GraphOwner() = default;
    [[nodiscard]] virtual ::sofa::simulation::Node& root() const = 0;
    [[nodiscard]] virtual ::sofa::simulation::Node* nodeOf(BodyId id) const = 0; ///< null if there is none

    GraphOwner() = default;
    GraphOwner(const GraphOwner&) = delete;
    GraphOwner& operator=(const GraphOwner&) = delete;
};

/// One step of a whole graph. False, with a line in the log, if it ended with an exception.
bool animate(::sofa::simulation::Node& root, double dt);

} // namespace filasofia::sofaengine

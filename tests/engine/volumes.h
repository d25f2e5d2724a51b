#pragma once

#include "filasofia/engine/body/nodal_volume.h"

namespace filasofia::engine {

/// [J] The energy of the volumes of nodes, by its formula.
inline double nodalEnergy(const SoftModel& model, const std::vector<Vec3>& x)
{
    const std::vector<double> changes = volumeChanges(model, x);
    double sum = 0.0;
    for (const FemElement& element : model.elements)
        for (int node : element.nodes)
            if (!changes.empty()) sum += 0.5 * nodalShare(element) * changes[node] * changes[node];
    return sum;
}

} // namespace filasofia::engine

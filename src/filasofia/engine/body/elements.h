#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>

namespace filasofia::engine {

inline std::size_t elementCount(const SoftModel& model) { return model.elements.size() + model.tetrahedra.size(); }

/// The nodes of a tetrahedron, in a FEM body or in a mass-spring body.
inline const geometry::Tetrahedron& elementNodes(const SoftModel& model, std::size_t e)
{
    return model.elements.empty() ? model.tetrahedra[e] : model.elements[e].nodes;
}
inline geometry::Tetrahedron& elementNodes(SoftModel& model, std::size_t e)
{
    return model.elements.empty() ? model.tetrahedra[e] : model.elements[e].nodes;
}

/// True if every node of a tetrahedron is pinned hard, for example in a removed piece: nothing will change it.
inline bool allHeld(const SoftModel& model, std::size_t e)
{
    return std::ranges::all_of(elementNodes(model, e),
                               [&](int node) { return model.pins.hard[static_cast<std::size_t>(node)]; });
}

/// Sets volume and gradients of an element from its nodes at rest, its scale, and what has flowed.
inline void shapeElement(const std::vector<Vec3>& rest, FemElement& element)
{
    const Corners corners = cornersOf(element.nodes, rest);
    element.gradients = shapeGradients(corners);
    element.volume = volumeOf(corners);
    if (element.plastic != Mat3::identity()) {
        const Mat3 back = inverse(element.plastic);
        for (Vec3& each : element.gradients) each = transposeTimes(back, each);
    }
    if (element.restScale == 1.0) return;
    for (Vec3& each : element.gradients) each = 1.0 / element.restScale * each;
    element.volume *= element.restScale * element.restScale * element.restScale;
}

/// [kg] A spring's block of the implicit step's matrix, with its nodes at `x`.
inline Mat3 springMatrix(const Spring& spring, ImplicitWeights weights, const std::vector<Vec3>& x)
{
    const Vec3 a = x[static_cast<std::size_t>(spring.nodes[0])], b = x[static_cast<std::size_t>(spring.nodes[1])];
    return weights.stiffness * springStiffness(spring, a, b) + weights.damping * springDamping(spring, a, b);
}

} // namespace filasofia::engine

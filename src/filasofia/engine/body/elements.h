#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>

namespace filasofia::engine {

inline bool isShell(const SoftModel& model) { return !model.shell.membranes.empty(); }

/// Tetrahedra, or triangles of a shell.
inline std::size_t elementCount(const SoftModel& model)
{
    return model.elements.size() + model.tetrahedra.size() + model.shell.membranes.size();
}

/// The nodes of an element, in a FEM body, in a mass-spring body or in a shell, whose triangles have no fourth corner
/// (frame::isTriangle).
inline geometry::Tetrahedron elementNodes(const SoftModel& model, std::size_t e)
{
    if (!model.elements.empty()) return model.elements[e].nodes;
    if (!isShell(model)) return model.tetrahedra[e];
    const auto& [a, b, c] = model.shell.membranes[e].nodes;
    return {a, b, c, frame::kNoCorner};
}
inline void setElementNodes(const geometry::Tetrahedron& nodes, std::size_t e, SoftModel& model)
{
    if (!model.elements.empty())
        model.elements[e].nodes = nodes;
    else if (isShell(model))
        model.shell.membranes[e].nodes = {nodes[0], nodes[1], nodes[2]};
    else
        model.tetrahedra[e] = nodes;
}

/// True if every node of an element is pinned hard, for example in a removed piece: nothing will change it.
inline bool allHeld(const SoftModel& model, std::size_t e)
{
    const geometry::Tetrahedron nodes = elementNodes(model, e);
    return std::ranges::all_of(nodesOf(nodes),
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

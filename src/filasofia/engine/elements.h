#pragma once

#include "filasofia/engine/model.h"
#include "filasofia/engine/rupture/tet_shape.h"

namespace filasofia::engine {

inline std::size_t elementCount(const SoftModel& model) { return model.elements.size() + model.tetrahedra.size(); }

/// Of a FEM or a mass-spring body's tetrahedron.
inline const geometry::Tetrahedron& elementNodes(const SoftModel& model, std::size_t e)
{
    return model.elements.empty() ? model.tetrahedra[e] : model.elements[e].nodes;
}
inline geometry::Tetrahedron& elementNodes(SoftModel& model, std::size_t e)
{
    return model.elements.empty() ? model.tetrahedra[e] : model.elements[e].nodes;
}

/// Gives an element the shape that its nodes have at rest.
inline void shapeElement(const std::vector<Vec3>& rest, FemElement& element)
{
    const Corners corners = cornersOf(element.nodes, rest);
    element.gradients = shapeGradients(corners);
    element.volume = volumeOf(corners);
}

} // namespace filasofia::engine

#include "filasofia/engine/soft/assembled_shell.h"

namespace filasofia::engine {
namespace {

/// Adds the forces and the tangent of one triangle.
template <std::size_t n, class Tangent> void add(const std::array<int, n>& nodes, const std::array<Vec3, n>& forces,
                                                 const Tangent& tangent, const SoftState& state,
                                                 AssembledSystem& system)
{
    const std::array<Vec3, n> product = stiffnessTimes(tangent, vectorsAt(nodes, state.v));
    for (std::size_t i = 0; i < n; ++i) {
        system.forces[nodes[i]] += forces[i];
        system.stiffnessTimesVelocity[nodes[i]] += product[i];
    }
}

/// Adds weight * K of one triangle to the matrix. Rows and columns of pinned nodes stay those of the identity.
template <std::size_t n, class Tangent> void addToMatrix(const SoftModel& model, const std::array<int, n>& nodes,
                                                         const Tangent& tangent, double weight, AssembledSystem& system)
{
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            if (model.pins.hard[nodes[i]] || model.pins.hard[nodes[j]]) continue;
            const int place = system.matrix.find(nodes[i], nodes[j]);
            system.matrix.block(place) += weight * stiffnessBlock(tangent, static_cast<int>(i), static_cast<int>(j));
        }
}

} // namespace

void addShell(const SoftModel& model, ImplicitWeights weights, const SoftState& state, AssembledSystem& system)
{
    const bool implicit = system.solver != nullptr;
    for (const MembraneElement& each : model.shell.membranes) {
        const TriangleCorners x = vectorsAt(each.nodes, state.x);
        const MembraneTangent tangent = membraneTangent(each, x, implicit ? weights.turning : 0.0);
        add(each.nodes, membraneForces(each, x), tangent, state, system);
        if (implicit) addToMatrix(model, each.nodes, tangent, weights.stiffness, system);
    }
    for (const BendingElement& each : model.shell.bends) {
        const BendingCorners x = vectorsAt(each.nodes, state.x);
        const BendingTangent tangent = bendingTangent(each, x);
        add(each.nodes, bendingForces(each, x), tangent, state, system);
        if (implicit) addToMatrix(model, each.nodes, tangent, weights.stiffness, system);
    }
}

} // namespace filasofia::engine

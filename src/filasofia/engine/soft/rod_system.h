#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/linalg/band_matrix.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// The equations of one step of a rod, in double. Its unknowns are the changes of the velocities of its nodes and of
/// the spins of its edges, a node and the edge behind it side by side: 4 i to 4 i + 2 belong to node i, 4 i + 3 to edge
/// i. So the matrix is a band, that of a ring a cyclic one, and one factorisation solves the step, however stiff the
/// rod is. The last number belongs to no edge and stays zero, unless the rod is a ring.
class RodSystem {
public:
    /// Depends on what the model says of the rod and its pins.
    explicit RodSystem(const SoftModel& model);

    /// Computes matrix and right-hand side at a state, and factorises the matrix. `given` [N]: the forces other than
    /// elasticity and damping. `inertia` [-] multiplies the masses in the matrix.
    void assemble(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia,
                  const SoftState& state);
    /// Solves for the changes of velocities `dv` [m/s], and keeps those of the spins.
    void solve(std::span<Vec3> dv);

    /// Takes the solution of a coupled solve, by unknown.
    void take(std::span<const double> solution, std::span<Vec3> dv);
    /// Changes the solution so that the step ends with this share of its velocities and spins.
    void slow(double share, const SoftState& state, std::span<Vec3> dv);
    /// Computes the new directors, spins, twists and tensions from the changes of the spins and the new places and
    /// velocities. Returns false if they are not finite.
    bool move(double dt, const SoftModel& model, const SoftState& state, std::span<const Vec3> x,
              std::span<const Vec3> v);
    [[nodiscard]] RodState& moved() { return moved_; }

    [[nodiscard]] const linalg::BandMatrix& matrix() const { return matrix_; }
    [[nodiscard]] const linalg::BandCholesky& factor() const { return factor_; }
    [[nodiscard]] std::span<const double> rightHandSide() const { return rightHandSide_; }

private:
    void addEdges(const SoftModel& model, double stiffness, double turning, const SoftState& state);
    void addJoints(const SoftModel& model, double stiffness, const SoftState& state);
    void addMasses(const SoftModel& model, double weight, const SoftState& state);
    void addAroundSeam(std::size_t node, double factor, const RodVector& gradient); ///< if the rod is a ring

    std::vector<RodJoint> joints_;
    std::vector<bool> fixed_; ///< per unknown
    linalg::BandMatrix matrix_;
    linalg::BandCholesky factor_;
    std::vector<double> forces_;                 ///< [N], [N m] per unknown
    std::vector<double> stiffnessTimesVelocity_; ///< [N/s], [N m/s]
    std::vector<double> rightHandSide_;          ///< [N s], [N m s]
    std::vector<double> spinChanges_;            ///< [rad/s] per edge
    std::vector<Vec3> directors_;                ///< those of the state, across their edges
    RodState moved_;
};

/// Adds the forces of a rod at the end of a step, as the step saw them: elasticity, and damping by its stiffness. Only
/// the nodes that are `wanted`, as those are that a hard pin holds, get all of theirs.
void addRodForces(const SoftModel& model, const SoftState& state, const std::vector<bool>& wanted,
                  std::vector<Vec3>& forces);

} // namespace filasofia::engine

#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <memory>

/// The bunny in an engine of its own, without a server, a picture or a clock around it.
namespace filasofia::app {

/// No file holds the largest mesh: it is that of 1495 tetrahedra, refined twice, which is nearest to 100000.
inline constexpr int kLargestBunny = 95680;
/// The mesh with this number in its file's name, or the largest.
std::shared_ptr<const geometry::TetMesh> bunnyMesh(int tets);

enum class Hold { Head, Feet };

inline constexpr Vec3 kSolverGravity{0.0, -9.81, 0.0};

physics::SoftBodyDef solverBunny(std::shared_ptr<const geometry::TetMesh> mesh, Hold hold,
                                 const physics::Solver& solver = physics::ConjugateGradient{},
                                 const physics::FemMaterial& material = {.youngModulus = 10e3, .poissonRatio = 0.45});

/// Makes steps of `dt` [s] from rest.
class SolverRun {
public:
    SolverRun(const physics::SoftBodyDef& def, double dt, int threads);
    physics::StepReport step();
    void backToRest();
    [[nodiscard]] frame::SoftBodyFrame state() const;

private:
    std::unique_ptr<physics::PhysicsEngine> engine_;
    double dt_;
};

/// [m] Distance between two states: the root of the sum of squares over the nodes.
double distanceOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

/// The assembled solver at a tolerance of 1e-6, which starts every solve from zero.
class ColdReference {
public:
    ColdReference(std::shared_ptr<const geometry::TetMesh> mesh, double dt);
    /// Continues from `from`, or from its present state if `from` is null.
    physics::StepReport step(const frame::SoftBodyFrame* from);

private:
    physics::PhysicsServer server_;
    double dt_;
};

} // namespace filasofia::app

#pragma once

#include "filasofia/geometry/shapes.h"

#include "verification/verification.h"

#include <numbers>

/// A rigid ball pressed into a soft block much larger than the contact area, and the force that it feels.
namespace filasofia::engine {

inline constexpr double kHertzThick = 0.1; ///< [m] the block's thickness, from y = 0 down, and half of its width
inline constexpr double kHertzYoung = 1e4, kHertzPoisson = 0.3; // this nu avoids volume locking

/// A block with finer elements under the middle of its top.
inline geometry::TetMesh hertzMesh(int cells)
{
    geometry::TetMesh mesh = boxMesh({cells, cells * 22 / 30, cells}, {2, 1, 2});
    for (Vec3& p : mesh.nodes) {
        const auto crowd = [&](double t) { return kHertzThick * t * (0.05 + 0.95 * t * t); };
        p = {crowd(p.x - 1), crowd(p.y - 1), crowd(p.z - 1)};
    }
    return mesh;
}

/// A block, or a part of one, pinned at the block's floor.
inline physics::SoftBodyDef hertzBlock(const geometry::TetMesh& mesh)
{
    physics::SoftBodyDef block{.mesh = shared(mesh)};
    block.material = physics::FemMaterial{.youngModulus = kHertzYoung, .poissonRatio = kHertzPoisson};
    block.gravity = false;
    block.friction = 0.0;
    block.collision = {{.proximity = 1e-4}};
    block.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.999 * kHertzThick, 1}}}};
    return block;
}

/// The force on a ball pressed into what is in the stage, relative to Hertz' force for a half-space,
/// F = 4/3 E / (1 - nu^2) sqrt(R) d^(3/2), corrected for a layer of the block's thickness h bonded to a floor
/// (Dimitriadis et al. 2002, equation 13: its first terms in sqrt(R d) / h).
inline double forceOverHertz(Stage& stage)
{
    const double radius = 0.02, depth = 0.001, nu = kHertzPoisson;
    physics::RigidBodyDef ball{.name = "ball", .elements = {Pose{{0, radius, 0}, {}}}};
    ball.mesh = geometry::shapes::sphere(radius, 32);
    ball.collision = {{.proximity = 1e-4}};
    ball.friction = 0.0;
    const BodyId id = stage.add(ball);
    for (int i = 1; i <= 200; ++i) {
        stage.post(physics::SetPose{id, 0, Pose{{0, radius - depth * std::min(1.0, i / 100.0), 0}, {}}});
        stage.step(5e-3);
    }
    const double chi = std::sqrt(radius * depth) / kHertzThick;
    const double layer = 2 / std::numbers::pi * (1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu) * chi;
    const double hertz = 4.0 / 3.0 * kHertzYoung / (1 - nu * nu) * std::sqrt(radius) * std::pow(depth, 1.5);
    return frame::forceOn(id, stage.world.scene().contactReports).y / (hertz * (1 + layer + layer * layer));
}

/// Presses the ball into blocks that `add` puts on a stage, of two meshes; the elements have second order.
template <class Add> void verifyHertz(const std::string& what, const Add& add)
{
    const auto measure = [&](int cells) {
        Stage stage;
        add(stage, hertzMesh(cells));
        return forceOverHertz(stage);
    };
    const double coarse = measure(18), fine = measure(24);
    tell(what + " of 18 cells: force over Hertz on a layer", coarse);
    tell(what + " of 24 cells: force over Hertz on a layer", fine);
    const double limit = fine - (coarse - fine) / (24.0 * 24.0 / (18.0 * 18.0) - 1.0);
    verifyWithin(what + ", extrapolated to small cells: force over Hertz on a layer", limit, 0.95, 1.05);
}

} // namespace filasofia::engine

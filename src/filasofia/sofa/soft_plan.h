#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/physics/commands.h"
#include "filasofia/sofa/collision_plan.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace filasofia::sofaengine {

/// Nodes that are held in space.
struct PinGroup {
    AttachmentId id = {};
    std::vector<int> nodes = {};
    std::vector<Vec3> places = {};     ///< [m] where they are held, one per node
    double stiffness = physics::kHard; ///< [N/m] a spring per node
    friend bool operator==(const PinGroup&, const PinGroup&) = default;
};

/// Per node, of so many: 1 if a group pins it hard.
std::vector<std::uint8_t> heldNodes(const std::vector<PinGroup>& pins, std::size_t nodes);
/// Takes nodes out of the groups; `isGone(node)` tells which. Groups may be left empty.
void eraseNodes(const std::function<bool(int)>& isGone, std::vector<PinGroup>& pins);

/// A soft body as its node in SOFA is made: checked, plain data of ours, made on any thread.
struct SoftPlan {
    physics::SoftBodyDef def = {};
    geometry::TetMesh mesh = {};           ///< in the world, at rest
    std::vector<double> density = {};      ///< [kg/m^3] per tetrahedron
    std::vector<double> masses = {};       ///< [kg] per node
    std::vector<double> youngModulus = {}; ///< [Pa] per tetrahedron; empty if the material is of springs
    std::vector<double> poissonRatio = {}; ///< [-] per tetrahedron; empty if the material is of springs
    /// [Pa] per tetrahedron, the stress that tears it; empty if none does
    std::vector<double> tearing = {};
    std::vector<std::array<int, 2>> edges = {};   ///< those of the mesh, once each; empty unless it is of springs
    std::vector<PinGroup> pins = {};              ///< those of the Def; ids count its attachments from 0
    std::vector<CollisionPlan> collision = {};    ///< its collision models
    std::vector<std::array<int, 3>> surface = {}; ///< faces of one tetrahedron, counter-clockwise from outside
    std::vector<char> gone = {}; ///< per tetrahedron, 1: of a piece that was removed; empty if none was
};

/// Throws an Error that names the body and the field if the Def is wrong, or if it asks for what this engine lacks.
SoftPlan planSoft(const physics::SoftBodyDef& def);

/// Finds what follows from mesh, densities and removed pieces: masses, edges, the surface and the collision models that
/// are it.
void shapePlan(SoftPlan& plan);

/// Whether blades of a collision group cut the body.
bool mayBeCut(const physics::SoftBodyDef& def, int group);

/// Nodes that an attachment selects, ascending. `at`: where they are now.
std::vector<int> nodesOf(const physics::AttachmentDef& def, const std::vector<Vec3>& at);

} // namespace filasofia::sofaengine

#pragma once

#include "filasofia/sofa/rigid_node.h"
#include "filasofia/sofa/soft_node.h"
#include "filasofia/sofa/tie.h"

#include <memory>
#include <vector>

namespace filasofia::sofaengine {

/// All bodies, each list in the order of ids, below one root.
struct SofaScene {
    ::sofa::simulation::Node::SPtr root = {};
    std::vector<std::unique_ptr<SoftNode>> soft = {};
    std::vector<std::unique_ptr<RigidNode>> rigid = {};
    ContactStage contact;
    std::vector<FoundContact> contacts = {};     ///< the last step's
    std::vector<std::unique_ptr<Tie>> ties = {}; ///< in the order of ids
    std::vector<physics::Grasp> grasps = {};     ///< those that wait for contacts in the next step
};

/// From now on bodies may have constraints.
void startConstraints(SofaScene& scene);
/// A body comes with collision models, whose proximities [m] it has: contact begins with the first.
void startContact(const std::vector<CollisionPlan>& collision, SofaScene& scene);

/// Null if there is no such body.
template <class Body> Body* findBody(const std::vector<std::unique_ptr<Body>>& bodies, BodyId id)
{
    for (const auto& each : bodies)
        if (each->id() == id) return each.get();
    return nullptr;
}

} // namespace filasofia::sofaengine

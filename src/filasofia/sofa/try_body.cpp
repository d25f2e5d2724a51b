#include "filasofia/sofa/try_body.h"

#include "filasofia/core/error.h"
#include "filasofia/sofa/apply_commands.h"
#include "filasofia/sofa/sofa_process.h"

#include <sofa/simulation/DefaultAnimationLoop.h>
#include <sofa/simulation/Simulation.h>

namespace filasofia::sofaengine {
namespace {

/// A scene that is gone at the end of its scope.
struct Trial {
    SofaScene scene;
    explicit Trial(const physics::ContactMethod& method) : scene{.contact = ContactStage(method)}
    {
        scene.root = ::sofa::simulation::Simulation::theSimulation->createNewGraph("trial");
        scene.root->addObject(::sofa::core::objectmodel::New<::sofa::simulation::DefaultAnimationLoop>());
    }
    ~Trial()
    {
        scene.soft.clear();
        scene.rigid.clear();
        ::sofa::simulation::node::unload(scene.root);
    }
    Trial(const Trial&) = delete;
    Trial& operator=(const Trial&) = delete;
};

void make(const physics::BuiltBody& body, SofaScene& scene)
{
    if (const auto* soft = dynamic_cast<const PlannedSoft*>(&body)) {
        startContact(soft->plan.collision, scene);
        scene.soft.push_back(std::make_unique<SoftNode>(BodyId{1}, soft->plan, *scene.root, scene.contact));
    } else if (const auto* rigid = dynamic_cast<const PlannedRigid*>(&body)) {
        startContact(rigid->plan.collision, scene);
        scene.rigid.push_back(std::make_unique<RigidNode>(BodyId{1}, rigid->plan, *scene.root, scene.contact));
    }
}

} // namespace

void tryBody(const physics::BodyDef& def, const physics::BuiltBody& body, const physics::ContactMethod& method)
{
    const std::lock_guard<std::recursive_mutex> lock(sofaMutex());
    const CollectErrors errors;
    std::string problem;
    try {
        Trial trial(method);
        make(body, trial.scene);
    } catch (const std::exception& thrown) {
        problem = thrown.what();
    }
    if (problem.empty() && !errors.messages().empty()) problem = errors.messages().front();
    if (!problem.empty()) fail(describeBody(def), ": SOFA cannot make it: ", problem);
}

} // namespace filasofia::sofaengine

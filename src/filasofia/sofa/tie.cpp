#include "filasofia/sofa/tie.h"

#include "filasofia/sofa/collision_node.h"
#include "filasofia/sofa/node_removal.h"

#include <sofa/component/mapping/nonlinear/RigidMapping.h>
#include <sofa/simulation/Simulation.h>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::objectmodel::New;

constexpr double kFastest = 0.1; // [m/s] at which a weld draws its points together, as surfaces part in our engine

TiePoint pointOf(const Tie::Side& side, std::size_t i)
{
    return side.soft ? side.points[i] : TiePoint{.nodes = {static_cast<int>(i), 0, 0, 0}};
}

} // namespace

Tie::Tie(AttachmentId id, const Side& body, const Side& other, const Law& law, std::span<const Vec3> apart,
         ::sofa::simulation::Node& root)
    : law_(law), report_{.id = id, .body = body.id(), .to = other.id(), .points = static_cast<int>(apart.size())},
      root_(root)
{
    TieRows::States* first = statesOf(body);
    const bool space = !other.soft && !other.rigid;
    rows_ = New<TieRows>(first, space ? first : statesOf(other));
    rows_->space = space;
    rows_->stiffness = law.stiffness;
    rows_->fastest = kFastest;
    for (std::size_t i = 0; i < apart.size(); ++i)
        rows_->pairs.push_back(
            {.first = pointOf(body, i), .second = space ? TiePoint{} : pointOf(other, i), .apart = apart[i]});
    root_.addObject(rows_);
    rows_->init();
}

Tie::~Tie()
{
    if (rows_) root_.removeObject(rows_);
    for (auto& node : nodes_) removeNode(node);
}

/// Points of a rigid element get a node of their own.
TieRows::States* Tie::statesOf(const Side& side)
{
    if (side.soft) return &side.soft->states();
    RigidState now;
    side.rigid->read(now);
    const Pose pose = now.poses[static_cast<std::size_t>(side.element)];
    Vec3Types::VecCoord local, world;
    for (const Vec3 place : side.places) {
        const Vec3 own = rotate(conjugate(pose.orientation), place - pose.position);
        local.push_back(toSofa(own - side.rigid->plan().inertia.centre));
        world.push_back(toSofa(place));
    }
    const auto node = nodes_.emplace_back(side.rigid->node().createChild("tie"));
    const auto states = New<SoftStates>();
    states->resize(static_cast<::sofa::Size>(world.size()));
    states->x.setValue(world);
    states->x0.setValue(world);
    node->addObject(states);
    const auto mapping = New<::sofa::component::mapping::nonlinear::RigidMapping<RigidTypes, Vec3Types>>();
    mapping->setModels(&side.rigid->states(), states.get());
    mapping->d_points.setValue(local);
    mapping->d_index.setValue(static_cast<::sofa::Index>(side.element));
    node->addObject(mapping);
    ::sofa::simulation::node::init(node.get());
    return states.get();
}

void Tie::finish(std::span<const double> impulses, double dt)
{
    rows_->readForces(impulses, dt);
    report_.force = {};
    for (const TieRows::Pair& each : rows_->pairs) report_.force += each.force;
    report_.parted = static_cast<int>(std::erase_if(
        rows_->pairs, [&](const TieRows::Pair& each) { return length(each.force) > law_.pointBreakForce; }));
    report_.points = static_cast<int>(rows_->pairs.size());
    report_.broken = report_.points == 0 || length(report_.force) > law_.breakForce;
}

} // namespace filasofia::sofaengine

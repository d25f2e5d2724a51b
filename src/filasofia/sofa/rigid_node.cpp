#include "filasofia/sofa/rigid_node.h"

#include "filasofia/core/text.h"
#include "filasofia/physics/limits.h"
#include "filasofia/sofa/collision_node.h"
#include "filasofia/sofa/free_correction.h"
#include "filasofia/sofa/node_removal.h"

#include <sofa/component/linearsolver/iterative/CGLinearSolver.h>
#include <sofa/component/odesolver/backward/EulerImplicitSolver.h>
#include <sofa/simulation/Simulation.h>

#include <algorithm>
#include <iterator>
#include <limits>

namespace filasofia::sofaengine {
namespace {

using namespace ::sofa::component;
using ::sofa::core::objectmodel::New;
using RigidGradients =
    linearsolver::iterative::CGLinearSolver<linearsolver::GraphScatteredMatrix, linearsolver::GraphScatteredVector>;

/// The solver's matrix is that of the masses alone: a few iterations are exact.
void addRigidSolver(const physics::RigidBodyDef& def, ::sofa::simulation::Node& node)
{
    auto euler = New<odesolver::backward::EulerImplicitSolver>();
    euler->d_rayleighMass.setValue(def.linearDamping);
    euler->d_rayleighStiffness.setValue(0.0);
    node.addObject(euler);
    auto solver = New<RigidGradients>();
    solver->d_maxIter.setValue(100);
    solver->d_tolerance.setValue(1e-12);
    solver->d_smallDenominatorThreshold.setValue(std::numeric_limits<SReal>::min());
    node.addObject(solver);
}

} // namespace

// Delegating: if what follows throws, the destructor takes the node out of the graph.
RigidNode::RigidNode(BodyId id, RigidPlan plan, ::sofa::simulation::Node& root, const ContactStage& contact)
    : RigidNode(id, std::move(plan))
{
    node_ = root.createChild(text("body", id.value));
    if (isSolved()) addRigidSolver(plan_.def, *node_);
    state_ = New<State>();
    state_->setName("state");
    state_->resize(static_cast<::sofa::Size>(plan_.def.elements.size()));
    write(start());
    state_->x0.setValue(state_->x.getValue());
    node_->addObject(state_);
    if (isSolved()) addSolved();
    *driven_ = joints_.isDriven();
    for (const CollisionPlan& each : plan_.collision) {
        for (const Vec3 vertex : each.mesh.vertices) reach_ = std::max(reach_, distance(vertex, plan_.inertia.centre));
        const ModelTag tag{.body = id,
                           .parent = joints_.parentOf(each.def.element),
                           .moves = isSolved(),
                           .driven = joints_.empty() ? nullptr : driven_,
                           .friction = plan_.def.friction,
                           .passes = passes_};
        surfaces_.push_back(addCollision(each, tag, contact, *state_, plan_.inertia.centre));
    }
    ::sofa::simulation::node::init(node_.get());
    if (contact.constrains()) joinConstraints();
}

void RigidNode::addSolved()
{
    mass_ = New<ElementMass>();
    mass_->mass = plan_.inertia.mass;
    mass_->inertia = plan_.inertia.inertia;
    node_->addObject(mass_);
    loads_ = New<RigidLoads>();
    loads_->setName("loads");
    loads_->wrenches.resize(plan_.def.elements.size());
    loads_->hands.resize(plan_.def.elements.size());
    if (!plan_.def.gravity) loads_->weightless = plan_.inertia.mass;
    node_->addObject(loads_);
}

RigidNode::~RigidNode()
{
    surfaces_.clear();
    if (node_) removeNode(node_);
}

void RigidNode::joinConstraints()
{
    constrained_ = true;
    const auto correction = New<FreeCorrection<RigidTypes>>();
    if (isSolved()) {
        correction->respond =
            correction->eachAlone([this](std::size_t element, const RigidTypes::Deriv& impulse, double dt) {
                const RigidLoads::HandInertia hand = loads_->handInertia(element, dt);
                const double damped = 1 + dt * plan_.def.linearDamping;
                const Mat3 inertia = damped * mass_->inertiaOf(element) + hand.inertia * Mat3::identity();
                return RigidTypes::Deriv(getVCenter(impulse) / (plan_.inertia.mass * damped + hand.mass),
                                         toSofa(inverse(inertia) * fromSofa(getVOrientation(impulse))));
            });
    } else if (!joints_.empty()) {
        correction->respond = [this](auto impulses, double /*dt*/) { return joints_.respond(impulses); };
        correction->push = [this](auto impulses, double /*dt*/) { return joints_.push(impulses); };
        rows_ = New<JointRows>(state_.get(), joints_);
        node_->addObject(rows_);
        rows_->init();
    }
    node_->addObject(correction);
    correction->init();
}

double RigidNode::speed() const
{
    double fastest = 0.0;
    for (const auto& each : state_->v.getValue())
        fastest = std::max<double>(fastest, getVCenter(each).norm() + reach_ * getVOrientation(each).norm());
    return fastest;
}

RigidState RigidNode::start() const
{
    const std::size_t count = plan_.def.elements.size();
    const bool dynamic = plan_.def.dynamic;
    return {.poses = plan_.def.elements,
            .velocities = std::vector<Vec3>(count, dynamic ? plan_.def.velocity : Vec3{}),
            .angularVelocities = std::vector<Vec3>(count, dynamic ? plan_.def.angularVelocity : Vec3{})};
}

void RigidNode::read(RigidState& out) const
{
    const auto& x = state_->x.getValue();
    const auto& v = state_->v.getValue();
    out.poses.clear();
    out.velocities.clear();
    out.angularVelocities.clear();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Quat turn = fromSofa(x[i].getOrientation());
        out.poses.push_back({fromSofa(x[i].getCenter()) - rotate(turn, plan_.inertia.centre), turn});
        out.velocities.push_back(fromSofa(getVCenter(v[i])));
        out.angularVelocities.push_back(fromSofa(getVOrientation(v[i])));
    }
}

void RigidNode::write(const RigidState& state)
{
    RigidTypes::VecCoord x;
    RigidTypes::VecDeriv v;
    for (std::size_t i = 0; i < state.poses.size(); ++i) {
        const Quat turn = normalized(state.poses[i].orientation);
        x.push_back({toSofa(state.poses[i].position + rotate(turn, plan_.inertia.centre)), toSofa(turn)});
        v.push_back({toSofa(state.velocities[i]), toSofa(state.angularVelocities[i])});
    }
    state_->x.setValue(x);
    state_->v.setValue(v);
}

bool RigidNode::isUsable() const
{
    RigidState now;
    read(now);
    for (std::size_t i = 0; i < now.poses.size(); ++i)
        if (!isFinite(now.poses[i]) || !(length(now.poses[i].position) < physics::kFarthest) ||
            !(length(now.velocities[i]) < physics::kFarthest) ||
            !(length(now.angularVelocities[i]) < physics::kFarthest))
            return false;
    return true;
}

void RigidNode::setWrench(int element, const engine::Wrench& wrench)
{
    (loads_ ? loads_->wrenches : joints_.wrenches)[static_cast<std::size_t>(element)] = wrench;
}

void RigidNode::setHand(int element, const physics::HapticTarget& target)
{
    if (!plan_.def.dynamic) {
        setPose(element, target.pose);
        return;
    }
    const VirtualCoupling& c = target.coupling;
    auto& hand = loads_->hands[static_cast<std::size_t>(element)];
    hand.reset();
    if (c.linearStiffness == 0 && c.linearDamping == 0 && c.angularStiffness == 0 && c.angularDamping == 0) return;
    const MotionState motion{
        {target.pose.position, normalized(target.pose.orientation)}, target.velocity, target.angularVelocity};
    hand = RigidLoads::Hand{.target = atPoint(motion, plan_.inertia.centre), .coupling = c};
}

void RigidNode::setPose(int element, const Pose& pose)
{
    const auto at = static_cast<std::size_t>(element);
    if (!plan_.def.dynamic) {
        targets_[at] = Pose{pose.position, normalized(pose.orientation)};
        return;
    }
    RigidState now;
    read(now);
    now.poses[at] = pose;
    now.velocities[at] = now.angularVelocities[at] = {};
    if (!joints_.empty()) { // all of it is at rest
        now.velocities.assign(now.velocities.size(), {});
        now.angularVelocities.assign(now.angularVelocities.size(), {});
        joints_.rest();
        joints_.place(now.poses);
    }
    write(now);
}

Pose RigidNode::endOf(int element) const
{
    const auto at = static_cast<std::size_t>(element);
    if (targets_[at]) return *targets_[at];
    RigidState now;
    read(now);
    return now.poses[at];
}

void RigidNode::beginJoints(double dt, const RigidNode* carrier)
{
    const physics::ArticulationDef& def = plan_.def.articulation;
    RigidState now;
    read(now);
    targets_[0] = carrier ? carrier->endOf(def.toElement) * def.offset : endOf(0);
    joints_.begin(dt, *targets_[0], fromSofa(node_->getGravity()), now);
    *driven_ = joints_.isDriven();
    write(now);
}

void RigidNode::loadJoints(std::span<const PointForce> forces, std::span<const double> impulses, double dt)
{
    if (joints_.empty()) return;
    std::vector<PointForce> own;
    std::ranges::copy_if(forces, std::back_inserter(own), [&](const PointForce& each) { return each.body == id_; });
    joints_.load(own, rows_ ? rows_->impulsesOf(impulses) : impulses.first(0), dt);
}

void RigidNode::beginMove(double dt, const RigidNode* carrier)
{
    if (isSolved()) {
        mass_->begin(dt);
        loads_->limitHands(dt);
        return;
    }
    if (joints_.empty()) {
        RigidState now;
        read(now);
        for (std::size_t i = 0; i < targets_.size(); ++i) {
            now.velocities[i] = now.angularVelocities[i] = {};
            if (!targets_[i]) continue;
            const Vec3 velocity = (targets_[i]->position - now.poses[i].position) / dt;
            if (length(velocity) > physics::kTeleport) continue;
            now.velocities[i] = velocity;
            now.angularVelocities[i] =
                rotationVector(targets_[i]->orientation * conjugate(now.poses[i].orientation)) / dt;
        }
        write(now);
    } else {
        beginJoints(dt, carrier);
    }
    // What has no solver keeps the velocity with which SOFA first saw it.
    if (constrained_) state_->write(::sofa::core::vec_id::write_access::freeVelocity)->setValue(state_->v.getValue());
}

bool RigidNode::finishMove(double dt, bool failed)
{
    if (isSolved()) {
        mass_->finish();
        return true;
    }
    RigidState now;
    read(now);
    bool good = true;
    if (!joints_.empty()) {
        good = joints_.finish(dt, failed, now);
        targets_.assign(targets_.size(), std::nullopt);
    }
    for (std::size_t i = 0; i < targets_.size(); ++i)
        if (const auto target = std::exchange(targets_[i], std::nullopt)) now.poses[i] = *target;
    write(now);
    return good;
}

void RigidNode::setBlades(bool cutting, int sheath)
{
    cutting_ = cutting;
    sheath_ = sheath;
    *passes_ = cutting || sheath > 0;
}

void RigidNode::rewind()
{
    write(start());
    targets_.assign(targets_.size(), std::nullopt);
    joints_.rewind();
    setBlades(cutting_, 0);
}

RigidSettings RigidNode::settings() const
{
    RigidSettings settings;
    settings.targets = targets_;
    settings.joints = joints_.state();
    settings.cutting = cutting_;
    settings.sheath = sheath_;
    settings.wrenches = joints_.wrenches;
    if (!loads_) return settings;
    settings.wrenches = loads_->wrenches;
    settings.hands = loads_->hands;
    return settings;
}

void RigidNode::apply(const RigidSettings& settings)
{
    targets_ = settings.targets;
    joints_.apply(settings.joints);
    setBlades(settings.cutting, settings.sheath);
    joints_.wrenches = settings.wrenches;
    if (!loads_) return;
    loads_->wrenches = settings.wrenches;
    loads_->hands = settings.hands;
}

} // namespace filasofia::sofaengine

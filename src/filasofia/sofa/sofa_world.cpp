#include "filasofia/sofa/sofa_world.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/sofa/apply_commands.h"
#include "filasofia/sofa/cut_bodies.h"
#include "filasofia/sofa/intersections.h"
#include "filasofia/sofa/lacks.h"
#include "filasofia/sofa/make_tie.h"
#include "filasofia/sofa/node_removal.h"
#include "filasofia/sofa/scene_state.h"
#include "filasofia/sofa/sofa_process.h"
#include "filasofia/sofa/try_body.h"

#include <sofa/simulation/DefaultAnimationLoop.h>
#include <sofa/simulation/DefaultVisualManagerLoop.h>
#include <sofa/simulation/MechanicalOperations.h>
#include <sofa/simulation/Simulation.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::sofaengine {

namespace {

constexpr double kLookEvery = 0.01; // [s] simulated, for intersections, as the native engine
using Lock = std::lock_guard<std::recursive_mutex>;

struct WorldState final : physics::EngineState {
    SceneState scene;
    SceneWatch watch;
    double time = 0.0;
    std::uint64_t steps = 0;
};

const SofaEngineDef& checked(const SofaEngineDef& def)
{
    validate(def, "SOFA engine");
    return def;
}

/// Surfaces follow their bodies only within a step: those that were moved since must be brought along.
void followBodies(::sofa::simulation::Node& root)
{
    ::sofa::simulation::common::MechanicalOperations operations(::sofa::core::mechanicalparams::defaultInstance(),
                                                                &root);
    operations.propagateXAndV(::sofa::core::vec_id::write_access::position,
                              ::sofa::core::vec_id::write_access::velocity);
}

void writeConstraints(const SofaScene& scene, std::vector<frame::Contact>& contacts,
                      std::vector<frame::Attachment>& attachments)
{
    contacts.clear();
    for (const FoundContact& each : scene.contacts) contacts.push_back(each.contact);
    attachments.clear();
    for (const auto& tie : scene.ties) attachments.push_back(tie->report());
}

bool changesBodies(const physics::Command& command)
{
    return std::holds_alternative<physics::AddBody>(command) || std::holds_alternative<physics::RemoveBody>(command) ||
           std::holds_alternative<physics::Reset>(command);
}

/// Those of contacts and attachments on elements of rigid bodies.
std::vector<PointForce> forcesOn(const SofaScene& scene)
{
    std::vector<PointForce> forces;
    for (const auto& [contact, firstElement, secondElement] : scene.contacts) {
        const Vec3 onFirst = contact.normalForce * contact.normal + contact.friction;
        forces.push_back({contact.first, firstElement, contact.point, onFirst});
        forces.push_back({contact.second, secondElement, contact.point, -onFirst});
    }
    for (const auto& tie : scene.ties) tie->addForces(forces);
    return forces;
}

WeldedPairs weldedPairs(const SofaScene& scene)
{
    WeldedPairs pairs;
    for (const auto& tie : scene.ties) {
        if (!tie->to() || std::isfinite(tie->law().stiffness)) continue;
        geometry::Box& box = pairs[{std::min(tie->body(), tie->to()), std::max(tie->body(), tie->to())}];
        const std::vector<Vec3> places = tie->places();
        box = merged(box, geometry::grown(geometry::boxAround(places), scene.contact.reach()));
    }
    return pairs;
}

double fastest(const SofaScene& scene)
{
    double speed = 0.0;
    for (const auto& body : scene.soft) speed = std::max(speed, body->speed());
    for (const auto& body : scene.rigid) speed = std::max(speed, body->speed());
    return speed;
}

} // namespace

bool animate(::sofa::simulation::Node& root, double dt)
{
    return attempt("SOFA: a step ended with an exception", [&] { ::sofa::simulation::node::animate(&root, dt); });
}

SofaWorld::SofaWorld(const SofaEngineDef& def) : scene_{.contact = ContactStage(checked(def).contact)}
{
    const Lock lock(sofaMutex());
    startSofa();
    scene_.root = ::sofa::simulation::Simulation::theSimulation->createNewGraph("root");
    const auto loop = ::sofa::core::objectmodel::New<::sofa::simulation::DefaultAnimationLoop>();
    loop->d_computeBoundingBox.setValue(false); // only SOFA's own pictures need it
    scene_.root->addObject(loop);
    scene_.root->addObject(::sofa::core::objectmodel::New<::sofa::simulation::DefaultVisualManagerLoop>());
    scene_.root->setDt(def.period);
    ::sofa::simulation::node::initRoot(scene_.root.get());
}

SofaWorld::~SofaWorld()
{
    const Lock lock(sofaMutex());
    const PartedSlaves parted(*scene_.root);
    scene_.contact.forget();
    scene_.ties.clear();
    scene_.soft.clear();
    scene_.rigid.clear();
    ::sofa::simulation::node::unload(scene_.root);
    scene_.root.reset();
}

physics::EngineInfo SofaWorld::info() const
{
    return {.name = "sofa", .version = FILASOFIA_SOFA_VERSION, .cuts = true, .joints = true};
}

std::unique_ptr<physics::BuiltBody> SofaWorld::build(const physics::BodyDef& def) const
{
    scene_.contact.check(def);
    auto body = planBody(def);
    tryBody(def, *body, scene_.contact.method());
    return body;
}

void SofaWorld::check(const physics::Command& command, const physics::BodyDef* def) const
{
    checkCommand(command, def);
    const auto* attach = std::get_if<physics::Attach>(&command);
    const bool ties = attach ? isTie(attach->def)
                             : std::holds_alternative<physics::AttachRigid>(command) ||
                                   std::holds_alternative<physics::Grasp>(command);
    const std::string object = def ? describeBody(*def) : std::string("physics");
    if (ties) scene_.contact.checkTies(object);
    const auto* joint = std::get_if<physics::SetJoint>(&command);
    if (joint && std::holds_alternative<physics::JointSpring>(joint->command)) fail(object, ": JointSpring", kLacks);
    if (joint && std::holds_alternative<physics::JointForce>(joint->command)) scene_.contact.checkDrives(object);
}

physics::StepReport SofaWorld::step(const physics::StepInput& in)
{
    physics::StepReport report{.dt = in.dt, .flags = in.flags};
    const Now now = [&] { return in.budget && in.budget->now ? in.budget->now() : std::int64_t{0}; };
    const Lock lock(sofaMutex());
    const std::int64_t begin = now();
    looksAgain_ = looksAgain_ || std::ranges::any_of(in.commands, changesBodies);
    const bool changes = std::ranges::any_of(in.commands, physics::changesScene); // a command is moved from
    removeLostPieces(scene_, report);
    applyCommands(in.commands, *this, scene_, report);
    const std::int64_t applied = now();
    report.times.commands = 1e-9 * static_cast<double>(applied - begin);
    if (in.dt > 0.0) {
        advance(in.dt, now, report);
        ++steps_;
        time_ += in.dt;
    }
    watch_.follow(changes, in.dt, scene_, report);
    report.times.advance = 1e-9 * static_cast<double>(now() - applied) - report.times.topology;
    report.step = steps_;
    report.time = time_;
    return report;
}

void SofaWorld::advance(double dt, const Now& now, physics::StepReport& report)
{
    const SceneMotion before = motionOf(scene_);
    findInverted(scene_, before, report);
    findStrained(scene_, before, report);
    followSheaths(scene_, report.topology);
    std::erase_if(scene_.ties, [](const auto& each) { return each->isBroken(); });
    const bool failed = !attempt("SOFA: a step ended with an exception", [&] { move(dt); });
    readConstraints(failed, dt, report);
    report.intersections = intersections_;
    for (const FoundContact& each : scene_.contacts) physics::addForce(each.contact, report.intersections);
    if (!intersections_.empty()) report.set(physics::StepFlag::Intersecting);
    putBack(failed, before, report);
    const std::vector<PointForce> forces = forcesOn(scene_);
    const std::span<const double> impulses = failed ? std::span<const double>() : scene_.contact.impulses();
    for (const auto& body : scene_.rigid) {
        if (!body->finishMove(dt, failed)) report.setUndone(body->id());
        body->loadJoints(forces, impulses, dt);
    }
    for (const auto& body : scene_.soft) {
        const SolveOutcome solve = body->outcome();
        if (solve.atLimit) report.set(physics::StepFlag::NotConverged);
        report.solves.push_back({body->id(), solve.iterations, solve.residual, body->id()});
    }
    if (failed) return;
    const std::int64_t moved = now();
    ruptureBodies(before, dt, scene_, report);
    for (const auto& tie : scene_.ties)
        if (const auto gone = physics::breakOf(tie->report(), tie->report().points, tie->grasps()))
            report.breaks.push_back(*gone);
    report.times.topology = 1e-9 * static_cast<double>(now() - moved);
}

void SofaWorld::move(double dt)
{
    scene_.root->setDt(dt);                                     // some components read it in place of the step's
    ::sofa::simulation::node::updateContext(scene_.root.get()); // a step of SOFA hands gravity down only at its end
    for (const auto& body : scene_.rigid)                       // a carrier comes before the bodies that follow it
        body->beginMove(dt, findBody(scene_.rigid, body->plan().def.articulation.to));
    if (scene_.contact.isOn()) {
        scene_.contact.setWelded(weldedPairs(scene_));
        followBodies(*scene_.root);
        const auto window = [](double time) { return std::floor(time / kLookEvery + 1e-6); };
        if (std::exchange(looksAgain_, false) || window(time_) != window(time_ + dt))
            intersections_ = intersectionsOf(scene_);
        scene_.contact.prepare(fastest(scene_) + length(fromSofa(scene_.root->getGravity())) * dt, dt);
    }
    for (const auto& tie : scene_.ties) tie->prepare(dt);
    ::sofa::simulation::node::animate(scene_.root.get(), dt);
}

void SofaWorld::putBack(bool failed, const SceneMotion& before, physics::StepReport& report)
{
    for (std::size_t b = 0; b < scene_.soft.size(); ++b) {
        if (!failed && scene_.soft[b]->isUsable()) continue;
        const std::vector<Vec3>& positions = before.soft[b].positions;
        scene_.soft[b]->write({positions, std::vector<Vec3>(positions.size())});
        report.setUndone(scene_.soft[b]->id());
    }
    for (std::size_t b = 0; b < scene_.rigid.size(); ++b) {
        if (!failed && scene_.rigid[b]->isUsable()) continue;
        const std::vector<Vec3> rest(before.rigid[b].poses.size());
        scene_.rigid[b]->write({before.rigid[b].poses, rest, rest});
        report.setUndone(scene_.rigid[b]->id());
    }
}

void SofaWorld::readConstraints(bool failed, double dt, physics::StepReport& report)
{
    scene_.contacts.clear();
    if (failed) {
        scene_.contact.forget();
        return;
    }
    scene_.contact.read(dt, scene_.contacts, report);
    for (const auto& tie : scene_.ties) tie->finish(scene_.contact.impulses(), dt);
    for (const physics::Grasp& grasp : std::exchange(scene_.grasps, {})) {
        const RigidNode* jaw = findBody(scene_.rigid, grasp.rigid);
        const std::string object = text("rigid body '", jaw ? jaw->plan().def.name : "", "': grasp");
        bool found = true;
        const bool made =
            attempt(object + ": nothing is attached, because SOFA failed", [&] { found = addTie(grasp, scene_); });
        if (made && found) continue;
        report.set(physics::StepFlag::NothingAttached);
        if (!made) continue;
        report.nothingHeld.push_back({.id = grasp.id, .body = grasp.rigid, .to = grasp.target, .grasp = true});
        logWarning(object, ".target: no contact with body ", grasp.target.value, "; nothing is attached");
    }
}

void SofaWorld::capture(frame::Frame& out) const
{
    const Lock lock(sofaMutex());
    out.step = steps_;
    out.time = time_;
    out.softBodies.resize(scene_.soft.size());
    for (std::size_t b = 0; b < scene_.soft.size(); ++b) {
        frame::SoftBodyFrame& body = out.softBodies[b];
        SoftState state{std::move(body.positions), std::move(body.velocities)}; // reuses their memory
        scene_.soft[b]->read(state);
        const SoftCuts* cuts = scene_.soft[b]->cuts();
        body = {.id = scene_.soft[b]->id(),
                .positions = std::move(state.positions),
                .velocities = std::move(state.velocities),
                .boundary = cuts ? cuts->boundary : nullptr};
    }
    out.rigidBodies.resize(scene_.rigid.size());
    for (std::size_t b = 0; b < scene_.rigid.size(); ++b) {
        RigidState state;
        scene_.rigid[b]->read(state);
        out.rigidBodies[b] = {.id = scene_.rigid[b]->id(),
                              .poses = std::move(state.poses),
                              .velocities = std::move(state.velocities),
                              .angularVelocities = std::move(state.angularVelocities),
                              .joints = scene_.rigid[b]->joints()};
    }
    writeConstraints(scene_, out.contacts, out.attachments);
    out.channels.clear();
}

void SofaWorld::record(physics::StepRecord& out) const
{
    const Lock lock(sofaMutex());
    out.rigidPoses.clear();
    RigidState state;
    for (const auto& body : scene_.rigid) {
        body->read(state);
        out.rigidPoses.insert(out.rigidPoses.end(), state.poses.begin(), state.poses.end());
    }
    writeConstraints(scene_, out.contacts, out.attachments);
    out.channels.clear();
}

std::uint64_t SofaWorld::hash() const
{
    const Lock lock(sofaMutex());
    Hasher hasher;
    hasher.add(steps_);
    hasher.add(time_);
    addTo(hasher, stateOf(scene_));
    return hasher.value();
}

std::shared_ptr<const physics::EngineState> SofaWorld::save() const
{
    const Lock lock(sofaMutex());
    auto state = std::make_shared<WorldState>();
    state->scene = stateOf(scene_);
    state->watch = watch_;
    state->time = time_;
    state->steps = steps_;
    return state;
}

void SofaWorld::restore(const physics::EngineState& saved)
{
    const auto* state = dynamic_cast<const WorldState*>(&saved);
    if (!state) fail("restore: the state is one of another engine");
    const Lock lock(sofaMutex());
    if (state->scene.soft.size() != scene_.soft.size() || state->scene.rigid.size() != scene_.rigid.size())
        fail("restore: the state has other bodies");
    try {
        setState(state->scene, scene_);
    } catch (...) {
        fail("restore: SOFA cannot make an attachment of the state: ", problemNow());
    }
    looksAgain_ = true;
    watch_ = state->watch;
    time_ = state->time;
    steps_ = state->steps;
}

::sofa::simulation::Node* SofaWorld::nodeOf(BodyId id) const
{
    if (const SoftNode* soft = findBody(scene_.soft, id)) return &soft->node();
    const RigidNode* rigid = findBody(scene_.rigid, id);
    return rigid ? &rigid->node() : nullptr;
}

std::unique_ptr<physics::PhysicsEngine> makeSofaEngine(const SofaEngineDef& def)
{
    return std::make_unique<SofaWorld>(def);
}

bool isBuiltIn() { return true; }

} // namespace filasofia::sofaengine

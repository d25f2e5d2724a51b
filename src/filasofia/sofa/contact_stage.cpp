#include "filasofia/sofa/contact_stage.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/sofa/make_tie.h"
#include "filasofia/sofa/rigid_plan.h"

#include <sofa/component/animationloop/FreeMotionAnimationLoop.h>
#include <sofa/component/collision/detection/algorithm/BVHNarrowPhase.h>
#include <sofa/component/collision/detection/algorithm/BruteForceBroadPhase.h>
#include <sofa/component/collision/detection/algorithm/CollisionPipeline.h>
#include <sofa/component/collision/detection/intersection/LocalMinDistance.h>
#include <sofa/component/collision/response/contact/CollisionResponse.h>
#include <sofa/component/constraint/lagrangian/solver/NNCGConstraintSolver.h>
#include <sofa/simulation/DefaultAnimationLoop.h>

#include <algorithm>
#include <utility>

namespace filasofia::sofaengine {
namespace {

using namespace ::sofa::component;
using ::sofa::core::objectmodel::New;
using ConstraintSolver = constraint::lagrangian::solver::NNCGConstraintSolver;

constexpr double kSkin = 0.2;    // [-] times the proximity, as the native engine's inset
constexpr double kAhead = 1.5;   // steps that contacts are looked for ahead, as in the native engine
constexpr double kFarAhead = 20; // [-] but not farther than so many proximities
// [-] sine of the angle by which a neighbour of a vertex may lie nearer, as in the native engine: with 0 only the
// lowest vertex of a face counts, in each step another.
constexpr double kCone = 0.1;
constexpr int kSweeps = 80;      // per round of ExactContact; a first touch may need 640 in all
constexpr double kLength = 1e-6; // [m] by ExactContact::tolerance times this a sweep may still move a contact

ConstraintSolver::SPtr solverOf(const physics::ExactContact& exact)
{
    auto solver = New<ConstraintSolver>();
    solver->d_maxIt.setValue(kSweeps * exact.rounds);
    solver->d_tolerance.setValue(kLength * exact.tolerance);
    solver->d_computeConstraintForces.setValue(true);
    return solver;
}

} // namespace

struct ContactStage::Parts {
    collision::detection::intersection::LocalMinDistance::SPtr distances;
    collision::detection::algorithm::BVHNarrowPhase::SPtr pairs;
    collision::response::contact::CollisionResponse::SPtr contacts;
    ConstraintSolver::SPtr solver; ///< null for penalties
};

ContactStage::ContactStage(const physics::ContactMethod& method) : method_(method)
{
    if (const auto* penalty = std::get_if<physics::PenaltyContact>(&method); penalty && penalty->damping > 0.0)
        fail("SOFA engine: contact: the damping of a PenaltyContact is not available with the engine 'sofa', got ",
             penalty->damping, " N s/m");
}

ContactStage::~ContactStage() = default;

double ContactStage::stiffness() const
{
    const auto* penalty = std::get_if<physics::PenaltyContact>(&method_);
    return penalty ? penalty->stiffness : 0.0;
}

// A penalty needs the whole proximity to push in: beyond the other side of a surface SOFA's detection loses it.
double ContactStage::skin(double proximity) const { return isExact() ? kSkin * proximity : proximity; }

// What an assembled system of SOFA 25.12 makes of penalties pulls bodies in.
void ContactStage::check(const physics::BodyDef& def) const
{
    const auto* soft = std::get_if<physics::SoftBodyDef>(&def);
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&def);
    const bool ties = soft ? std::ranges::any_of(soft->attachments, isTie) : rigid && !rigid->attachments.empty();
    if (ties) checkTies(describeBody(def) + ": attachments");
    if (rigid && isDriven(*rigid)) checkDrives(describeBody(def) + ": articulation");
    const double friction = soft ? soft->friction : rigid ? rigid->friction : 0.0;
    const bool collides = soft ? !soft->collision.empty() : rigid && !rigid->collision.empty();
    if (!isExact() && collides && friction > 0.0 && !toldOfFriction_.exchange(true))
        logWarning(describeBody(def), ": friction ", friction,
                   " has no effect: contacts by PenaltyContact have none with the engine 'sofa'");
    if (!soft || isExact() || soft->collision.empty() ||
        !std::holds_alternative<physics::ImplicitEuler>(soft->integrator))
        return;
    const auto* iterative = std::get_if<physics::ConjugateGradient>(&soft->solver);
    if (!iterative || iterative->assembled)
        fail(describeBody(def), ": solver: a matrix and collision by PenaltyContact are not available together with "
                                "the engine 'sofa': use ConjugateGradient");
}

void ContactStage::checkTies(const std::string& object) const
{
    if (!isExact())
        fail(object, ": attachments between bodies, and ones that break, are not available by PenaltyContact with the "
                     "engine 'sofa'");
}

void ContactStage::checkDrives(const std::string& object) const
{
    if (!isExact())
        fail(object, ": joints that forces move are not available by PenaltyContact with the engine 'sofa'");
}

void ContactStage::start(::sofa::simulation::Node& root)
{
    registerResponses();
    auto parts = std::make_unique<Parts>();
    if (const auto* exact = std::get_if<physics::ExactContact>(&method_)) {
        const auto loop = New<animationloop::FreeMotionAnimationLoop>();
        loop->d_computeBoundingBox.setValue(false); // only SOFA's own pictures need it
        root.removeObject(root.getAnimationLoop());
        root.addObject(loop);
        root.addObject(parts->solver = solverOf(*exact));
        loop->init();
    }
    const auto pipeline = New<collision::detection::algorithm::CollisionPipeline>();
    root.addObject(pipeline);
    root.addObject(New<collision::detection::algorithm::BruteForceBroadPhase>());
    root.addObject(parts->pairs = New<collision::detection::algorithm::BVHNarrowPhase>());
    root.addObject(parts->distances = New<collision::detection::intersection::LocalMinDistance>());
    parts->distances->setContactDistance(0.0); // models have their own
    parts->distances->d_angleCone.setValue(kCone);
    parts->distances->setAlarmDistance(proximity_); // prepare() sets what counts
    parts->distances->init();
    root.addObject(parts->contacts = New<collision::response::contact::CollisionResponse>());
    parts->contacts->setDefaultResponseType(isExact() ? kFriction : kPenalty);
    parts->contacts->init();
    pipeline->init();
    parts_ = std::move(parts);
}

void ContactStage::join(const std::vector<CollisionPlan>& models)
{
    joined_ = true;
    for (const CollisionPlan& each : models) proximity_ = std::max(proximity_, each.def.proximity);
}

void ContactStage::prepare(double speed, double dt)
{
    if (!isOn()) return;
    if (std::exchange(joined_, false) && parts_->solver) parts_->solver->init(); // it lists the bodies
    const double apart = 2.0 * (proximity_ - skin(proximity_));                  // what two models add is their skins
    const double ahead = std::min(2.0 * kAhead * speed * dt, kFarAhead * proximity_);
    parts_->distances->setAlarmDistance(apart + ahead);
}

void ContactStage::read(double dt, std::vector<FoundContact>& out, physics::StepReport& report) const
{
    out.clear();
    if (!isOn()) return;
    for (const auto& each : parts_->contacts->getContacts())
        if (const auto* source = dynamic_cast<const ContactSource*>(each.get())) source->read(impulses(), dt, out);
    report.contacts.found = static_cast<int>(out.size());
    for (const auto& [contact, firstElement, secondElement] : out) {
        report.contacts.active += contact.normalForce > 0.0 ? 1 : 0;
        report.contacts.penetration = std::max(report.contacts.penetration, -contact.gap);
    }
    if (!out.empty()) report.contacts.rounds = 1;
    if (impulses().empty()) return;
    const int sweeps = parts_->solver->d_currentIterations.getValue();
    report.contacts.rounds = (sweeps + kSweeps - 1) / kSweeps;
    // SOFA does not count the first sweep.
    if (sweeps + 1 >= static_cast<int>(parts_->solver->d_maxIt.getValue())) report.set(physics::StepFlag::NotConverged);
}

std::span<const double> ContactStage::impulses() const
{
    if (!isOn() || !parts_->solver) return {};
    return parts_->solver->d_constraintForces.getValue();
}

void ContactStage::forget()
{
    if (!isOn()) return;
    parts_->contacts->cleanup();
    parts_->pairs->beginNarrowPhase(); // it keeps lists by the addresses of models
    parts_->pairs->endNarrowPhase();
}

} // namespace filasofia::sofaengine

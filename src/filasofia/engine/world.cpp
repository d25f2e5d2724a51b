#include "filasofia/engine/world.h"

#include "filasofia/core/error.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/clip_legs.h"
#include "filasofia/engine/contact/find_contacts.h"
#include "filasofia/engine/contact/joint_constraints.h"
#include "filasofia/engine/contact/pinned_contacts.h"
#include "filasofia/engine/contact/sheathed_blades.h"
#include "filasofia/engine/contact/tie_bodies.h"
#include "filasofia/engine/piercing/channels.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/engine/scene/mechanical_energy.h"
#include "filasofia/engine/scene/state_hash.h"
#include "filasofia/engine/step/advance.h"
#include "filasofia/engine/step/apply_commands.h"
#include "filasofia/engine/step/assemble.h"
#include "filasofia/engine/step/close_clips.h"
#include "filasofia/engine/step/fill_cavities.h"
#include "filasofia/engine/step/flow_tissue.h"
#include "filasofia/engine/step/steer_rods.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// Times the stages of a step with the clock of the step's budget.
class StopWatch {
public:
    explicit StopWatch(const physics::StepBudget* budget) : now_(budget && budget->now ? &budget->now : nullptr)
    {
        if (now_) last_ = (*now_)();
    }
    /// [s] since the last lap; 0 without a clock.
    double lap()
    {
        if (!now_) return 0.0;
        const std::int64_t before = std::exchange(last_, (*now_)());
        return 1e-9 * static_cast<double>(last_ - before);
    }

private:
    const std::function<std::int64_t()>* now_;
    std::int64_t last_ = 0;
};

/// What a step of the engine begins with.
struct WorldState final : physics::EngineState {
    double period = 0.0; ///< [s]
    Scene scene;
    RestWatch rest;
    std::vector<CollisionSurface> surfaces; ///< with these, bodies are not new to contact detection
    std::vector<std::array<SurfaceName, 2>> startedInside;
    IntersectionWatch intersections;
};

} // namespace

World::World(const NativeEngineDef& def)
    : period_(def.period), contact_(def.contact),
      pool_(std::make_unique<WorkerPool>(def.threads.value_or(std::clamp(usableCores() - 1, 1, 8)))),
      background_(std::make_unique<BackgroundThread>())
{
}

std::unique_ptr<physics::BuiltBody> World::build(const physics::BodyDef& def) const { return buildBody(def, period_); }

physics::StepReport World::step(const physics::StepInput& in)
{
    physics::StepReport report{.dt = in.dt, .flags = in.flags};
    const StepContext context{in.dt, in.budget, contact_, *pool_, report};
    StopWatch watch(in.budget);

    applyCommands(context, in.commands, *this, scene_); // 1 the user's commands
    rebuildSystems(period_, scene_);                    //   solvers of bodies that they changed, each once
    steerRods(context, scene_);                         //   rods that bend by themselves
    report.times.commands = watch.lap();

    planRigid(scene_, in.dt, coupling_.rigid); // 2 how rigid bodies would move without constraints
    planArticulations(scene_, in.dt, coupling_.rigid, coupling_.articulations);
    followSheaths(scene_, report.topology);        //   blades that are switched off and still in tissue
    findContacts(context, scene_, coupling_);      //   constraints: contacts
    partLines(scene_);                             //   threads that were released follow no needle
    leaveToChannels(in.dt, scene_, coupling_);     //   contacts, but not of needles with the tissue that they are in
    yieldToTips(in.dt, scene_, coupling_);         //   tissue that is pinned gives way to needles,
    yieldWherePinned(in.dt, scene_, coupling_);    //   and to what is driven into it
    addWelds(context, scene_, coupling_);          //   attachments
    addChannels(context, scene_, coupling_);       //   needles and threads in tissue
    closeClips(in.dt, scene_);                     //   how far clips are closed
    addClipLegs(in.dt, scene_, coupling_);         //   and how they draw tissue together
    addJointConstraints(in.dt, scene_, coupling_); //   limits and dry friction of joints
    report.times.contacts = watch.lap();

    fillCavities(in.dt, scene_);         //   what flows into cavities
    assemble(context, scene_);           // 3 forces and stiffness
    tieBodies(in.dt, scene_, coupling_); //   what solvers know of attachments
    report.times.assemble = watch.lap();

    advance(context, scene_, coupling_);      // 4 solve; new velocities and positions
    keepContacts(context, coupling_, scene_); //   forces and warm starts of the constraints
    keepWelds(context, coupling_, scene_);
    keepClips(scene_, report);              //   those that were pulled off are gone
    keepChannels(in.dt, coupling_, scene_); //   needles slide and cut on
    puncture(in.dt, coupling_, scene_);     //   and pierce new surfaces
    keepJoints(in.dt, coupling_, scene_);
    drainCavities(in.dt, scene_); //   what flows out of open cavities
    report.times.advance = watch.lap();

    flowTissue(context, scene_);                          // 5 tissue that yields gets a new shape at rest
    cutBodies(context, coupling_.rigid, scene_, blades_); //   cut by blades
    applyEdits(period_, scene_, report);                  // 6 the only writer of topology
    tearBodies(context, scene_);                          //   tear by stress
    applyEdits(period_, scene_, report);
    removeLostPieces(scene_, report);
    followPartings(in.dt, scene_, *background_);
    report.times.topology = watch.lap();

    rest_.follow(in, scene_, report); // 7 what moves though nothing drives it
    return report;
}

void World::capture(frame::Frame& out) const
{
    out.step = scene_.step;
    out.time = scene_.time;
    out.softBodies.resize(scene_.soft.size());
    for (std::size_t b = 0; b < scene_.soft.size(); ++b) {
        const SoftBody& body = scene_.soft[b];
        out.softBodies[b].id = body.model.id;
        out.softBodies[b].positions = body.state.x;
        out.softBodies[b].velocities = body.state.v;
        out.softBodies[b].boundary = boundaryOf(body.model, body.topology);
        out.softBodies[b].directors = body.state.rod.directors;
        listCutEdges(body.model.rod, out.softBodies[b].cutEdges);
    }
    out.contacts = scene_.contactReports;
    out.attachments = scene_.attachmentReports;
    placePoints(scene_, out.attachedPoints);
    out.channels = scene_.channelReports;
    out.cavities = scene_.cavityReports;
    out.clips = scene_.clipReports;
    out.rigidBodies.resize(scene_.rigid.size());
    for (std::size_t b = 0; b < scene_.rigid.size(); ++b) {
        const RigidState& state = scene_.rigid[b].state;
        out.rigidBodies[b].id = scene_.rigid[b].model.id;
        out.rigidBodies[b].poses = state.poses;
        out.rigidBodies[b].velocities = state.velocities;
        out.rigidBodies[b].angularVelocities = state.angularVelocities;
        out.rigidBodies[b].joints.clear();
        for (const JointState& joint : state.joints) out.rigidBodies[b].joints.push_back(joint.now);
    }
}

void World::record(physics::StepRecord& out) const
{
    out.rigidPoses.clear();
    for (const RigidBody& body : scene_.rigid)
        out.rigidPoses.insert(out.rigidPoses.end(), body.state.poses.begin(), body.state.poses.end());
    out.contacts = scene_.contactReports;
    out.attachments = scene_.attachmentReports;
    out.channels = scene_.channelReports;
}

std::uint64_t World::hash() const { return hashOf(scene_); }

physics::MechanicalEnergy World::energyOf(BodyId body) const
{
    const std::optional<BodyPlace> place = findBody(scene_, body);
    if (!place) fail("mechanicalEnergy: body ", body.value, " is there only after the next step");
    return place->soft ? mechanicalEnergy(scene_.soft[place->index], scene_.gravity)
                       : mechanicalEnergy(scene_.rigid[place->index], scene_.gravity);
}

std::shared_ptr<const physics::EngineState> World::save() const
{
    const auto state = std::make_shared<WorldState>();
    state->period = period_;
    state->scene = scene_;
    state->rest = rest_;
    const ContactDetection& detection = coupling_.detection;
    state->surfaces = detection.surfaces;
    state->startedInside = detection.startedInside;
    state->intersections = detection.intersections;
    return state;
}

void World::restore(const physics::EngineState& saved)
{
    const auto* state = dynamic_cast<const WorldState*>(&saved);
    if (!state) fail("restore: the state is one of another engine");
    if (state->period != period_)
        fail("restore: the state is one of a simulation with steps of ", state->period, " s, but here they take ",
             period_, " s");
    scene_ = state->scene;
    rest_ = state->rest;
    ContactDetection& detection = coupling_.detection;
    detection.surfaces = state->surfaces;
    detection.startedInside = state->startedInside;
    detection.intersections = state->intersections;
}

} // namespace filasofia::engine

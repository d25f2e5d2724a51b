#include "filasofia/physics/physics_server.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/log.h"
#include "filasofia/core/mpsc_queue.h"
#include "filasofia/core/spsc_ring.h"
#include "filasofia/core/validate.h"
#include "filasofia/physics/command_trial.h"
#include "filasofia/physics/mesh_warnings.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/registry.h"
#include "filasofia/physics/registry_hold.h"
#include "filasofia/physics/saved_state.h"

#include <atomic>
#include <cmath>
#include <concepts>
#include <deque>
#include <mutex>
#include <utility>

namespace filasofia::physics {
namespace {

constexpr std::size_t kMaxCommands = 4096; // per step
constexpr std::size_t kMaxSpent = 64;

thread_local const void* steppedHere = nullptr; ///< the server that this thread steps; see PhysicsServer::Stepping

/// Where a command keeps the ids of the attachments that it makes.
struct AttachmentIds {
    AttachmentId* first = nullptr;
    std::uint32_t count = 0;
};
AttachmentIds attachmentIdsOf(Command& command)
{
    if (auto* add = std::get_if<AddBody>(&command)) return {&add->attachments, attachmentCount(*add->def)};
    if (auto* attach = std::get_if<Attach>(&command)) return {&attach->id, 1};
    if (auto* rigid = std::get_if<AttachRigid>(&command)) return {&rigid->id, 1};
    if (auto* grasp = std::get_if<Grasp>(&command)) return {&grasp->id, 1};
    if (auto* clip = std::get_if<ApplyClip>(&command)) return {&clip->id, 1};
    return {};
}

/// The body that a command is for; none for a command of the whole scene, and for AddBody.
BodyId subjectOf(const Command& command)
{
    return std::visit(
        [](const auto& each) -> BodyId {
            if constexpr (requires { requires std::same_as<decltype(each.body), BodyId>; })
                return each.body;
            else if constexpr (requires { each.rigid; })
                return each.rigid;
            else if constexpr (requires { requires std::same_as<decltype(each.id), BodyId>; })
                return std::is_same_v<std::decay_t<decltype(each)>, AddBody> ? BodyId{} : each.id;
            else
                return {};
        },
        command);
}

/// The Def of a soft body with another material, in which names of labels are numbers.
BodyDef withMaterial(BodyDef def, const SoftMaterial& material)
{
    std::get<SoftBodyDef>(def).material = material;
    return loaded(std::get<SoftBodyDef>(std::move(def)));
}

/// Marks a step in progress. A second one at the same time, from another thread or from within a step, is refused
/// before it changes anything.
class SoleStep {
public:
    explicit SoleStep(std::atomic_flag& under) : underWay_(under)
    {
        if (underWay_.test_and_set(std::memory_order_acquire))
            fail("physics: a step is already in progress: only one thread at a time may step a server");
    }
    ~SoleStep() { underWay_.clear(std::memory_order_release); }
    SoleStep(const SoleStep&) = delete;
    SoleStep& operator=(const SoleStep&) = delete;

private:
    std::atomic_flag& underWay_;
};

} // namespace

struct PhysicsServer::Impl {
    std::unique_ptr<PhysicsEngine> engine;
    std::vector<Command> commands; ///< commands of the current step
    frame::FramePool frames;
    SpscRing<StepRecord> log;
    /// Replaced material data on its way back, because freeing it may take longer than a step has. Read under the lock.
    SpscRing<std::unique_ptr<BuiltBody>> spent{kMaxSpent};
    bool hashing = false;
    bool recordLost = false; ///< since the last record written
    bool paused = false;
    bool began = false; ///< a step was asked for: the engine can no longer be replaced
    std::atomic<bool> logging = false;
    std::atomic_flag stepping = {}; ///< see SoleStep

    /// A command, and for AddBody the data that the registries keep of the body, made before any lock is taken.
    struct Posted {
        Command command;
        std::shared_ptr<const Registry::Body> added = {};
    };

    // Commands arrive in two ways. Every thread except the stepping thread takes a lock, checks against `registry` and
    // pushes to the inbox. The stepping thread (class Stepping) takes no lock: it checks against `known`, which is
    // updated with each command that arrives from the inbox, and appends to `arrived`. A command that has arrived has
    // its place among all others, so the order of each thread's commands is kept, and there is one order for all.

    /// Held from the lookup of a body to the push of its command, so that no command for a body comes after the one
    /// that removes it. The stepping thread takes it only to add a body.
    mutable std::mutex registryMutex;
    Registry registry;
    MpscQueue<Posted> inbox;
    /// What the stepping thread did to a body, on its way to `registry`: it removed it, or set its material.
    struct News {
        BodyId id;
        std::optional<std::size_t> families; ///< of fibres; none: the body is gone
    };
    MpscQueue<News> news; ///< read under the lock
    std::atomic<std::uint32_t> lastAttachment = 0;

    // The members below are used only by the stepping thread.
    Registry known;
    std::deque<Posted> arrived; ///< commands that wait for their step
    bool removes = false;       ///< whether it has removed bodies: other threads' commands for these come too late

    Impl(std::unique_ptr<PhysicsEngine> made, int logLength)
        : engine(std::move(made)), log(static_cast<std::size_t>(logLength))
    {
    }

    BodyId add(BodyDef def)
    {
        check(def);
        AddBody add{.def = std::make_shared<const BodyDef>(std::move(def))};
        add.body = engine->build(*add.def);
        const auto kept = Registry::bodyOf(add);
        warnOfMesh(*add.def);
        const std::lock_guard lock(registryMutex); // so that bodies arrive in the order of their ids
        add.id = {registry.lastAdded().value + 1};
        const BodyId id = add.id;
        push(std::move(add), kept);
        return id;
    }

    [[nodiscard]] bool isStepping() const { return steppedHere == this; }

    /// Answers from the registry that the calling thread may read.
    template <class Ask> auto ask(Ask&& answer)
    {
        if (isStepping()) {
            takeArrived();
            return answer(known);
        }
        const std::lock_guard lock(registryMutex);
        takeNews();
        return answer(registry);
    }

    /// The slow part of a new material is done here, as in add(): the step only moves it in.
    void setMaterial(BodyId id, const SoftMaterial& material)
    {
        std::vector<std::unique_ptr<BuiltBody>> ends; // freed here, and not under the lock
        BodyDef def = ask([&](const Registry& bodies) {
            bodies.checkMaterial(id, material);
            if (!isStepping()) // the stepping thread fills the ring
                for (; auto* body = spent.beginRead(); spent.release()) ends.push_back(std::move(*body));
            return *bodies.find(id).def;
        });
        def = withMaterial(std::move(def), material);
        post(SetMaterial{id, std::get<SoftBodyDef>(def).material, engine->build(def)});
    }

    /// Looks for the tetrahedra here, unless they depend on where the body is in the step.
    void setTissue(BodyId id, TissueRegion region, const std::optional<TissueFactors>& factors)
    {
        const auto def = ask([&](const Registry& bodies) { return bodies.find(id).def; });
        const auto* soft = std::get_if<SoftBodyDef>(def.get());
        if (soft && !isPlace(region.where)) {
            validate(region, describeBody(*def) + ": region");
            region.where = Listed{tetrahedraOf(region.where, *loadMesh(*soft), describeBody(*def) + ": region.where")};
        }
        post(SetTissue{id, std::move(region), factors});
    }

    /// Returns the attachment that the command makes, if it makes one. Throws an Error if it is invalid.
    AttachmentId post(Command command)
    {
        if (!isStepping()) {
            const std::lock_guard lock(registryMutex);
            return push(std::move(command));
        }
        takeArrived();
        const AttachmentId made = checkAndNumber(known, command);
        known.note(command);
        if (const auto* remove = std::get_if<RemoveBody>(&command)) {
            removes = true;
            news.push({remove->id, {}});
        } else if (const auto* set = std::get_if<SetMaterial>(&command)) {
            news.push({set->id, familiesOf(set->material)});
        }
        arrived.push_back({std::move(command)});
        return made;
    }

    /// Called under the lock.
    AttachmentId push(Command command, std::shared_ptr<Registry::Body> added = {})
    {
        takeNews();
        const AttachmentId made = checkAndNumber(registry, command);
        if (added) added->firstAttachment = made;
        registry.note(command, added);
        inbox.push({std::move(command), std::move(added)});
        return made;
    }

    AttachmentId checkAndNumber(Registry& bodies, Command& command)
    {
        const AttachmentIds ids = checkNumbered(bodies, {lastAttachment.load()}, command);
        if (ids.count == 0) return {};
        return *ids.first = {lastAttachment.fetch_add(ids.count) + 1};
    }

    /// Ids are assigned after the check: an invalid command takes none.
    AttachmentIds checkNumbered(Registry& bodies, AttachmentId last, Command& command) const
    {
        bodies.knowAttachments(last);
        const AttachmentIds ids = attachmentIdsOf(command);
        if (ids.count > 0) *ids.first = {last.value + 1};
        bodies.check(command);
        const BodyId subject = subjectOf(command);
        engine->check(command, subject == BodyId{} ? nullptr : bodies.find(subject).def.get());
        return ids;
    }

    /// Called under the lock.
    void takeNews()
    {
        while (const auto each = news.pop())
            if (!registry.has(each->id))
                continue;
            else if (each->families)
                registry.noteFamilies(each->id, *each->families);
            else
                registry.note(RemoveBody{each->id});
    }

    /// Called by the stepping thread.
    void takeArrived()
    {
        while (auto posted = inbox.pop()) {
            const bool late = removes || std::holds_alternative<SetFibreStress>(posted->command);
            if (late && comesTooLate(posted->command)) continue;
            known.note(posted->command, posted->added);
            arrived.push_back(std::move(*posted));
        }
    }

    /// Whether the stepping thread has removed a body that the command names, or its fibres, since the command was
    /// checked.
    bool comesTooLate(const Command& command)
    {
        try {
            known.knowAttachments({lastAttachment.load()});
            known.check(command);
            return false;
        } catch (const Error& problem) {
            logWarning("physics: a command came too late: ", problem.what());
        }
        if (const auto* add = std::get_if<AddBody>(&command))
            news.push({add->id, {}}); // it was attached to a removed body
        return true;
    }

    /// Collects the commands of the next step.
    void gather()
    {
        commands.clear();
        takeArrived();
        while (commands.size() < kMaxCommands && !arrived.empty()) { // further commands wait: a step must end
            Command& command = arrived.front().command;
            if (const auto* pause = std::get_if<Pause>(&command)) paused = pause->paused;
            commands.push_back(std::move(command));
            arrived.pop_front();
        }
    }

    /// What waits, checked and built by another engine: a body for each command that has one, else null.
    std::vector<std::unique_ptr<BuiltBody>> builtBy(const PhysicsEngine& other)
    {
        std::vector<std::unique_ptr<BuiltBody>> bodies;
        for (const Posted& each : arrived) {
            std::unique_ptr<BuiltBody>& body = bodies.emplace_back();
            const BodyId subject = subjectOf(each.command);
            const BodyDef* def = known.has(subject) ? known.find(subject).def.get() : nullptr;
            if (std::holds_alternative<Tune>(each.command))
                fail("physics: the engine cannot be replaced: a tune() of the engine before waits");
            other.check(each.command, def);
            if (const auto* add = std::get_if<AddBody>(&each.command)) body = other.build(*add->def);
            if (const auto* set = std::get_if<SetMaterial>(&each.command); set && def) {
                BodyDef changed = *def;
                std::get<SoftBodyDef>(changed).material = set->material;
                body = other.build(changed);
            }
        }
        return bodies;
    }

    void useEngine(std::unique_ptr<PhysicsEngine> other)
    {
        const std::lock_guard lock(registryMutex);
        if (began) fail("physics: the engine cannot be replaced after a step");
        takeArrived();
        std::vector<std::unique_ptr<BuiltBody>> bodies = builtBy(*other);
        for (std::size_t i = 0; i < bodies.size(); ++i)
            if (auto* add = std::get_if<AddBody>(&arrived[i].command))
                add->body = std::move(bodies[i]);
            else if (auto* set = std::get_if<SetMaterial>(&arrived[i].command))
                set->body = std::move(bodies[i]);
        engine = std::move(other);
    }

    void giveBackSpent()
    {
        for (Command& command : commands)
            if (auto* set = std::get_if<SetMaterial>(&command); set && set->body) {
                std::unique_ptr<BuiltBody> body = std::move(set->body); // freed here if the ring is full
                if (auto* place = spent.beginWrite()) {
                    *place = std::move(body);
                    spent.publish();
                }
            }
    }

    void writeLog(StepReport& report)
    {
        if (!logging.load(std::memory_order_relaxed)) {
            recordLost = true; // a log that is turned on later has missed these steps
            return;
        }
        StepRecord* record = log.beginWrite();
        if (!record) {
            recordLost = true;
            return report.set(StepFlag::RecordLost);
        }
        record->report = report;
        if (std::exchange(recordLost, false)) record->report.set(StepFlag::RecordLost); // the reader must see the gap
        record->hash = hashing ? engine->hash() : 0;
        record->commands.clear();
        for (Command& command : commands) record->commands.push_back(std::move(command));
        engine->record(*record);
        log.publish();
    }

    [[nodiscard]] std::unique_ptr<const SavedState::Content> save()
    {
        takeArrived();
        std::vector<Command> waiting;
        for (const Posted& each : arrived) waiting.push_back(copyOfWaiting(each.command));
        return std::make_unique<const SavedState::Content>(
            SavedState::Content{engine->save(), known, {lastAttachment.load()}, std::move(waiting), paused});
    }

    void restore(const SavedState::Content& state)
    {
        const std::lock_guard lock(registryMutex);
        takeArrived();
        takeNews();
        if (const std::string difference = known.differenceFrom(state.registry); !difference.empty())
            fail("restore: ", difference);
        frame::Frame* frame = frames.beginWrite();
        if (!frame) fail("restore: readers hold all frames: release them first");
        try {
            engine->restore(*state.engine);
        } catch (...) {
            publish(*frame);
            throw;
        }
        known = registry = state.registry;
        lastAttachment = state.lastAttachment.value;
        arrived.clear();
        for (const Command& each : state.waiting) arrived.push_back({copyOfWaiting(each)});
        paused = state.paused;
        publish(*frame);
    }

    void publishFrame()
    {
        frame::Frame* frame = frames.beginWrite();
        if (!frame) return; // readers hold all frames: they will get the next one
        publish(*frame);
    }
    void publish(frame::Frame& frame)
    {
        engine->capture(frame);
        frames.publish();
    }
};

PhysicsServer::PhysicsServer(std::unique_ptr<PhysicsEngine> engine, const PhysicsServerDef& def)
{
    FILASOFIA_ASSERT(engine != nullptr);
    validate(def, "physics server");
    impl_ = std::make_unique<Impl>(std::move(engine), def.logLength);
    impl_->inbox.push({SetGravity{def.gravity}});
}

PhysicsServer::~PhysicsServer() = default;

PhysicsServer::Stepping::Stepping(PhysicsServer& server) : before_(std::exchange(steppedHere, server.impl_.get())) {}
bool PhysicsServer::stepsHere() const { return impl_->isStepping(); }

RegistryHold::RegistryHold(PhysicsServer& server) : lock_(server.impl_->registryMutex) {}

PhysicsServer::Stepping::~Stepping() { steppedHere = before_; }

BodyId PhysicsServer::add(SoftBodyDef def)
{
    def = loaded(std::move(def)); // read once, so that the engine and the visual side use the same mesh
    def.pose = unitPose(def.pose, text("soft body '", def.name, "': pose"));
    return impl_->add(std::move(def));
}
BodyId PhysicsServer::add(RigidBodyDef def)
{
    def = loaded(std::move(def));
    for (std::size_t e = 0; e < def.elements.size(); ++e)
        def.elements[e] = unitPose(def.elements[e], text("rigid body '", def.name, "': elements[", e, "]"));
    if (!def.articulation.joints.empty()) { // the visual side reads the poses of the links from the Def
        check(BodyDef{def});
        def.elements = elementPoses(def);
    }
    return impl_->add(std::move(def));
}

BodyId PhysicsServer::add(RodBodyDef def)
{
    def.pose = unitPose(def.pose, text("rod '", def.name, "': pose"));
    return impl_->add(std::move(def));
}

void PhysicsServer::remove(BodyId id) { impl_->post(RemoveBody{id}); }
void PhysicsServer::setPose(BodyId id, const Pose& pose, int element) { impl_->post(SetPose{id, element, pose}); }
void PhysicsServer::setGravity(Vec3 gravity) { impl_->post(SetGravity{gravity}); }
void PhysicsServer::setMaterial(BodyId id, const SoftMaterial& material) { impl_->setMaterial(id, material); }
void PhysicsServer::setTissue(BodyId id, const TissueRegion& region, const std::optional<TissueFactors>& factors)
{
    impl_->setTissue(id, region, factors);
}
void PhysicsServer::setFibreStress(BodyId id, int family, double stress)
{
    impl_->post(SetFibreStress{id, family, stress});
}
void PhysicsServer::setCurvature(BodyId id, std::vector<RodSection> sections, double rate)
{
    impl_->post(SetCurvature{id, std::move(sections), rate});
}
void PhysicsServer::setCutting(BodyId id, bool cutting) { impl_->post(SetCutting{id, cutting}); }
void PhysicsServer::setForces(BodyId id, std::vector<NodalForce> forces)
{
    impl_->post(SetForces{id, std::move(forces)});
}
void PhysicsServer::setPressure(BodyId id, double pressure) { impl_->post(SetPressure{id, pressure}); }

void PhysicsServer::setCavity(const SetCavity& command) { impl_->post(SetCavity(command)); }
void PhysicsServer::setWrench(BodyId id, Vec3 force, Vec3 torque, int element)
{
    impl_->post(SetWrench{id, element, force, torque});
}
void PhysicsServer::setJoint(BodyId id, int joint, const JointCommand& command)
{
    impl_->post(SetJoint{id, joint, command});
}
void PhysicsServer::setHaptic(BodyId id, const HapticTarget& target, int element)
{
    impl_->post(SetHaptic{id, element, target});
}
AttachmentId PhysicsServer::attach(BodyId soft, AttachmentDef def)
{
    return impl_->post(Attach{{}, soft, std::move(def)});
}
AttachmentId PhysicsServer::attach(BodyId rigid, RigidAttachmentDef def)
{
    return impl_->post(AttachRigid{{}, rigid, std::move(def)});
}
AttachmentId PhysicsServer::grasp(BodyId rigid, BodyId target, const GraspDef& def)
{
    return impl_->post(Grasp{{}, rigid, target, def});
}
AttachmentId PhysicsServer::clip(BodyId rigid, BodyId soft, const ClipDef& def)
{
    return impl_->post(ApplyClip{{}, rigid, soft, def});
}
void PhysicsServer::removePiece(BodyId soft, int piece) { impl_->post(RemovePiece{soft, piece}); }
void PhysicsServer::release(AttachmentId id) { impl_->post(Release{id}); }
void PhysicsServer::pause(bool paused) { impl_->post(Pause{paused}); }
void PhysicsServer::reset() { impl_->post(Reset{}); }
void PhysicsServer::tune(std::function<void(PhysicsEngine&)> change) { impl_->post(Tune{std::move(change)}); }

std::shared_ptr<const BodyDef> PhysicsServer::def(BodyId id) const
{
    return impl_->ask([&](const Registry& bodies) { return bodies.find(id).def; });
}

std::vector<AttachmentId> PhysicsServer::attachments(BodyId id) const
{
    return impl_->ask([&](const Registry& bodies) {
        const Registry::Body& body = bodies.find(id);
        std::vector<AttachmentId> ids;
        for (std::uint32_t k = 0; k < attachmentCount(*body.def); ++k) ids.push_back({body.firstAttachment.value + k});
        return ids;
    });
}

StepReport PhysicsServer::step(double dt, std::uint32_t flags, const StepBudget& budget)
{
    if (!(std::isfinite(dt) && dt > 0.0)) fail("physics: step: dt must be > 0 s and finite, got ", dt);
    const SoleStep sole(impl_->stepping);
    impl_->began = true;
    impl_->gather();
    StepReport report = impl_->engine->step(
        {.dt = impl_->paused ? 0.0 : dt, .commands = impl_->commands, .flags = flags, .budget = &budget});
    impl_->giveBackSpent();
    impl_->writeLog(report);
    impl_->publishFrame();
    return report;
}

void PhysicsServer::expect(std::vector<Command> commands)
{
    const SoleStep sole(impl_->stepping);
    const std::lock_guard lock(impl_->registryMutex);
    impl_->began = true;
    for (const Command& command : commands) {
        impl_->registry.check(command);
        impl_->registry.note(command);
        impl_->known.note(command);
    }
    impl_->lastAttachment = impl_->registry.lastAttachment().value;
    impl_->commands = std::move(commands);
}

StepReport PhysicsServer::replayStep(double dt, const StepBudget& budget)
{
    if (!(std::isfinite(dt) && dt >= 0.0)) fail("physics: replayStep: dt must be >= 0 s and finite, got ", dt);
    const SoleStep sole(impl_->stepping);
    const StepReport report = impl_->engine->step({.dt = dt, .commands = impl_->commands, .budget = &budget});
    impl_->giveBackSpent();
    impl_->commands.clear();
    impl_->publishFrame();
    return report;
}

std::vector<BodyId> PhysicsServer::bodies() const
{
    return impl_->ask([](const Registry& bodies) { return bodies.bodies(); });
}

bool PhysicsServer::has(BodyId id) const
{
    return impl_->ask([&](const Registry& bodies) { return bodies.has(id); });
}

std::string PhysicsServer::nameOf(BodyId id) const
{
    return impl_->ask([&](const Registry& bodies) { return bodies.bodyName(id); });
}

const PhysicsEngine& PhysicsServer::engine() const { return *impl_->engine; }

void PhysicsServer::useEngine(std::unique_ptr<PhysicsEngine> engine)
{
    FILASOFIA_ASSERT(engine != nullptr);
    const SoleStep sole(impl_->stepping);
    impl_->useEngine(std::move(engine));
}

std::shared_ptr<const SavedState> PhysicsServer::save()
{
    const SoleStep sole(impl_->stepping);
    return std::make_shared<const SavedState>(impl_->save());
}

void PhysicsServer::restore(const SavedState& state)
{
    const SoleStep sole(impl_->stepping);
    impl_->restore(state.content());
}

std::uint64_t PhysicsServer::hash() const { return impl_->engine->hash(); }

MechanicalEnergy PhysicsServer::mechanicalEnergy(BodyId id) const
{
    static_cast<void>(def(id)); // throws if there is none
    const SoleStep sole(impl_->stepping);
    return impl_->engine->energyOf(id);
}

void PhysicsServer::hashEveryStep(bool on) { impl_->hashing = on; }
bool PhysicsServer::paused() const { return impl_->paused; }
frame::FrameRef PhysicsServer::latest() { return impl_->frames.latest(); }
StepRecord* PhysicsServer::nextRecord() { return impl_->log.beginRead(); }
void PhysicsServer::popRecord() { impl_->log.release(); }
void PhysicsServer::keepLog(bool on) { impl_->logging.store(on, std::memory_order_relaxed); }

struct CommandTrial::Impl {
    const PhysicsServer::Impl* server = nullptr;
    Registry bodies = {};
    AttachmentId last = {};
};

CommandTrial::CommandTrial(const PhysicsServer& server) : impl_(std::make_unique<Impl>())
{
    impl_->server = server.impl_.get();
    impl_->bodies = server.impl_->ask([](const Registry& bodies) { return bodies; });
    impl_->last = {server.impl_->lastAttachment.load()};
}
CommandTrial::~CommandTrial() = default;

void CommandTrial::mustBeThere(BodyId id) const { static_cast<void>(impl_->bodies.find(id)); }

AttachmentId CommandTrial::give(Command command)
{
    Registry& bodies = impl_->bodies;
    if (auto* set = std::get_if<SetMaterial>(&command)) {
        bodies.checkMaterial(set->id, set->material);
        set->material = std::get<SoftBodyDef>(withMaterial(*bodies.find(set->id).def, set->material)).material;
    }
    const AttachmentIds ids = impl_->server->checkNumbered(bodies, impl_->last, command);
    bodies.note(command);
    if (ids.count > 0) impl_->last = *ids.first;
    return ids.count > 0 ? *ids.first : AttachmentId{};
}

} // namespace filasofia::physics

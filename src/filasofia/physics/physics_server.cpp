#include "filasofia/physics/physics_server.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/mpsc_queue.h"
#include "filasofia/core/spsc_ring.h"
#include "filasofia/core/validate.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/registry.h"

#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

namespace filasofia::physics {
namespace {

constexpr std::size_t kMaximumCommands = 4096; // per step
constexpr std::size_t kMaximumSpent = 64;

/// A step that is being made. A second one at the same time, of another thread or from within, is refused before it
/// touches anything.
class SoleStep {
public:
    explicit SoleStep(std::atomic_flag& under) : underWay_(under)
    {
        if (underWay_.test_and_set(std::memory_order_acquire))
            fail("physics: a step is being made already: only one thread at a time may step a server");
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
    MpscQueue<Command> inbox;
    std::vector<Command> commands; ///< of the step being made
    frame::FramePool frames;
    SpscRing<StepRecord> log;
    /// What materials have replaced, on its way back: a step may not be long enough to take it apart. Read under the
    /// lock.
    SpscRing<std::unique_ptr<BuiltBody>> spent{kMaximumSpent};
    bool hashing = false;
    bool recordLost = false; ///< since the last record that was written
    bool paused = false;
    std::atomic<bool> logging = false;
    std::atomic_flag stepping = {}; ///< see SoleStep

    /// Callers only: the step never takes it. Held from the look at a body to the push of its command, so that no
    /// command for a body comes behind the one that removes it.
    mutable std::mutex registryMutex;
    Registry registry;

    Impl(std::unique_ptr<PhysicsEngine> made, int logLength)
        : engine(std::move(made)), log(static_cast<std::size_t>(logLength))
    {
    }

    BodyId add(BodyDef def)
    {
        check(def);
        auto shared = std::make_shared<const BodyDef>(std::move(def));
        auto body = engine->build(*shared);
        const std::lock_guard lock(registryMutex);
        const BodyId id{registry.lastAdded().value + 1};
        const AttachmentId first = attachmentCount(*shared) > 0 ? registry.nextAttachment() : AttachmentId{};
        push(AddBody{id, shared, std::move(body), first}); // under the lock: bodies arrive in the order of their ids
        return id;
    }

    /// A command that makes an attachment, but for its id.
    template <class Attaching> AttachmentId attach(Attaching command)
    {
        const std::lock_guard lock(registryMutex);
        const AttachmentId id = command.id = registry.nextAttachment();
        push(std::move(command));
        return id;
    }

    /// What takes long about a new material is done here, as in add(): the step only moves it in.
    void setMaterial(BodyId id, const SoftMaterial& material)
    {
        BodyDef def;
        std::vector<std::unique_ptr<BuiltBody>> ends; // here, and not under the lock
        {
            const std::lock_guard lock(registryMutex);
            registry.check(SetMaterial{id, material});
            def = *registry.find(id).def;
            for (; auto* body = spent.beginRead(); spent.release()) ends.push_back(std::move(*body));
        }
        std::get<SoftBodyDef>(def).material = material;
        post(SetMaterial{id, material, engine->build(def)}); // checked again: the body may have gone meanwhile
    }

    void post(Command command)
    {
        const std::lock_guard lock(registryMutex);
        push(std::move(command));
    }

    /// Throws an Error where the command is wrong. Under the lock.
    void push(Command command)
    {
        registry.check(command);
        registry.note(command);
        inbox.push(std::move(command));
    }

    void drainInbox()
    {
        commands.clear();
        while (commands.size() < kMaximumCommands) { // what comes faster waits: a step must end
            auto command = inbox.pop();
            if (!command) break;
            if (const auto* pause = std::get_if<Pause>(&*command)) paused = pause->paused;
            commands.push_back(std::move(*command));
        }
    }

    void giveBackSpent()
    {
        for (Command& command : commands)
            if (auto* set = std::get_if<SetMaterial>(&command); set && set->body) {
                std::unique_ptr<BuiltBody> body = std::move(set->body); // dies here where the ring is full
                if (auto* place = spent.beginWrite()) {
                    *place = std::move(body);
                    spent.publish();
                }
            }
    }

    void writeLog(StepReport& report)
    {
        if (!logging.load(std::memory_order_relaxed)) {
            recordLost = true; // a log that begins later does not begin at the beginning
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

    void publishFrame()
    {
        frame::Frame* frame = frames.beginWrite();
        if (!frame) return; // readers hold them all: they will see the next one
        engine->capture(*frame);
        frames.publish();
    }
};

PhysicsServer::PhysicsServer(std::unique_ptr<PhysicsEngine> engine, const PhysicsServerDef& def)
{
    FILASOFIA_ASSERT(engine != nullptr);
    validate(def, "physics server");
    impl_ = std::make_unique<Impl>(std::move(engine), def.logLength);
    impl_->inbox.push(SetGravity{def.gravity});
}

PhysicsServer::~PhysicsServer() = default;

BodyId PhysicsServer::add(SoftBodyDef def)
{
    def = loaded(std::move(def)); // read once: the engine and whoever shows the body use the same
    def.pose = unitPose(def.pose, text("soft body '", def.name, "': pose"));
    return impl_->add(std::move(def));
}
BodyId PhysicsServer::add(RigidBodyDef def)
{
    def = loaded(std::move(def));
    for (std::size_t e = 0; e < def.elements.size(); ++e)
        def.elements[e] = unitPose(def.elements[e], text("rigid body '", def.name, "': elements[", e, "]"));
    if (!def.articulation.joints.empty()) { // whoever shows the body finds its links where they are
        check(BodyDef{def});
        def.elements = elementPoses(def);
    }
    return impl_->add(std::move(def));
}

void PhysicsServer::remove(BodyId id) { impl_->post(RemoveBody{id}); }
void PhysicsServer::setPose(BodyId id, const Pose& pose, int element) { impl_->post(SetPose{id, element, pose}); }
void PhysicsServer::setGravity(Vec3 gravity) { impl_->post(SetGravity{gravity}); }
void PhysicsServer::setMaterial(BodyId id, const SoftMaterial& material) { impl_->setMaterial(id, material); }
void PhysicsServer::setForces(BodyId id, std::vector<NodalForce> forces)
{
    impl_->post(SetForces{id, std::move(forces)});
}
void PhysicsServer::setPressure(BodyId id, double pressure) { impl_->post(SetPressure{id, pressure}); }
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
    return impl_->attach(Attach{{}, soft, std::move(def)});
}
AttachmentId PhysicsServer::attach(BodyId rigid, RigidAttachmentDef def)
{
    return impl_->attach(AttachRigid{{}, rigid, std::move(def)});
}
AttachmentId PhysicsServer::grasp(BodyId rigid, BodyId target, const GraspDef& def)
{
    return impl_->attach(Grasp{{}, rigid, target, def});
}
void PhysicsServer::removePiece(BodyId soft, int piece) { impl_->post(RemovePiece{soft, piece}); }
void PhysicsServer::release(AttachmentId id) { impl_->post(Release{id}); }
void PhysicsServer::pause(bool paused) { impl_->post(Pause{paused}); }
void PhysicsServer::reset() { impl_->post(Reset{}); }
void PhysicsServer::tune(std::function<void(PhysicsEngine&)> change) { impl_->post(Tune{std::move(change)}); }

std::shared_ptr<const BodyDef> PhysicsServer::def(BodyId id) const
{
    const std::lock_guard lock(impl_->registryMutex);
    return impl_->registry.find(id).def;
}

std::vector<AttachmentId> PhysicsServer::attachments(BodyId id) const
{
    const std::lock_guard lock(impl_->registryMutex);
    const Registry::Body& body = impl_->registry.find(id);
    std::vector<AttachmentId> ids;
    for (std::uint32_t k = 0; k < attachmentCount(*body.def); ++k) ids.push_back({body.firstAttachment.value + k});
    return ids;
}

StepReport PhysicsServer::step(double dt, std::uint32_t flags, const StepBudget& budget)
{
    if (!(std::isfinite(dt) && dt > 0.0)) fail("physics: step: dt must be > 0 s and finite, got ", dt);
    const SoleStep sole(impl_->stepping);
    impl_->drainInbox();
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
    for (const Command& command : commands) {
        impl_->registry.check(command);
        impl_->registry.note(command);
    }
    impl_->commands = std::move(commands);
}

StepReport PhysicsServer::stepAgain(double dt, const StepBudget& budget)
{
    if (!(std::isfinite(dt) && dt >= 0.0)) fail("physics: stepAgain: dt must be >= 0 s and finite, got ", dt);
    const SoleStep sole(impl_->stepping);
    const StepReport report = impl_->engine->step({.dt = dt, .commands = impl_->commands, .budget = &budget});
    impl_->giveBackSpent();
    impl_->commands.clear();
    impl_->publishFrame();
    return report;
}

std::vector<BodyId> PhysicsServer::bodies() const
{
    const std::lock_guard lock(impl_->registryMutex);
    return impl_->registry.bodies();
}

bool PhysicsServer::has(BodyId id) const
{
    const std::lock_guard lock(impl_->registryMutex);
    return impl_->registry.has(id);
}

const PhysicsEngine& PhysicsServer::engine() const { return *impl_->engine; }
std::uint64_t PhysicsServer::hash() const { return impl_->engine->hash(); }
void PhysicsServer::hashEveryStep(bool on) { impl_->hashing = on; }
bool PhysicsServer::paused() const { return impl_->paused; }
frame::FrameRef PhysicsServer::latest() { return impl_->frames.latest(); }
StepRecord* PhysicsServer::nextRecord() { return impl_->log.beginRead(); }
void PhysicsServer::popRecord() { impl_->log.release(); }
void PhysicsServer::keepLog(bool on) { impl_->logging.store(on, std::memory_order_relaxed); }

} // namespace filasofia::physics

#pragma once

#include "filasofia/physics/step_record.h"

#include "filasofia/frame/frame_pool.h"

#include <functional>

namespace filasofia::physics {

struct PhysicsServerDef {
    Vec3 gravity = {0.0, -9.81, 0.0}; ///< [m/s^2]
    int logLength = 4096;             ///< [-], in [1, 1000000], steps that the log holds unread
};
constexpr auto fields(const PhysicsServerDef*)
{
    using T = PhysicsServerDef;
    return describe("PhysicsServerDef", field("gravity", &T::gravity, "m/s^2", finite(), "acts on every body"),
                    field("logLength", &T::logLength, "-", closed(1, 1000000), "steps that the log holds unread"));
}

/// Owns an engine and everything that goes in and out of it. The functions that change something may be called from
/// any thread: they check at once (Error) and take effect at the start of the next step. It has no thread or clock.
class PhysicsServer {
public:
    PhysicsServer(std::unique_ptr<PhysicsEngine> engine, const PhysicsServerDef& def = {});
    ~PhysicsServer();

    BodyId add(SoftBodyDef def);
    BodyId add(RigidBodyDef def);
    void remove(BodyId id);
    /// Of a body that is not dynamic: where it is to be at the end of the next step. It goes there with constant
    /// velocity, but for a jump that would be faster than 20 m/s. Of a dynamic body: where it is from now on, at rest.
    /// Of an articulated body: of its base, element 0.
    void setPose(BodyId rigid, const Pose& pose, int element = 0);
    /// Pushes a dynamic body at the centre of mass of one element, until changed: [N], [N m], in world axes.
    void setWrench(BodyId rigid, Vec3 force, Vec3 torque, int element = 0);
    /// A joint goes to a position (JointPosition, within its limits), or is pushed (JointForce), until changed.
    void setJoint(BodyId articulated, int joint, const JointCommand& command);
    /// Gives a rigid element into a hand: see HapticTarget and SetHaptic. Runtime does it for every haptic interface.
    void setHaptic(BodyId rigid, const HapticTarget& target, int element = 0);
    void setGravity(Vec3 gravity); ///< [m/s^2]
    /// Holds nodes of a soft body, or an element of a rigid one, where they are when it takes effect. Where no node is
    /// in the regions then, nothing is held, and the step has StepFlag::NothingAttached.
    AttachmentId attach(BodyId soft, AttachmentDef def);
    AttachmentId attach(BodyId rigid, RigidAttachmentDef def);
    /// Ties to a rigid body what it touches of the target when it takes effect; where it touches nothing the step has
    /// StepFlag::NothingAttached. Reports name the target as the body that is held.
    AttachmentId grasp(BodyId rigid, BodyId target, const GraspDef& def = {});
    /// Lets go. Nothing happens where it has broken, was released, or its body is gone. Letting go nodes that a Def
    /// holds in space, hard or by springs, makes the body's solver anew within the step (9 ms at 3000 tetrahedra).
    void release(AttachmentId id);
    /// Takes a piece that cuts or tears have set loose (LoosePiece::piece) out of the scene: it has no surface any
    /// more, no blade finds it and it does not move; what held it lets go. Its nodes keep their numbers and places, and
    /// mean nothing. Collision meshes and drawn surfaces given beside the body keep what rides on it.
    void removePiece(BodyId soft, int piece);
    /// Those that a body's Def made, in its order.
    [[nodiscard]] std::vector<AttachmentId> attachments(BodyId id) const;
    /// Of the kind that the body was made with. Like add() it builds, and the step only moves in what was built: 9 ms
    /// at 3000 tetrahedra, 0.1 s at 30000. After a tune() the step builds.
    void setMaterial(BodyId soft, const SoftMaterial& material);
    void setForces(BodyId soft, std::vector<NodalForce> forces);
    void setPressure(BodyId soft, double pressure); ///< [Pa]
    void pause(bool paused);
    void reset();
    /// Runs `change` once between two steps with the engine in hand; marks the recording as not replayable.
    void tune(std::function<void(PhysicsEngine&)> change);

    /// What a body was made from; Error where the id names none.
    [[nodiscard]] std::shared_ptr<const BodyDef> def(BodyId id) const;

    /// Those that were added and not removed, ascending. Any thread.
    [[nodiscard]] std::vector<BodyId> bodies() const;
    /// Was it added and not removed. Any thread.
    [[nodiscard]] bool has(BodyId id) const;
    /// For asking which engine it is, and for its build(). Any thread.
    [[nodiscard]] const PhysicsEngine& engine() const;

    /// While it lives, its thread is the one that steps: from it, every function of this class but add() returns
    /// without waiting for any other thread (add() may wait for others that add). One at a time; runtime makes one for
    /// each run. Without one, a thread that steps is as any other.
    class Stepping {
    public:
        explicit Stepping(PhysicsServer& server);
        ~Stepping();
        Stepping(const Stepping&) = delete;
        Stepping& operator=(const Stepping&) = delete;

    private:
        const void* before_; ///< what the thread stepped until now
    };

    /// Is the calling thread the one that steps.
    [[nodiscard]] bool stepsHere() const;

    // The stepping thread only: a step, while another thread makes one, throws an Error.
    /// One step of dt [s], > 0. `flags`: StepFlag bits that the caller knows already, for report and log.
    StepReport step(double dt, std::uint32_t flags = 0, const StepBudget& budget = {});
    /// The commands of the next step as a recording has them, with their ids and built bodies, checked as if they were
    /// asked for now (Error). From now on the server knows their bodies.
    void expect(std::vector<Command> commands);
    /// In place of step(): with the commands that were expected and no others. dt >= 0 [s]: with 0 nothing moves.
    StepReport stepAgain(double dt, const StepBudget& budget = {});
    [[nodiscard]] std::uint64_t hash() const;
    /// Computes the state's hash after every step, for the log.
    void hashEveryStep(bool on);
    [[nodiscard]] bool paused() const;

    /// The newest state. Any thread. Let go of it soon: while readers hold all of the pool's eight frames, no newer one
    /// is made.
    [[nodiscard]] frame::FrameRef latest();
    /// The oldest step that was not read yet, or nullptr; popRecord() gives its place back. One reader.
    [[nodiscard]] StepRecord* nextRecord();
    void popRecord();
    /// Steps are logged from now on; without a reader nobody pays for it.
    void keepLog(bool on);

private:
    friend class RegistryHold; // tests
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::physics

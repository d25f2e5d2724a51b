#pragma once

#include "filasofia/physics/mechanical_energy.h"
#include "filasofia/physics/step_record.h"

#include "filasofia/frame/frame_pool.h"

#include <functional>

namespace filasofia::physics {

struct PhysicsServerDef {
    Vec3 gravity = {0.0, -9.81, 0.0}; ///< [m/s^2]
    int logLength = 4096;             ///< [-], in [1, 1000000], unread steps that the log can hold
};
constexpr auto fields(const PhysicsServerDef*)
{
    using T = PhysicsServerDef;
    return describe("PhysicsServerDef", field("gravity", &T::gravity, "m/s^2", finite(), "gravity on every body"),
                    field("logLength", &T::logLength, "-", closed(1, 1000000), "unread steps that the log can hold"));
}

/// What a server returns to with restore(). It lives in memory and never changes; any thread may use it.
class SavedState {
public:
    struct Content;
    explicit SavedState(std::unique_ptr<const Content> content);
    ~SavedState();
    SavedState(const SavedState&) = delete;
    SavedState& operator=(const SavedState&) = delete;

    [[nodiscard]] const Content& content() const { return *content_; }

private:
    std::unique_ptr<const Content> content_;
};

/// Owns an engine and all of its input and output. The functions that change something may be called from any thread:
/// they check their arguments at once (Error) and take effect at the start of the next step. The server has no thread
/// and no clock.
class PhysicsServer {
public:
    PhysicsServer(std::unique_ptr<PhysicsEngine> engine, const PhysicsServerDef& def = {});
    ~PhysicsServer();

    BodyId add(SoftBodyDef def);
    BodyId add(RigidBodyDef def);
    BodyId add(RodBodyDef def);
    void remove(BodyId id);
    /// For a kinematic body: its pose at the end of the next step. It moves there with constant velocity, except that
    /// it jumps if that would be faster than 20 m/s. For a dynamic body: its pose from now on, at rest. For an
    /// articulated body: the pose of its base, element 0.
    void setPose(BodyId rigid, const Pose& pose, int element = 0);
    /// Applies a force and torque to a dynamic body at the centre of mass of one element, until changed: [N], [N m], in
    /// world axes.
    void setWrench(BodyId rigid, Vec3 force, Vec3 torque, int element = 0);
    /// Sets a joint's target position (JointPosition, within its limits), its force (JointForce) or a spring
    /// (JointSpring), until changed.
    void setJoint(BodyId articulated, int joint, const JointCommand& command);
    /// Couples a rigid element to a hand: see HapticTarget and SetHaptic. The runtime does it for every haptic
    /// interface.
    void setHaptic(BodyId rigid, const HapticTarget& target, int element = 0);
    void setGravity(Vec3 gravity); ///< [m/s^2]
    /// Attaches nodes of a soft body, or an element of a rigid one, at the positions they have when it takes effect. If
    /// no node is in the regions then, nothing is attached, and the step has StepFlag::NothingAttached.
    AttachmentId attach(BodyId soft, AttachmentDef def);
    AttachmentId attach(BodyId rigid, RigidAttachmentDef def);
    /// Attaches to a rigid body what it touches of the target when it takes effect; if it touches nothing, the step has
    /// StepFlag::NothingAttached. Reports name the target as the attached body.
    AttachmentId grasp(BodyId rigid, BodyId target, const GraspDef& def = {});
    /// Closes a clip, a dynamic rigid body, on the tissue between its legs, from the next step on: see ClipDef. The
    /// attachment holds it there: it breaks if the clip is pulled off, and release() opens the clip. If no tissue is
    /// between its legs, the step has StepFlag::NothingAttached. A reset opens all clips.
    AttachmentId clip(BodyId rigid, BodyId soft, const ClipDef& def = {});
    /// Releases an attachment. Does nothing if it has broken, was released, or its body is gone. Releasing nodes that a
    /// Def attaches to space, rigidly or by springs, rebuilds the body's solver within the step (9 ms at 3000
    /// tetrahedra).
    void release(AttachmentId id);
    /// Removes a piece that cuts or tears have detached (LoosePiece::piece): it no longer has a surface, no blade finds
    /// it and it does not move; attachments release it. Its nodes keep their numbers and positions, which have no
    /// meaning any more. Collision meshes and drawn surfaces given in addition to the body keep what is embedded in it.
    void removePiece(BodyId soft, int piece);
    /// The attachments of a body's Def, in its order.
    [[nodiscard]] std::vector<AttachmentId> attachments(BodyId id) const;
    /// Sets a material of the kind that the body was made with. Like add() it builds on the calling thread, and the
    /// step only moves in the result: 9 ms at 3000 tetrahedra, 0.1 s at 30000. After a tune() the step builds it.
    void setMaterial(BodyId soft, const SoftMaterial& material);
    /// Changes the tissue of a part of a FEM body from the next step on: see SetTissue. The step takes about 1 us per
    /// element that changes.
    void setTissue(BodyId soft, const TissueRegion& region, const std::optional<TissueFactors>& factors = {});
    /// [Pa], in [0, 1e9]: the stress by which a family of fibres contracts from the next step on: see SetFibreStress.
    void setFibreStress(BodyId soft, int family, double stress);
    /// Bends parts of a rod by itself from the next step on: see SetCurvature. `rate` [1/(m s)], > 0: by which its
    /// curvature goes there; infinite: at once.
    void setCurvature(BodyId rod, std::vector<RodSection> sections,
                      double rate = std::numeric_limits<double>::infinity());
    void setCutting(BodyId rigid, bool cutting); ///< from the next step on: see SetCutting
    void setForces(BodyId soft, std::vector<NodalForce> forces);
    void setPressure(BodyId soft, double pressure); ///< [Pa]
    void setCavity(const SetCavity& command);       ///< what a cavity of a soft body holds
    void pause(bool paused);
    void reset();
    /// Runs `change` once between two steps with access to the engine; marks the recording as not replayable.
    void tune(std::function<void(PhysicsEngine&)> change);

    /// The Def that a body was made from; throws an Error if there is no such body.
    [[nodiscard]] std::shared_ptr<const BodyDef> def(BodyId id) const;

    /// The bodies that were added and not removed, in ascending order. Any thread.
    [[nodiscard]] std::vector<BodyId> bodies() const;
    /// Whether the body was added and not removed. Any thread.
    [[nodiscard]] bool has(BodyId id) const;
    /// The name of a body, also of one that was removed; "body 7" if there never was one. Any thread.
    [[nodiscard]] std::string nameOf(BodyId id) const;
    /// For its type, its info() and its build(). Any thread.
    [[nodiscard]] const PhysicsEngine& engine() const;
    /// Replaces the engine before the first step, for a program whose user chooses it: bodies that were added are built
    /// again. Throws an Error after a step, or if the new engine refuses a body or a command; nothing has changed then.
    /// No other thread may use the server meanwhile.
    void useEngine(std::unique_ptr<PhysicsEngine> engine);

    /// While it exists, its thread is the stepping thread: there, every function of this class except add() returns
    /// without waiting for any other thread (add() may wait for other threads that add). At most one exists at a time;
    /// runtime makes one for each run. Without it, a thread that steps is treated like any other.
    class Stepping {
    public:
        explicit Stepping(PhysicsServer& server);
        ~Stepping();
        Stepping(const Stepping&) = delete;
        Stepping& operator=(const Stepping&) = delete;

    private:
        const void* before_; ///< the server that the thread stepped before
    };

    /// Whether the calling thread is the stepping thread.
    [[nodiscard]] bool stepsHere() const;

    // Only for the stepping thread; they throw an Error while another step is being computed.
    /// The state between two steps, with the commands that wait for the next one. Error while a body waits to be added
    /// or removed, or a material or a tune() to be applied: make a step first.
    [[nodiscard]] std::shared_ptr<const SavedState> save();
    /// Returns to a state, at once. Commands that wait are dropped, and ids of attachments that were made since mean
    /// nothing any more, or other attachments. Error if bodies were added or removed since, or differ from those that
    /// the state was saved with; it may be a state of another server with the same bodies. Error, too, if readers hold
    /// all frames.
    void restore(const SavedState& state);
    /// Computes one step of dt [s], > 0. `flags`: StepFlag bits that the caller sets, for report and log.
    StepReport step(double dt, std::uint32_t flags = 0, const StepBudget& budget = {});
    /// Sets the commands of the next step as a recording has them, with their ids and built bodies, checked as if they
    /// were posted now (Error). From now on the server knows their bodies.
    void expect(std::vector<Command> commands);
    /// Replaces step() in a replay: uses exactly the commands set by expect(). dt >= 0 [s]; with 0 nothing moves.
    StepReport replayStep(double dt, const StepBudget& budget = {});
    [[nodiscard]] std::uint64_t hash() const;
    /// The mechanical energy of a body after the last step, computed when it is asked for: about 1 us per element of a
    /// soft body. Error if there is no such body, if it is there only from the next step on, or if the engine cannot
    /// tell.
    [[nodiscard]] MechanicalEnergy mechanicalEnergy(BodyId id) const;
    /// Computes the state's hash after every step, for the log.
    void hashEveryStep(bool on);
    [[nodiscard]] bool paused() const;

    /// The newest state. Any thread. Release it soon: while readers hold all of the pool's eight frames, no newer one
    /// is captured.
    [[nodiscard]] frame::FrameRef latest();
    /// The oldest unread step, or nullptr; popRecord() frees its slot. One reader.
    [[nodiscard]] StepRecord* nextRecord();
    void popRecord();
    /// Turns logging of steps on or off; off, it costs nothing.
    void keepLog(bool on);

private:
    friend class CommandTrial;
    friend class RegistryHold; // tests
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::physics

#include "filasofia/physics/give.h"

namespace filasofia::physics {
namespace {

/// Every command by the function of its name.
class Giver {
public:
    explicit Giver(PhysicsServer& server) : server_(server) {}

    AttachmentId operator()(const Attach& c) { return server_.attach(c.body, c.def); }
    AttachmentId operator()(const AttachRigid& c) { return server_.attach(c.body, c.def); }
    AttachmentId operator()(const Grasp& c) { return server_.grasp(c.rigid, c.target, c.def); }
    AttachmentId operator()(const ApplyClip& c) { return server_.clip(c.rigid, c.target, c.def); }
    template <class C> AttachmentId operator()(const C& command)
    {
        set(command);
        return {};
    }

private:
    void set(const RemoveBody& c) { server_.remove(c.id); }
    void set(const SetPose& c) { server_.setPose(c.id, c.pose, c.element); }
    void set(const SetWrench& c) { server_.setWrench(c.id, c.force, c.torque, c.element); }
    void set(const SetJoint& c) { server_.setJoint(c.id, c.joint, c.command); }
    void set(const SetHaptic& c) { server_.setHaptic(c.id, c.target, c.element); }
    void set(const SetGravity& c) { server_.setGravity(c.gravity); }
    void set(const SetTissue& c) { server_.setTissue(c.id, c.region, c.factors); }
    void set(const SetFibreStress& c) { server_.setFibreStress(c.id, c.family, c.stress); }
    void set(const SetCurvature& c) { server_.setCurvature(c.id, c.sections, c.rate); }
    void set(const SetCutting& c) { server_.setCutting(c.id, c.cutting); }
    void set(const SetCavity& c) { server_.setCavity(c); }
    void set(const SetForces& c) { server_.setForces(c.id, c.forces); }
    void set(const SetPressure& c) { server_.setPressure(c.id, c.pressure); }
    void set(const Release& c) { server_.release(c.id); }
    void set(const RemovePiece& c) { server_.removePiece(c.id, c.piece); }
    void set(const Pause& c) { server_.pause(c.paused); }

    PhysicsServer& server_;
};

} // namespace

AttachmentId give(PhysicsServer& server, const GivenCommand& command) { return std::visit(Giver(server), command); }

} // namespace filasofia::physics

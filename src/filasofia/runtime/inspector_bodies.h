#pragma once

#include "filasofia/runtime/simulation_impl.h"

#include <map>
#include <memory>

namespace filasofia::runtime {

/// The bodies, their Defs' fields, and those fields that a command can change.
class InspectorBodies {
public:
    explicit InspectorBodies(Simulation::Impl& impl);

    void draw();
    /// Why physics refused the most recent refused change, in the words of its Error.
    [[nodiscard]] const std::string& problem() const { return problem_; }

private:
    /// What the user last asked for here; physics does not report it.
    struct Body {
        std::shared_ptr<const physics::BodyDef> def = {};
        physics::SoftMaterial material = {};
        double pressure = 0.0;
        Vec3 force = {};
    };

    /// Runs a command on a body that may just have been removed.
    template <class Command> void attempt(Command&& command);
    Body* bodyOf(BodyId id);
    void drawSoft(const frame::SoftBodyFrame& state, Body& body);
    void drawRigid(const frame::RigidBodyFrame& state, Body& body);
    void drawPlaces(const frame::RigidBodyFrame& state, bool dynamic);
    void drawAttachments(const frame::Frame& frame) const;

    Simulation::Impl& impl_;
    Vec3 gravity_;
    std::map<BodyId, Body> bodies_;
    std::string problem_;
};

} // namespace filasofia::runtime

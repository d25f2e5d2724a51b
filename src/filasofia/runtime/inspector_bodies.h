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
    /// Why physics refused the last change that it refused, as its Error says.
    [[nodiscard]] const std::string& problem() const { return problem_; }

private:
    /// What was last asked for here; physics does not tell.
    struct Body {
        std::shared_ptr<const physics::BodyDef> def = {};
        physics::SoftMaterial material = {};
        double pressure = 0.0;
        Vec3 force = {};
    };

    /// A change by a command, of a body that may just have gone.
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

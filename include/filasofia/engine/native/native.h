#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/pose.h"
#include "filasofia/math/vec3.h"
#include "filasofia/physics/defs.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace filasofia::physics {
class PhysicsServer;
}

/// The door to the native engine's own data, for fine-tuning. No promise of stability: this header follows the engine
/// wherever it goes.
namespace filasofia::engine {

struct Scene;

/// A tetrahedron of a FEM body and its material.
struct NativeElement {
    std::array<int, 4> nodes{};
    double youngModulus = 0.0; ///< [Pa]
    double poissonRatio = 0.0; ///< [-], in [0, 0.5)
};

/// A spring of a mass-spring body.
struct NativeSpring {
    std::array<int, 2> nodes{};
    double restLength = 0.0; ///< [m]
    double stiffness = 0.0;  ///< [N/m]
    double damping = 0.0;    ///< [N s/m], along the spring
};

/// A soft body's data, per node unless said. Valid for the length of one tune() call.
struct NativeSoftBody {
    BodyId id;
    std::span<const Vec3> rest;      ///< [m] in the world
    std::span<Vec3> positions;       ///< [m]
    std::span<Vec3> velocities;      ///< [m/s]
    std::span<Vec3> velocityChanges; ///< [m/s] of the last step: where the next solve starts
    std::span<Vec3> residuals;       ///< [N s] what the last solve left undone, due in the next step
    std::span<double> masses;        ///< [kg]
    physics::Integrator& integrator;
    physics::Solver& solver;
    physics::Rayleigh& rayleigh;
};

/// A rigid body's data, per element. Valid for the length of one tune() call.
struct NativeRigidBody {
    BodyId id;
    std::span<Pose> poses;
    std::span<Vec3> velocities;                ///< [m/s] of the centres of mass
    std::span<Vec3> angularVelocities;         ///< [rad/s] in world axes
    std::span<physics::RigidInertia> inertias; ///< zeros unless dynamic
};

/// The engine's data, valid for the length of one tune() call.
class Native {
public:
    explicit Native(Scene& scene) : scene_(scene) {}

    [[nodiscard]] Vec3& gravity(); ///< [m/s^2]
    [[nodiscard]] std::vector<BodyId> softBodies() const;
    [[nodiscard]] std::vector<BodyId> rigidBodies() const;
    /// Error if there is no such soft body.
    [[nodiscard]] NativeSoftBody softBody(BodyId id);
    /// Error if there is no such rigid body.
    [[nodiscard]] NativeRigidBody rigidBody(BodyId id);

    [[nodiscard]] int elementCount(BodyId softBody) const; ///< 0 for a mass-spring body
    [[nodiscard]] NativeElement element(BodyId softBody, int element) const;
    /// Sets the element's material; its nodes stay. Error if `element` is out of range.
    void setElement(BodyId softBody, int element, double youngModulus, double poissonRatio);
    [[nodiscard]] int springCount(BodyId softBody) const; ///< 0 for a FEM body
    [[nodiscard]] NativeSpring spring(BodyId softBody, int spring) const;
    /// Sets rest length, stiffness and damping; the spring's nodes stay. Error if `spring` is out of range.
    void setSpring(BodyId softBody, int spring, const NativeSpring& value);

    /// All of it, for the engine's own tests: the type is complete in private headers only.
    [[nodiscard]] Scene& scene() { return scene_; }

private:
    Scene& scene_;
};

/// Runs `change` once, at the start of the next step, with mutable access to the engine's data. Afterwards everything
/// is checked as if it had just been built: if `change` throws or leaves something invalid, everything is restored, the
/// log says why, and the step's report has StepFlag::TuneRejected. The recording is marked as not replayable from
/// there. Error if the server's engine is another one.
void tune(physics::PhysicsServer& server, std::function<void(Native&)> change);

} // namespace filasofia::engine

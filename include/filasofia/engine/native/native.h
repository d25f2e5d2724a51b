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

/// Access to the native engine's internal data, for fine-tuning. This header is not stable: it changes with the engine.
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

/// A soft body's data, per node unless stated otherwise. Valid during one tune() call.
struct NativeSoftBody {
    BodyId id;
    std::span<const Vec3> rest;      ///< [m] in world coordinates
    std::span<Vec3> positions;       ///< [m]
    std::span<Vec3> velocities;      ///< [m/s]
    std::span<Vec3> velocityChanges; ///< [m/s] the last step's change: first guess of the next solve
    std::span<Vec3> residuals;       ///< [N s] residual impulses of the last solve that the next step takes over
    std::span<double> masses;        ///< [kg]
    physics::Integrator& integrator;
    physics::Solver& solver;
    physics::Rayleigh& rayleigh;
};

/// A rigid body's data, per element. Valid during one tune() call.
struct NativeRigidBody {
    BodyId id;
    std::span<Pose> poses;
    std::span<Vec3> velocities; ///< [m/s] velocities of the centres of mass, or of the origins if the elements are
                                ///< links or kinematic
    std::span<Vec3> angularVelocities;         ///< [rad/s] in world axes
    std::span<physics::RigidInertia> inertias; ///< zero unless the body is dynamic or the element is a link with mass
};

/// The engine's data. Valid during one tune() call.
class Native {
public:
    explicit Native(Scene& scene) : scene_(scene) {}

    [[nodiscard]] Vec3& gravity(); ///< [m/s^2]
    [[nodiscard]] std::vector<BodyId> softBodies() const;
    [[nodiscard]] std::vector<BodyId> rigidBodies() const;
    /// Throws an Error if there is no such soft body.
    [[nodiscard]] NativeSoftBody softBody(BodyId id);
    /// Throws an Error if there is no such rigid body.
    [[nodiscard]] NativeRigidBody rigidBody(BodyId id);

    [[nodiscard]] int elementCount(BodyId softBody) const; ///< 0 for a mass-spring body
    /// Throws an Error if `element` is out of range.
    [[nodiscard]] NativeElement element(BodyId softBody, int element) const;
    /// Sets the element's material; its nodes do not change. Throws an Error if `element` is out of range.
    void setElement(BodyId softBody, int element, double youngModulus, double poissonRatio);
    [[nodiscard]] int springCount(BodyId softBody) const; ///< 0 for a FEM body
    /// Throws an Error if `spring` is out of range.
    [[nodiscard]] NativeSpring spring(BodyId softBody, int spring) const;
    /// Sets rest length, stiffness and damping; the spring's nodes do not change. Throws an Error if `spring` is out of
    /// range.
    void setSpring(BodyId softBody, int spring, const NativeSpring& value);

    /// The whole scene, for the engine's own tests: the type is complete in private headers only.
    [[nodiscard]] Scene& scene() { return scene_; }

private:
    Scene& scene_;
};

/// Runs `change` once, at the start of the next step, with mutable access to the engine's data. Afterwards all data are
/// checked as if they had just been built: if `change` throws or leaves something invalid, everything is restored, an
/// error is logged, and the step's report has StepFlag::TuneRejected. The recording is marked as not replayable from
/// there on. Throws an Error if the server has another engine or if `change` is empty.
void tune(physics::PhysicsServer& server, std::function<void(Native&)> change);

} // namespace filasofia::engine

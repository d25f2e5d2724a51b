#pragma once

#include "filasofia/testing/fuzz_contact_scene.h"

#include <memory>
#include <string>

namespace filasofia::testing {

inline constexpr double kApart = 3e-3; ///< [m] between bodies at the start

/// Adds bodies to a scene, which share a kind of tissue and a friction. Body 0 is the floor.
class ContactSceneMaker {
public:
    ContactSceneMaker(FuzzRandom& random, ContactScene& scene);

    [[nodiscard]] double size() const { return size_; }       ///< [m] a body's, about
    [[nodiscard]] double modulus() const { return modulus_; } ///< [Pa]

    /// A soft body whose lowest point is at height `above`; returns its own height.
    double tissue(Vec3 at, double above);
    /// A dynamic box; the same.
    double box(Vec3 at, double above);
    /// A sheet of tetrahedra, or a shell, at this height; returns its width.
    double sheet(double height);
    /// A body that goes where it is told, at first at `from`.
    ToldBody& told(const std::shared_ptr<const geometry::TriangleMesh>& mesh, Pose from);
    std::shared_ptr<const geometry::TriangleMesh> tool();
    /// A hand, which touches nothing, at first at `from`; its id is that of the last body then.
    ToldBody& hand(Vec3 from);

    void add(const physics::BodyDef& def) { scene_.bodies.emplace_back(def); }
    /// A soft body at this place that touches others, without a mesh; a rigid one of this mesh.
    physics::SoftBodyDef soft(Vec3 at);
    physics::RigidBodyDef rigid(const std::shared_ptr<const geometry::TriangleMesh>& mesh, const Pose& at) const;
    /// A thread along these points, of one radius in each scene.
    physics::RodBodyDef thread(std::vector<Vec3> points, bool closed = false);
    /// [N/m] A hand's grip of a thread: it gives way before the thread is stretched much, or the tissue under it.
    double grip(const physics::RodBodyDef& thread);

private:
    [[nodiscard]] std::string called() const { return "body " + std::to_string(scene_.bodies.size() + 1); }

    FuzzRandom& random_;
    ContactScene& scene_;
    double modulus_, friction_, size_;
    double radius_ = 0.0; ///< [m] threads'; 0: not drawn yet
};

/// Scenes of blades, threads and needles (fuzz_contact_tools.cpp).
void makeBlade(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene);
void makeFallingThreads(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene);
void makeDrawnThreads(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene);
void makeNeedle(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene);

} // namespace filasofia::testing

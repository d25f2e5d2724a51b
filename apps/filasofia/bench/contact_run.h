#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/physics_engine.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Bodies that touch, in an engine of their own, without a server, a picture or a clock around it.
namespace filasofia::app {

inline constexpr double kContactStep = 1e-3; ///< [s]

/// Where told bodies are to be at the end of the step that ends at that time.
using ToolPath = std::function<std::vector<std::pair<BodyId, Pose>>(double time)>;

struct ContactScene {
    std::string name = {}; ///< "scraped at 0.1 m/s"
    std::string body = {}; ///< "bunny 3004"
    std::vector<physics::BodyDef> bodies = {};
    ToolPath path = {};
    std::function<Vec3(double time)> gravity = {}; ///< [m/s^2]; none: 9.81 down
    double settle = 0.5;                           ///< [s] before anything is counted
    int asked = 0;                                 ///< [-] contacts that are to push; 0: as they come
    [[nodiscard]] int elements() const;            ///< tetrahedra
};

/// Makes steps of kContactStep from rest, under gravity.
class ContactRun {
public:
    /// `contacts`: else the same bodies go through each other.
    ContactRun(const ContactScene& scene, int threads, bool contacts = true);
    physics::StepReport step(const physics::StepBudget* budget = nullptr);
    const frame::Frame& capture(); ///< where everything is now
    [[nodiscard]] double time() const { return time_; }

private:
    std::unique_ptr<physics::PhysicsEngine> engine_;
    ToolPath path_;
    std::function<Vec3(double time)> gravity_;
    std::vector<physics::Command> commands_;
    frame::Frame frame_;
    double time_ = 0.0;
};

/// The Stanford bunny of so many tetrahedra, held at its feet or free on the floor; 10 kPa, friction 0.5.
physics::SoftBodyDef contactBunny(int tets, bool held);
/// A floor whose top is at height 0, friction 0.5.
physics::RigidBodyDef contactFloor();
/// A body that goes where it is told, friction 0.5.
physics::RigidBodyDef contactTool(const std::string& name, std::shared_ptr<const geometry::TriangleMesh> mesh, Pose at);

ContactScene bunnyOnFloor(int tets);
/// A bent plate of 1560 triangles on the back of the bunny, pressed 20 mm and scraped to and fro at up to `speed`
/// [m/s].
ContactScene bunnyScraped(int tets, double speed);
/// A plate pressed 2 mm into a slab of 30240 tetrahedra and scraped, of such a size that so many contacts push.
ContactScene plateOnSlab(int contacts);
ContactScene blockOnBlock();
ContactScene ballOnFloor(); ///< soft, dropped 20 mm
ContactScene towerOfFive();

} // namespace filasofia::app

#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/physics_engine.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Bodies in contact in an engine of their own, without a server, a picture or a clock around it.
namespace filasofia::app {

inline constexpr double kContactStep = 1e-3; ///< [s]

/// Target poses of the kinematic bodies at the end of the step that ends at `time`.
using ToolPath = std::function<std::vector<std::pair<BodyId, Pose>>(double time)>;

struct ContactScene {
    std::string name = {}; ///< "scraped at 0.1 m/s"
    std::string body = {}; ///< "bunny 3004"
    std::vector<physics::BodyDef> bodies = {};
    /// What a step is compared with; if empty, these bodies without contact. The path is for both.
    std::vector<physics::BodyDef> compared = {};
    ToolPath path = {};
    std::function<Vec3(double time)> gravity = {}; ///< [m/s^2]; 9.81 downwards if empty
    double settle = 0.5;                           ///< [s] before counting starts
    double step = kContactStep;                    ///< [s]
    int asked = 0; ///< [-] number of contacts that should push; 0 if the scene asks for none
    [[nodiscard]] std::string label() const { return body + ", " + name; }
    [[nodiscard]] int elements() const; ///< number of tetrahedra
};

/// Makes steps of a scene from rest, under gravity.
class ContactRun {
public:
    /// If `contacts` is false: what the scene is compared with. `engine`: by name; empty: the native one.
    ContactRun(const ContactScene& scene, int threads, bool contacts = true, const std::string& engine = {});
    physics::StepReport step(const physics::StepBudget* budget = nullptr);
    const frame::Frame& capture(); ///< the present state of all bodies
    [[nodiscard]] double time() const { return time_; }

private:
    std::unique_ptr<physics::PhysicsEngine> engine_;
    double dt_;
    ToolPath path_;
    std::function<Vec3(double time)> gravity_;
    std::vector<physics::Command> commands_;
    frame::Frame frame_;
    double time_ = 0.0;
};

/// [-] Iterations of the solver in a step: bodies in contact are solved together, and each reports the same number.
int iterationsOf(const physics::StepReport& report);

/// [N] The sum of all contacts' normal forces.
double pressedBy(const frame::Frame& frame);

/// The Stanford bunny of `tets` tetrahedra, pinned at its feet or free on the floor; 10 kPa, friction 0.5.
physics::SoftBodyDef contactBunny(int tets, bool pinned);
/// A floor whose top is at height 0, friction 0.5.
physics::RigidBodyDef contactFloor();
/// A kinematic rigid body, friction 0.5.
physics::RigidBodyDef contactTool(const std::string& name, std::shared_ptr<const geometry::TriangleMesh> mesh, Pose at);

ContactScene bunnyOnFloor(int tets);
/// A curved plate of 1560 triangles on the back of the bunny, pressed 20 mm and scraped to and fro at up to `speed`
/// [m/s].
ContactScene bunnyScraped(int tets, double speed);
/// A plate pressed 2 mm into a slab of 30240 tetrahedra and scraped. Its size is chosen so that `contacts` contacts
/// push.
ContactScene plateOnSlab(int contacts);
ContactScene blockOnBlock();
ContactScene ballOnFloor(); ///< a soft ball, dropped 20 mm
ContactScene towerOfFive();
/// Three blocks of 7200 tetrahedra in all, liver, layer and organ, tied to each other by springs [N/m] per node, or
/// hard; a hand draws at the organ. Compared with one block that has their tissues in three layers.
ContactScene tiedBlocks(double stiffness);
/// An organ of 25 kPa between jaws that hold it by springs [N/m] per node, all still. Compared with the organ alone.
ContactScene gripAtRest(double stiffness);
ContactScene boxesAtRest(); ///< 64 rigid boxes in four layers, each across the gaps of that below
ContactScene softHeap();    ///< 50 soft blocks of 480 tetrahedra, dropped into a box; steps of 5 ms

} // namespace filasofia::app

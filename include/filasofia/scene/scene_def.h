#pragma once

#include "filasofia/runtime/simulation.h"
#include "filasofia/scene/scene_parts.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// A whole scene as data: what a scene file says, and what a program may build instead.
namespace filasofia::scene {

/// The motion of an element of a kinematic body, or of the hand that holds a dynamic one: straight from key to key at
/// constant speed, turning the shortest way. Before the first key it stays at the first, after the last at the last.
struct ElementMotion {
    int element = 0;                ///< [-], >= 0, index in the body
    std::vector<KeyPose> keys = {}; ///< at least one; times ascend
    bool repeat = false;            ///< start again after the last key, whose time is then > 0
    /// The spring by which a hand moves a dynamic body along the keys: it yields to what is in the way, and never
    /// pushes with more than the forceLimit. Not given: the body is kinematic, and nothing stops it.
    std::optional<VirtualCoupling> hand = {};
};
constexpr auto fields(const ElementMotion*)
{
    using T = ElementMotion;
    return describe("ElementMotion", field("element", &T::element, "-", nonNegative(), "index in the body"),
                    field("keys", &T::keys, "poses and the times at which they are reached, ascending"),
                    field("repeat", &T::repeat, "start again after the last key"),
                    field("hand", &T::hand, "the spring by which a hand moves a dynamic body; none: it is kinematic"));
}

/// A command that a joint gets at a time.
struct KeyCommand {
    double time = 0.0;                  ///< [s], >= 0
    physics::JointCommand command = {}; ///< valid until the next one
};
constexpr auto fields(const KeyCommand*)
{
    return describe("KeyCommand", field("time", &KeyCommand::time, "s", nonNegative(), "when it is given"),
                    field("command", &KeyCommand::command, "position or force, until the next one"));
}

/// The commands that a joint of an articulated body gets, one after the other.
struct JointMotion {
    int joint = 0;                     ///< [-], >= 0, index in the body's articulation
    std::vector<KeyCommand> keys = {}; ///< at least one; times ascend
    bool repeat = false;               ///< start again at the last key, whose time is then > 0
};
constexpr auto fields(const JointMotion*)
{
    using T = JointMotion;
    return describe("JointMotion", field("joint", &T::joint, "-", nonNegative(), "index in the body's articulation"),
                    field("keys", &T::keys, "commands and the times at which they are given, ascending"),
                    field("repeat", &T::repeat, "start again at the last key"));
}

/// Where things stand, "scene.json:12:5", by their paths, "material.law"; for errors, and may be empty.
using Places = std::map<std::string, std::string>;

/// A body, how it is drawn, and how it moves. In Defs of a scene, BodyId{n} means the n-th body of the scene, from 1;
/// it must come before the body that names it. In a file, the fields of the body's Def stand beside the others.
struct SceneBody {
    physics::BodyDef def = physics::SoftBodyDef{};     ///< its name must be the only one in the scene
    std::vector<runtime::ShowDef> show = {};           ///< none: it is not drawn, but if no body has one, all are
    std::vector<runtime::PaintDef> paint = {};         ///< marks on what is drawn of it
    std::optional<surface::BleedingDef> bleeding = {}; ///< how a soft body bleeds where it is opened; none: it does not
    std::optional<surface::BurningDef> burning = {};   ///< how a soft body burns where it is heated; none: it does not
    std::vector<surface::ElectrodeDef> electrodes = {}; ///< parts of a rigid body that heat what they touch
    std::vector<surface::DuctDef> ducts = {};           ///< tubes in a soft body in which something flows
    std::vector<ElementMotion> motions = {};            ///< a kinematic rigid body's elements, until it is removed
    std::vector<JointMotion> jointMotions = {};         ///< an articulated body's joints, until it is removed
    Places places = {}; ///< where it stands, by the empty path, and its members by theirs
};
constexpr auto fields(const SceneBody*)
{
    using T = SceneBody;
    return describe("SceneBody", field("", &T::def, "the body's Def, whose fields stand beside the others"),
                    field("show", &T::show, "how it is drawn"), field("paint", &T::paint, "marks on it"),
                    field("bleeding", &T::bleeding, "how it bleeds where it is opened"),
                    field("burning", &T::burning, "how it burns where it is heated"),
                    field("electrodes", &T::electrodes, "parts that heat what they touch"),
                    field("ducts", &T::ducts, "tubes in which something flows"),
                    field("motions", &T::motions, "motions of a kinematic body's elements"),
                    field("jointMotions", &T::jointMotions, "commands of its joints"));
}

/// The place of a body that a camera or a light follows. In a file, the fields of FollowDef stand beside the body.
struct SceneFollow {
    runtime::FollowDef def = {};
    BodyId body = {}; ///< a body of the scene
};
constexpr auto fields(const SceneFollow*)
{
    return describe("SceneFollow", field("", &SceneFollow::def, "where on it, and the offset from there"),
                    field("body", &SceneFollow::body, "the body"));
}

/// A camera or a light, and where it is. In a file, the fields of its Def stand beside the others.
template <class Def> struct Placed {
    Def def = {};
    Pose pose = {};                         ///< in the world, or relative to `on`; it looks and shines along -Z
    std::optional<Vec3> target = {};        ///< [m], what it looks at from there, in place of its orientation
    std::string on = {};                    ///< a camera of the scene that carries it; empty: none
    std::optional<SceneFollow> follow = {}; ///< a body that it follows, in place of all these
};
using SceneCamera = Placed<visual::CameraDef>;
using SceneLight = Placed<visual::LightDef>;
template <class Def> constexpr auto fields(const Placed<Def>*)
{
    using T = Placed<Def>;
    return describe(std::is_same_v<Def, visual::CameraDef> ? "SceneCamera" : "SceneLight",
                    field("", &T::def, "its Def, whose fields stand beside the others"),
                    field("pose", &T::pose, "pose in the world, or relative to the camera that carries it"),
                    field("target", &T::target, "m", finite(), "what it looks at from there"),
                    field("on", &T::on, "name of the camera that carries it"),
                    field("follow", &T::follow, "the body that it follows"));
}

/// A rectangle of the window, or a picture of its own, and what is in it. In a file, the fields of ViewDef stand beside
/// the camera.
struct SceneView {
    visual::ViewDef def = {};
    std::string camera = {}; ///< name of a camera of the scene
};
constexpr auto fields(const SceneView*)
{
    return describe("SceneView", field("", &SceneView::def, "its Def, whose fields stand beside the camera"),
                    field("camera", &SceneView::camera, "name of the camera whose picture it shows"));
}

/// Gives a soft body another material of the same kind, as PhysicsServer::setMaterial().
struct SetMaterial {
    BodyId id = {};
    physics::SoftMaterial material = {};
};
constexpr auto fields(const SetMaterial*)
{
    return describe("SetMaterial", field("id", &SetMaterial::id, "the soft body"),
                    field("material", &SetMaterial::material, "new material, of the kind it was made with"));
}

/// Does something to the blood of a soft body that bleeds or the heat of one that burns, as Simulation::treat().
struct Treat {
    BodyId id = {};
    surface::Treatment treatment = {};
};
constexpr auto fields(const Treat*)
{
    return describe("Treat", field("id", &Treat::id, "the soft body"),
                    field("treatment", &Treat::treatment, "what is done"));
}

/// Presses the pedal of an electrode or releases it, as Simulation::activate().
struct Activate {
    BodyId id = {};
    int electrode = 0; ///< [-], >= 0, index among those of the body
    bool on = true;
};
constexpr auto fields(const Activate*)
{
    return describe("Activate", field("id", &Activate::id, "the rigid body"),
                    field("electrode", &Activate::electrode, "-", nonNegative(), "index among those of the body"),
                    field("on", &Activate::on, "whether its pedal is pressed"));
}

/// What a scene may command.
using SceneCommand = std::variant<physics::Attach, physics::AttachRigid, physics::Grasp, physics::ApplyClip,
                                  physics::Release, physics::RemovePiece, physics::RemoveBody, physics::SetForces,
                                  physics::SetWrench, physics::SetPressure, physics::SetFibreStress, physics::SetCavity,
                                  physics::SetCurvature, physics::SetCutting, physics::SetTissue, physics::SetGravity,
                                  SetMaterial, Treat, Activate, surface::Extract, surface::Distend, physics::SetPose,
                                  physics::SetJoint, physics::SetHaptic, physics::Reset>;

/// A command that physics gets once, in the step that ends at its time. An AttachmentId{n} in it means an attachment of
/// the scene: the first ones are those of the bodies' Defs, in their order; the command that makes another one says its
/// number. In a file, the fields of the command stand beside the time.
struct TimedCommand {
    SceneCommand command = {};
    double time = 0.0;      ///< [s], >= 0
    std::string place = {}; ///< where it stands, for errors; may be empty
};
constexpr auto fields(const TimedCommand*)
{
    using T = TimedCommand;
    return describe("TimedCommand", field("", &T::command, "the command, whose fields stand beside the time"),
                    field("time", &T::time, "s", nonNegative(), "when it is given"));
}

/// A whole scene.
struct SceneDef {
    runtime::PhysicsDef physics = {};
    window::WindowDef window = {};
    runtime::LookDef look = {}; ///< its camera and its light are not there if the scene has cameras of its own
    std::vector<SceneCamera> cameras = {}; ///< of different names
    std::vector<SceneLight> lights = {};   ///< they need a camera
    std::vector<SceneView> views = {};     ///< they need a camera; none: the first camera fills the window
    std::optional<visual::EnvironmentDef> environment = {}; ///< it needs a camera; not given: the default one
    std::optional<surface::SmokeDef> smoke = {};            ///< the room that holds smoke; none: nothing smokes
    std::optional<surface::DistensionDef> distension = {};  ///< a fluid that distends a cavity; it excludes smoke
    std::vector<SceneBody> bodies = {};
    std::vector<SceneInstrument> instruments = {}; ///< BodyIds of a scene count them after the bodies
    std::vector<SceneKnot> knots = {};             ///< that hands tie; none of their bodies has a number
    std::vector<TimedCommand> commands = {};       ///< at any times; those of the same time in this order
    std::vector<runtime::HapticInterfaceDef> haptics = {};
    std::vector<ScenePedal> pedals = {};            ///< how a person activates electrodes and suction
    std::optional<SceneTask> task = {};             ///< what a trainee has to do
    std::vector<prefab::TrackedBody> measured = {}; ///< what is observed if a session is written, at most 64
    std::vector<prefab::SensorDef> sensors = {};    ///< what is read over time if a table is written, at most 1000
    double sensorRate = 100.0; ///< [Hz], in [0.001, 100000], lines of that table per second of simulated time
    Places places = {};        ///< where the members of its lists stand, "cameras[0].on"
    std::vector<std::filesystem::path> files = {}; ///< which it was read from, and which it names; no field of a file
};
constexpr auto fields(const SceneDef*)
{
    using T = SceneDef;
    return describe("SceneDef", field("physics", &T::physics, "how physics is paced"),
                    field("window", &T::window, "the window of a live run"), field("look", &T::look, "the picture"),
                    field("cameras", &T::cameras, "cameras, in place of the look's"),
                    field("lights", &T::lights, "lights, in place of the look's"),
                    field("views", &T::views, "views; none: the first camera fills the window"),
                    field("environment", &T::environment, "what lights the scene from all sides"),
                    field("smoke", &T::smoke, "the room that holds smoke; none: nothing smokes"),
                    field("distension", &T::distension, "a fluid that distends a cavity"),
                    field("bodies", &T::bodies, "the bodies; one may name those before it"),
                    field("commands", &T::commands, "commands at their times"),
                    field("instruments", &T::instruments, "instruments, which come after the bodies"),
                    field("knots", &T::knots, "knots that hands tie"),
                    field("haptics", &T::haptics, "haptic interfaces"),
                    field("pedals", &T::pedals, "how a person activates electrodes and suction"),
                    field("task", &T::task, "what a trainee has to do"),
                    field("measured", &T::measured, "what is observed if a session is written"),
                    field("sensors", &T::sensors, "what is read over time if a table is written"),
                    field("sensorRate", &T::sensorRate, "Hz", closed(1e-3, 1e5), "lines of that table per second"));
}

/// The Def of a simulation for this scene.
runtime::SimulationDef simulationDef(const SceneDef& scene);

/// How far a knot of a scene is.
struct SceneKnotProgress {
    std::string name = {};
    int throws = 0;            ///< [-], that it has
    int tied = 0;              ///< [-], that are tied and tightened since the hands began
    double largestForce = 0.0; ///< [N], with which a hand has drawn at its strand
};

/// What was made of a scene. If it has a task and a tracker, keep it until the run has ended.
struct [[nodiscard]] AddedScene {
    std::vector<BodyId> bodies = {}; ///< their ids in the order of the scene, those of the instruments behind them
    std::shared_ptr<const prefab::Task> task = {}; ///< null if the scene has none
    /// Null if no session is written. Let it go when the run has ended, and before the simulation.
    std::shared_ptr<prefab::MetricTracker> tracker = {};
    /// Null if the scene has none. The same holds for them.
    std::shared_ptr<prefab::Sensors> sensors = {};
    /// How far each knot is, in the order of SceneDef::knots; they end before the simulation.
    std::vector<std::function<SceneKnotProgress()>> knots = {};
    std::map<BodyId, runtime::ShownId> drawn = {}; ///< bodies that are drawn because the scene shows none
};

/// Adds the scene's bodies, pictures, motions, commands, cameras, lights, instruments, knots, haptics and task to a
/// simulation that is not running. `tracker` says what becomes of its measures, if it names a file or keeps them; what
/// is observed, and the names of task and steps, are the scene's. The table of its sensors is `sensorsFile`, if that is
/// not empty. Throws an Error that begins with the place of what is
/// wrong, or with its path; what came before it stays added.
AddedScene addScene(runtime::Simulation& simulation, const SceneDef& scene, prefab::MetricTrackerDef tracker = {},
                    std::string sensorsFile = {});

} // namespace filasofia::scene

#pragma once

#include "filasofia/runtime/simulation.h"

#include <map>
#include <string>
#include <vector>

/// A whole scene as data: what a scene file says, and what a program may build instead.
namespace filasofia::scene {

/// A pose that a body reaches at a time.
struct KeyPose {
    double time = 0.0; ///< [s], >= 0
    Pose pose = {};    ///< the element's, in the world
};
constexpr auto fields(const KeyPose*)
{
    return describe("KeyPose", field("time", &KeyPose::time, "s", nonNegative(), "when it is reached"),
                    field("pose", &KeyPose::pose, "pose of the element in the world"));
}

/// The motion of an element of a kinematic body: straight from key to key at constant speed, turning the shortest way.
/// Before the first key it stays at the first, after the last at the last.
struct ElementMotion {
    int element = 0;                ///< [-], >= 0, index in the body
    std::vector<KeyPose> keys = {}; ///< at least one; times ascend
    bool repeat = false;            ///< start again after the last key, whose time is then > 0
};
constexpr auto fields(const ElementMotion*)
{
    using T = ElementMotion;
    return describe("ElementMotion", field("element", &T::element, "-", nonNegative(), "index in the body"),
                    field("keys", &T::keys, "poses and the times at which they are reached, ascending"),
                    field("repeat", &T::repeat, "start again after the last key"));
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

/// A body, how it is drawn, and how it moves. In Defs of a scene, BodyId{n} means the n-th body of the scene, from 1;
/// it must come before the body that names it. In a file, the fields of the body's Def stand beside the others.
struct SceneBody {
    physics::BodyDef def = physics::SoftBodyDef{}; ///< its name must be the only one in the scene
    std::vector<runtime::ShowDef> show = {};       ///< none: it is not drawn
    std::vector<runtime::PaintDef> paint = {};     ///< marks on what is drawn of it
    std::vector<ElementMotion> motions = {};       ///< a kinematic rigid body's elements
    std::vector<JointMotion> jointMotions = {};    ///< an articulated body's joints
    /// Where it stands, "scene.json:12:5", by the empty path, and its members by theirs, "material.law"; for errors,
    /// and may be empty.
    std::map<std::string, std::string> places = {};
};
constexpr auto fields(const SceneBody*)
{
    using T = SceneBody;
    return describe("SceneBody", field("", &T::def, "the body's Def, whose fields stand beside the others"),
                    field("show", &T::show, "how it is drawn"), field("paint", &T::paint, "marks on it"),
                    field("motions", &T::motions, "motions of a kinematic body's elements"),
                    field("jointMotions", &T::jointMotions, "commands of its joints"));
}

/// A whole scene.
struct SceneDef {
    runtime::PhysicsDef physics = {};
    window::WindowDef window = {};
    runtime::LookDef look = {};
    std::vector<SceneBody> bodies = {};
    std::vector<runtime::HapticInterfaceDef> haptics = {};
};
constexpr auto fields(const SceneDef*)
{
    using T = SceneDef;
    return describe("SceneDef", field("physics", &T::physics, "how physics is paced"),
                    field("window", &T::window, "the window of a live run"), field("look", &T::look, "the picture"),
                    field("bodies", &T::bodies, "the bodies; one may name those before it"),
                    field("haptics", &T::haptics, "haptic interfaces"));
}

/// The Def of a simulation for this scene.
runtime::SimulationDef simulationDef(const SceneDef& scene);

/// Adds the scene's bodies, pictures, motions and haptic interfaces to a simulation that is not running; returns the
/// bodies' ids, in the order of the scene. Throws an Error that begins with the place of what is
/// wrong, or with "haptics[0]"; what came before it stays added.
std::vector<BodyId> addScene(runtime::Simulation& simulation, const SceneDef& scene);

} // namespace filasofia::scene

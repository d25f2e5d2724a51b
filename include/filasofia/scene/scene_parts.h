#pragma once

#include "filasofia/prefab/articulated_instrument.h"
#include "filasofia/prefab/clip_applier.h"
#include "filasofia/prefab/endoscope.h"
#include "filasofia/prefab/instrument_tie.h"
#include "filasofia/prefab/knot_hands.h"
#include "filasofia/prefab/laparoscope.h"
#include "filasofia/prefab/laparoscopic_instrument.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/prefab/sensors.h"
#include "filasofia/prefab/specimen_bag.h"
#include "filasofia/prefab/suction_irrigator.h"
#include "filasofia/prefab/task.h"
#include "filasofia/prefab/ultrasonic_shears.h"
#include "filasofia/prefab/wire_loop.h"
#include "filasofia/surface/distension_def.h"
#include "filasofia/surface/smoke_def.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

/// Instruments, tasks and measures of a scene as data.
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

/// What the jaws of an instrument do from a time on.
struct KeyGrip {
    double time = 0.0;                  ///< [s], >= 0
    std::optional<double> opening = {}; ///< [-], in [0, 1], fraction to which they open; not given: they close
    std::optional<double> torque = {};  ///< [N m], > 0, with which they close; not given: the instrument's
};
constexpr auto fields(const KeyGrip*)
{
    using T = KeyGrip;
    return describe("KeyGrip", field("time", &T::time, "s", nonNegative(), "when it begins"),
                    field("opening", &T::opening, "-", closed(0, 1), "how far they open; not given: they close"),
                    field("torque", &T::torque, "N m", positive(), "with which they close"));
}

/// A pose in its trocar that a shaft reaches at a time.
struct KeyTrocar {
    double time = 0.0; ///< [s], >= 0
    prefab::TrocarPose pose = {};
};
constexpr auto fields(const KeyTrocar*)
{
    return describe("KeyTrocar", field("time", &KeyTrocar::time, "s", nonNegative(), "when it is reached"),
                    field("pose", &KeyTrocar::pose, "pose of the shaft in its trocar"));
}

using InstrumentDef = std::variant<prefab::ArticulatedInstrumentDef, prefab::EndoscopeDef,
                                   prefab::LaparoscopicInstrumentDef, prefab::LaparoscopeDef, prefab::WireLoopDef>;

/// An instrument, moved by keys or by the haptic interface that names it; its first button then closes the jaws. In
/// commands, cameras and haptic interfaces its name is that of its body. The first endoscope gives the picture, unless
/// the scene has cameras. If two instruments in trocars and a laparoscope have no keys and no haptic device, a person
/// moves them as prefab::TrocarHands says: the first is the left one. In a file, the fields of its Def stand beside the
/// others.
struct SceneInstrument {
    InstrumentDef def = prefab::ArticulatedInstrumentDef{}; ///< its name must be the only one in the scene
    std::vector<KeyPose> keys = {}; ///< poses of its pivot or tip; times ascend, and at 0 s in place of the Def's
    std::vector<KeyTrocar> trocarKeys = {};                  ///< in a trocar, in place of keys; times ascend
    std::vector<KeyGrip> grip = {};                          ///< what its jaws do; times ascend
    std::vector<surface::ElectrodeDef> electrodes = {};      ///< parts of it that heat what they touch
    std::optional<prefab::ClipApplierDef> clips = {};        ///< what its jaws close; for one that has jaws
    std::optional<prefab::SpecimenBagDef> bag = {};          ///< what its arms spread; for one that has arms
    std::optional<prefab::SuctionIrrigatorDef> suction = {}; ///< sucks while it is closed; not for an endoscope
    std::optional<prefab::UltrasonicShearsDef> shears = {};  ///< for one of kind ultrasonicShears: its electrode 0
};
constexpr auto fields(const SceneInstrument*)
{
    using T = SceneInstrument;
    return describe("SceneInstrument", field("", &T::def, "its Def, whose fields stand beside the others"),
                    field("keys", &T::keys, "poses and the times at which they are reached, ascending"),
                    field("trocarKeys", &T::trocarKeys, "poses in its trocar and their times, ascending"),
                    field("grip", &T::grip, "what its jaws do from which time on, ascending"),
                    field("electrodes", &T::electrodes, "parts that heat what they touch"),
                    field("clips", &T::clips, "clips that its jaws close"),
                    field("bag", &T::bag, "a bag whose mouth its arms spread"),
                    field("suction", &T::suction, "what it sucks while it is closed, and how it rinses"),
                    field("shears", &T::shears, "how it seals and parts what it holds"));
}

using SceneKnotDef = std::variant<prefab::KnotDef, prefab::InstrumentTieDef>;

/// A knot that two hands, or a hand and a needle driver, tie with the ends of a thread of the scene. In a file, the
/// fields of its Def stand beside the others.
struct SceneKnot {
    SceneKnotDef def = prefab::KnotDef{};
    double begin = 0.0;                 ///< [s], >= 0, when the hands take the thread
    std::optional<double> release = {}; ///< [s], > begin, when they let it go; not given: never
};
constexpr auto fields(const SceneKnot*)
{
    using T = SceneKnot;
    return describe("SceneKnot", field("", &T::def, "its Def, whose fields stand beside the others"),
                    field("begin", &T::begin, "s", nonNegative(), "when the hands take the thread"),
                    field("release", &T::release, "s", positive(), "when they let it go; not given: never"));
}

/// How a person activates an electrode, opens suction of smoke, or lets an instrument rinse: while a key of the window
/// is held, or a button of the haptic interface that holds the body. At least one of both is given.
struct ScenePedal {
    BodyId body = {};                             ///< may be none if there is `extract` and no button
    int electrode = 0;                            ///< [-], >= 0, index among those of the body; without `extract`
    std::optional<surface::Extract> extract = {}; ///< in place of an electrode: what is sucked away while it is pressed
    bool rinse = false;                           ///< in place of an electrode: an instrument with `suction` rinses
    std::string key = {};                         ///< a letter or a digit; empty: none
    std::optional<int> button = {}; ///< [-], >= 0, of a haptic interface; button 0 of an instrument closes its jaws
};
constexpr auto fields(const ScenePedal*)
{
    using T = ScenePedal;
    return describe("ScenePedal", field("body", &T::body, "the rigid body"),
                    field("electrode", &T::electrode, "-", nonNegative(), "index among those of the body"),
                    field("extract", &T::extract, "in place of an electrode: smoke that is sucked away"),
                    field("rinse", &T::rinse, "in place of an electrode: an instrument with suction rinses"),
                    field("key", &T::key, "a letter or a digit"),
                    field("button", &T::button, "-", nonNegative(), "of the haptic interface that holds the body"));
}

/// A point of a body is near a place, or near another body.
struct Reached {
    BodyId body = {};
    int element = 0;                ///< [-], >= 0, index in a rigid body
    Vec3 tip = {};                  ///< [m], the point, in the element's coordinates
    std::optional<int> node = {};   ///< [-], >= 0, the point of a soft body or a rod; without it its middle
    std::optional<Vec3> place = {}; ///< [m], in the world
    BodyId target = {};             ///< in place of a place: the middle of this body
    double within = 5e-3;           ///< [m], > 0
};
/// Two bodies press on each other.
struct Touched {
    BodyId first = {}, second = {};
    double force = 0.0; ///< [N], >= 0, the sum of their normal forces must exceed it
};
/// A body is held by another one: attached or grasped.
struct Held {
    BodyId body = {};
    BodyId by = {}; ///< none: by any body
};
/// A body was cut, or has torn.
struct Parted {
    BodyId body = {};
    double area = 0.0; ///< [m^2], >= 0, opened in all since the run began, of one of the two sides
    int pieces = 0;    ///< [-], >= 0, that must have come loose
};
/// A needle, or a thread behind it, is in tissue.
struct Pierced {
    BodyId body = {};    ///< the tissue
    BodyId by = {};      ///< the needle or thread at the entry; none: any
    bool through = true; ///< whether the needle must have come out again
};
/// So much time has gone by since the step began.
struct Waited {
    double seconds = 1.0; ///< [s], > 0
};
using Condition = std::variant<Reached, Touched, Held, Parted, Pierced, Waited>;

constexpr auto fields(const Reached*)
{
    using T = Reached;
    return describe(
        "Reached", field("body", &T::body, "the body that moves"),
        field("element", &T::element, "-", nonNegative(), "index in a rigid body"),
        field("tip", &T::tip, "m", finite(), "its point, in the element's coordinates"),
        field("node", &T::node, "-", nonNegative(), "the point of a soft body or a rod; without it its middle"),
        field("place", &T::place, "m", finite(), "where to go, in the world"),
        field("target", &T::target, "the body to go to, in place of a place"),
        field("within", &T::within, "m", positive(), "distance at which it is reached"));
}
constexpr auto fields(const Touched*)
{
    using T = Touched;
    return describe("Touched", field("first", &T::first, "a body"), field("second", &T::second, "the other one"),
                    field("force", &T::force, "N", nonNegative(), "normal force that must be exceeded"));
}
constexpr auto fields(const Held*)
{
    return describe("Held", field("body", &Held::body, "the body that is held"),
                    field("by", &Held::by, "by which; none: by any"));
}
constexpr auto fields(const Parted*)
{
    using T = Parted;
    return describe("Parted", field("body", &T::body, "the body that is cut or torn"),
                    field("area", &T::area, "m^2", nonNegative(), "area that must be opened"),
                    field("pieces", &T::pieces, "-", nonNegative(), "pieces that must have come loose"));
}
constexpr auto fields(const Pierced*)
{
    using T = Pierced;
    return describe("Pierced", field("body", &T::body, "the tissue"),
                    field("by", &T::by, "the needle or thread at the entry; none: any"),
                    field("through", &T::through, "whether the needle must have come out again"));
}
constexpr auto fields(const Waited*)
{
    return describe("Waited", field("seconds", &Waited::seconds, "s", positive(), "since the step began"));
}

/// A step of a task, done when its condition holds.
struct SceneTaskStep {
    std::string name = {};                                      ///< as the session records it
    std::string instruction = {};                               ///< what the trainee reads
    double timeLimit = std::numeric_limits<double>::infinity(); ///< [s], > 0; exceeding it is a mistake
    Condition done = Reached{};
};
constexpr auto fields(const SceneTaskStep*)
{
    using T = SceneTaskStep;
    return describe("SceneTaskStep", field("name", &T::name, "as the session records it"),
                    field("instruction", &T::instruction, "what the trainee reads"),
                    field("timeLimit", &T::timeLimit, "s", positiveOrInfinite(), "exceeding it is a mistake"),
                    field("done", &T::done, "the condition"));
}

/// What a trainee has to do, step by step. The run ends when it is over.
struct SceneTask {
    std::string name = "task";
    std::vector<SceneTaskStep> steps = {};                      ///< at least one, done in this order
    double timeLimit = std::numeric_limits<double>::infinity(); ///< [s], > 0, for the whole task
};
constexpr auto fields(const SceneTask*)
{
    using T = SceneTask;
    return describe("SceneTask", field("name", &T::name, "what reports call it"), field("steps", &T::steps, "in order"),
                    field("timeLimit", &T::timeLimit, "s", positiveOrInfinite(), "limit for the whole task"));
}

} // namespace filasofia::scene

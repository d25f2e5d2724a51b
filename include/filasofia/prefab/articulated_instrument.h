#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/simulation.h"

#include <array>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::prefab {

/// Which meshes, jaws, opening angles and closing torque an instrument has if its Def does not give them.
enum class InstrumentKind {
    Forceps,              ///< 5 Fr (1.7 mm), for hysteroscopy: short cups; 0.5 mN m
    Grasper,              ///< 5 Fr: long jaws with teeth; 0.5 mN m
    Scissors,             ///< 5 Fr: two blades, which cut and hold nothing; 0.5 mN m
    NeedleDriver,         ///< 5 mm, for laparoscopy: short, stout, flat jaws that press with some 15 N; 0.15 N m
    PickUps,              ///< 5 mm: long, pointed jaws; 10 mN m
    SutureScissors,       ///< 5 mm: two short blades, which cut and hold nothing; 50 mN m
    LaparoscopicGrasper,  ///< 5 mm: long jaws with teeth; 30 mN m
    Dissector,            ///< 5 mm: pointed jaws bent to the right; 20 mN m
    LaparoscopicScissors, ///< 5 mm: two long blades, which cut and hold nothing; 50 mN m
    ClipApplier,          ///< 5 mm: two bars between which a clip lies; they touch and hold nothing; 50 mN m
    SpecimenBag,          ///< 5 mm: two arms of wire that spread the mouth of a bag; they touch nothing; 50 mN m
    UltrasonicShears,     ///< 5 mm: a pad that presses tissue onto a fixed blade; 0.1 N m
    Hook,                 ///< 5 mm: an L of wire with a cutting edge; no jaws
    SuctionIrrigator,     ///< 5 mm: a tube, open at its end; no jaws
};
/// Whether something moves that can close.
constexpr bool hasJaws(InstrumentKind kind)
{
    return kind != InstrumentKind::Hook && kind != InstrumentKind::SuctionIrrigator;
}
/// The values' names in files, in order.
constexpr std::array<std::string_view, 14> names(const InstrumentKind*)
{
    return {"forceps",
            "grasper",
            "scissors",
            "needleDriver",
            "pickUps",
            "sutureScissors",
            "laparoscopicGrasper",
            "dissector",
            "laparoscopicScissors",
            "clipApplier",
            "specimenBag",
            "ultrasonicShears",
            "hook",
            "suctionIrrigator"};
}

/// One side of the instrument's mouth, closed, in the coordinates of the pivot.
struct JawDef {
    runtime::SurfaceSource surface = {};        ///< what is drawn; empty: nothing
    physics::TriangleMeshSource collision = {}; ///< its collision mesh; empty: it touches nothing
    Vec3 axis = {1.0, 0.0, 0.0};                ///< [-], any length > 0, the axis about which it opens
    /// [rad], in [0, 3], largest opening angle; 0: it is fixed to the shaft.
    double opensBy = 45.0 * std::numbers::pi / 180.0;
    /// [m], the two ends of a blade's cutting edge; not given: it does not cut.
    std::optional<std::array<Vec3, 2>> edge = {};
};
constexpr auto fields(const JawDef*)
{
    using T = JawDef;
    return describe("JawDef", field("surface", &T::surface, "what is drawn"),
                    field("collision", &T::collision, "collision mesh"),
                    field("axis", &T::axis, "-", finite(), "axis of its opening"),
                    field("opensBy", &T::opensBy, "rad", closed(0, 3), "largest opening angle; 0: it is fixed"),
                    field("edge", &T::edge, "its cutting edge"));
}

/// A shaft with a mouth of one or two moving jaws. It points along -Z; its pivot is the origin, and the shaft lies at
/// +Z.
struct ArticulatedInstrumentDef {
    std::string name = "instrument";
    InstrumentKind kind = InstrumentKind::Forceps;
    Pose pose = {};                                  ///< pose of the pivot at the start, in the world
    runtime::SurfaceSource shaft = {};               ///< what is drawn of the shaft; empty: the kind's
    physics::TriangleMeshSource shaftCollision = {}; ///< the shaft's collision mesh; empty: the kind's
    /// At most two; at least one moves, if the kind has jaws. Empty: the kind's.
    std::vector<JawDef> jaws = {};
    std::vector<int> groups = {0};            ///< collision groups of its models; empty: it touches nothing
    double opening = 0.0;                     ///< [-], in [0, 1], opening at the start
    std::optional<double> closingTorque = {}; ///< [N m], > 0, of each jaw at close(); not given: the kind's
    double speed = 1.5;                       ///< [rad/s], > 0, largest speed of a jaw
    double proximity = 0.1e-3;                ///< [m], >= 0, distance at which contacts are found
    double friction = 0.8;                    ///< [-], >= 0, coefficient of friction
    bool grasps = true;      ///< whether its closed jaws can hold something; those of scissors never do
    double gripForce = 0.02; ///< [N], > 0, force on each side of the mouth at which tissue counts as grasped
    double gripStiffness = physics::kHard; ///< [N/m], in (0, inf], stiffness of each held point
    double breakForce = physics::kNever;   ///< [N], in (0, inf], force beyond which the tissue slips out
    visual::Material material = visual::MetalMaterial{};
    std::optional<visual::Material> shaftMaterial = {}; ///< not given: that of the jaws
    /// Called on the stepping thread when it begins (true) or ceases (false) to hold a body. Not a field of files.
    std::function<void(BodyId, bool)> onGrasp = {};
};
constexpr auto fields(const ArticulatedInstrumentDef*)
{
    using T = ArticulatedInstrumentDef;
    return describe(
        "ArticulatedInstrumentDef", field("name", &T::name, "what errors and reports call it"),
        field("kind", &T::kind, "which meshes and jaws it has by default"),
        field("pose", &T::pose, "pose of the pivot at the start"),
        field("shaft", &T::shaft, "what is drawn of the shaft"),
        field("shaftCollision", &T::shaftCollision, "collision mesh of the shaft"),
        field("jaws", &T::jaws, "one or two"), field("groups", &T::groups, "collision groups of its models"),
        field("opening", &T::opening, "-", closed(0, 1), "opening at the start"),
        field("closingTorque", &T::closingTorque, "N m", positive(),
              "torque that closes each jaw; not given: the kind's"),
        field("speed", &T::speed, "rad/s", positive(), "largest speed of a jaw"),
        field("proximity", &T::proximity, "m", nonNegative(), "distance at which contacts are found"),
        field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction), "mu of Coulomb's law"),
        field("grasps", &T::grasps, "whether its jaws can hold something"),
        field("gripForce", &T::gripForce, "N", positive(), "force on each side at which tissue is grasped"),
        field("gripStiffness", &T::gripStiffness, "N/m", positiveOrInfinite(), "stiffness of each held point"),
        field("breakForce", &T::breakForce, "N", positiveOrInfinite(), "force beyond which tissue slips out"),
        field("material", &T::material, "what it looks like"),
        field("shaftMaterial", &T::shaftMaterial, "what its shaft looks like; not given: as its jaws"));
}

/// An instrument that is moved as a whole, opened and closed. Key, device button and script all use the same calls.
///
/// Closing presses with a torque, so tissue between the jaws stops them. If a soft body pushes both sides of the mouth,
/// in front of the pivot, with `gripForce` or more, it is grasped: it is attached to the jaws, which then keep their
/// angle (a ratchet), until open() or until `breakForce` is exceeded. So is a dynamic rigid body without joints, a
/// needle for example, until the force exceeds what friction bears, too: 2 mu times the closing torque over the
/// distance from the pivot. With a finite `gripStiffness` the jaws then open by 0.2 mm, so that a spring alone holds
/// it, and two instruments can hold it. A thread that lies on the shaft, too, is held between the jaws only, and slides
/// on the shaft. A reset of the simulation does not release what is held: call open() before. A saved state knows what
/// it holds; onGrasp is not called when such a state is restored.
///
/// What has no jaws is closed by its trigger alone: close() and open() tell nothing but opening(), which says what the
/// hand does. Every function may be called from any thread and takes effect at the next step.
class ArticulatedInstrument {
public:
    static constexpr int kShaft = 0; ///< element of the body; moving jaws follow from 1 on

    /// Adds and shows the body. Throws an Error if the Def is wrong. Construct it before a run and destroy it before
    /// the simulation.
    ArticulatedInstrument(runtime::Simulation& simulation, const ArticulatedInstrumentDef& def = {});
    ~ArticulatedInstrument();
    ArticulatedInstrument(const ArticulatedInstrument&) = delete;
    ArticulatedInstrument& operator=(const ArticulatedInstrument&) = delete;

    [[nodiscard]] BodyId body() const;

    void move(const Pose& pivot); ///< pose of the pivot in the world
    /// Moves the jaws to this fraction of their opening angle, in [0, 1] (Error otherwise), and releases what they
    /// hold.
    void open(double opening = 1.0);
    /// Presses the jaws together, each with `torque` [N m], > 0; not given: that of the Def.
    void close(std::optional<double> torque = {});

    [[nodiscard]] Pose pose() const;      ///< the last pose given to move()
    [[nodiscard]] BodyId holding() const; ///< the body that it holds; 0 if none
    [[nodiscard]] double pull() const;    ///< [N], force of the held tissue on the instrument in the last step
    /// [m], where what it holds pulls, in the world: the middle of the grasped contacts, or the origin of a rigid
    /// element; if it holds nothing, where what it carries pulls, or its pivot.
    [[nodiscard]] Vec3 grip() const;
    /// Something is fixed to it for good, a bag for example: it pulls at this point [m] in the coordinates of the
    /// pivot. A trocar's lever begins there.
    void carries(Vec3 at);
    /// [-], opening of the widest jaw in the last step; without jaws 0 if it was told to close, and 1 if not.
    [[nodiscard]] double opening() const;
    [[nodiscard]] InstrumentKind kind() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callback
};

} // namespace filasofia::prefab

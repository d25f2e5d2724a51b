#pragma once

#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

/// Needles and threads in blocks of tissue, moved by hand.
namespace filasofia::engine {

inline constexpr double kNeedleRadius = 0.4e-3, kNeedleLength = 0.03, kNeedleStep = 1e-3;
inline constexpr double kToTip = 0.5 * kNeedleLength + kNeedleRadius; // [m] from the needle's origin down to its tip
inline const physics::PunctureDef kSkin{.force = 0.6, .cutting = 0.2, .friction = 20.0};

/// A block of tissue whose upper side is at y = 0; its lower one is held.
inline physics::SoftBodyDef tissueBlock(double thickness, const physics::PunctureDef& puncture = kSkin)
{
    physics::SoftBodyDef def{.name = "tissue", .mesh = geometry::shapes::block({0.03, thickness, 0.03}, {8, 6, 8})};
    def.pose.position.y = -0.5 * thickness;
    def.material = physics::FemMaterial{.youngModulus = 3e4, .poissonRatio = 0.45};
    def.gravity = false;
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.999 * thickness, 1}}}};
    def.collision = {{.proximity = 0.3e-3}};
    def.friction = 0.0;
    def.puncture = puncture;
    return def;
}

/// A straight needle that points down, with its tip at this height [m].
inline physics::RigidBodyDef straightNeedle(double height, bool dynamic = false)
{
    physics::RigidBodyDef def{.name = "needle",
                              .elements = {Pose{{0.4e-3, height + kToTip, 0.3e-3}, {}}}, // not along edges of the mesh
                              .mesh = geometry::shapes::capsule(kNeedleRadius, kNeedleLength),
                              .dynamic = dynamic,
                              .mass = physics::TotalMass{1e-3}};
    def.gravity = false;
    def.collision = {{.proximity = 0.3e-3}};
    def.needle = physics::NeedleDef{.line = {{0, -kToTip, 0}, {0, kToTip, 0}}, .radius = kNeedleRadius};
    return def;
}

/// A needle moved by hand, up and down.
struct Insertion {
    Stage stage;
    BodyId block, tool;
    frame::Frame frame;
    double height; ///< [m] where the tip is

    explicit Insertion(double thickness, const physics::PunctureDef& puncture = kSkin, int threads = 1)
        : stage({.threads = threads}), height(1e-3)
    {
        block = stage.add(tissueBlock(thickness, puncture));
        tool = stage.add(straightNeedle(height));
    }
    /// Puts the tip to this place in a step. A turned needle comes from the side.
    physics::StepReport put(double y, double x = 0.4e-3, Quat turn = {})
    {
        height = y;
        const Vec3 tip{x, height, 0.3e-3};
        stage.post(physics::SetPose{tool, 0, Pose{tip + rotate(turn, {0, kToTip, 0}), turn}});
        const physics::StepReport report = stage.step(kNeedleStep);
        stage.world.capture(frame);
        return report;
    }
    /// Moves the needle by dy [m] in a step; returns the force [N] with which the tissue pushes it up.
    double move(double dy)
    {
        CHECK(put(height + dy).flags == 0);
        double force = 0.0;
        for (const frame::Channel& each : frame.channels) force -= each.force.y;
        for (const frame::Contact& each : frame.contacts)
            force += (each.first == tool ? 1.0 : -1.0) * (each.normalForce * each.normal + each.friction).y;
        return force;
    }
};

/// A needle with a thread at its tail that hangs upwards, pushed down through a block until the thread runs through it.
struct Stitch {
    static constexpr double kThick = 4e-3;
    Insertion in;
    BodyId thread;

    explicit Stitch(int threads = 1) : in(kThick, {.force = 0.3, .cutting = 0.1, .friction = 10.0}, threads)
    {
        const double tail = in.height + 2.0 * kToTip;
        physics::RodBodyDef def{.name = "thread", .points = {{0.4e-3, tail, 0.3e-3}, {0.4e-3, tail + 0.06, 0.3e-3}}};
        def.spacing = 1e-3;
        def.radius = 0.15e-3;
        def.gravity = false;
        def.friction = 0.0;
        def.collision = physics::RodCollision{.self = false};
        def.attachments = {{.nodes = {0}, .to = in.tool}};
        def.dynamicTopology = true;
        thread = in.stage.add(def);
    }
    /// Cuts the thread at a height [m].
    void cutAt(double y)
    {
        for (int i = 0; i < 100; ++i) in.move(0.0); // until it rests: a part that nothing holds would fly on
        SoftBody& rod = in.stage.world.scene().soft[1];
        int edge = 0;
        while (rod.state.x[static_cast<std::size_t>(edge) + 1].y < y) ++edge;
        rod.topology.cutEdges = {{edge, 0.5}};
        in.move(0.0);
        REQUIRE(isCut(rod.model.rod, static_cast<std::size_t>(edge)));
    }
    /// Until the needle's tail is this deep below the block [m].
    void pull(double below)
    {
        while (in.height + 2.0 * kToTip > -kThick - below) in.move(-0.03 * kNeedleStep);
    }
};

} // namespace filasofia::engine

#include "filasofia/engine/step/close_clips.h"

#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/clip_legs.h"
#include "filasofia/engine/scene/check_scene.h"
#include "filasofia/engine/scene/state_hash.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_server.h"

#include "engine/stage.h"
#include "engine/step/clip_body.h"

#include <numbers>
#include <utility>

namespace clips_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

constexpr double kStep = 1e-3;

/// A block of 3 x 4 x 6 mm that falls nowhere.
SoftBodyDef block(double young = 20e3)
{
    return {.name = "block",
            .mesh = shapes::block({3e-3, 4e-3, 6e-3}, {4, 4, 6}),
            .material = FemMaterial{.youngModulus = young, .poissonRatio = 0.0},
            .rayleigh = {50.0, 0.0},
            .gravity = false};
}

/// A tube along x, 20 mm long, 4 mm wide; its lumen is 2.4 mm wide.
SoftBodyDef duct()
{
    std::vector<Vec3> line;
    for (int i = 0; i <= 20; ++i) line.push_back({1e-3 * i - 10e-3, 0, 0});
    return {.name = "duct",
            .mesh = shapes::vessel(line, 1.2e-3, 0.8e-3, {8, 1}),
            .material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4},
            .rayleigh = {20.0, 0.0},
            .gravity = false,
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {-9.5e-3, 1, 1}}},
                            {.box = geometry::Box{{9.5e-3, -1, -1}, {1, 1, 1}}}}};
}

/// Posts the clip, and returns its id.
AttachmentId apply(Stage& stage, BodyId rigid, BodyId soft, const ClipDef& def)
{
    const AttachmentId id{++stage.lastAttachment};
    stage.post(ApplyClip{id, rigid, soft, def});
    return id;
}

/// Two blocks in one body, 4 mm from middle to middle along x, that may fall apart: piece 0 is the left one.
SoftBodyDef twoBlocks()
{
    SoftBodyDef def = block();
    const auto one = std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh);
    geometry::TetMesh both = *one;
    const auto n = static_cast<int>(both.nodes.size());
    for (Vec3 each : one->nodes) both.nodes.push_back(each + Vec3{4e-3, 0, 0});
    for (auto each : one->tetrahedra) {
        for (int& node : each) node += n;
        both.tetrahedra.push_back(each);
    }
    for (Vec3& each : both.nodes) each.x -= 2e-3;
    def.mesh = std::make_shared<const geometry::TetMesh>(std::move(both));
    def.dynamicTopology = true;
    return def;
}

const frame::Clip& report(Stage& stage, std::size_t at = 0) { return stage.world.scene().clipReports.at(at); }

Vec3 momentum(Stage& stage)
{
    Vec3 sum;
    for (std::size_t i = 0; i < stage.soft().v.size(); ++i) sum += stage.model().masses[i] * stage.soft().v[i];
    return sum;
}

/// [m] Between the means of the two sides of the block.
double heightOf(Stage& stage)
{
    double top = 0.0, bottom = 0.0;
    int tops = 0, bottoms = 0;
    for (std::size_t i = 0; i < stage.model().rest.size(); ++i) {
        const double y = stage.model().rest[i].y;
        if (y > 1.999e-3) top += stage.soft().x[i].y, ++tops;
        if (y < -1.999e-3) bottom += stage.soft().x[i].y, ++bottoms;
    }
    return top / tops - bottom / bottoms;
}

} // namespace

TEST_CASE("a clip that bends presses with what its legs bear, and squeezes a block as Hooke says")
{
    Stage stage;
    const BodyId soft = stage.add(block()), rigid = stage.add(clipBody());
    const double area = 3e-3 * 6e-3, force = 0.05 * 20e3 * area; // 5 % strain
    apply(stage, rigid, soft, {.length = 6e-3, .width = 3e-3, .closingForce = force, .stiffness = 500.0});
    const StepReport first = stage.step(kStep);
    CHECK(first.clips.applied == 1);
    stage.run(1500, kStep);
    CHECK(report(stage).force == Approx(force).epsilon(1e-3));
    CHECK(report(stage).closed);
    CHECK(report(stage).gap > 3e-3); // it has bent open
    CHECK((4e-3 - heightOf(stage)) == Approx(0.05 * 4e-3).epsilon(0.05));
    CHECK(length(report(stage).place) < 2e-5);
}

TEST_CASE("the forces of a clip are the derivative of its energy, and sum up to nothing, as do their moments")
{
    Stage stage;
    const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody());
    apply(stage, rigid, soft, {});
    stage.run(150, kStep);
    SoftState& state = stage.soft();
    REQUIRE(state.clips.size() == 1);
    const Clip& clip = state.clips.front();
    CHECK(clip.pairs.size() >= 12);
    for (Vec3& each : state.v) each = {};
    const auto forcesAt = [&](std::vector<Vec3> x) {
        const std::size_t nodes = x.size();
        const std::vector<Vec3> kept = std::exchange(state.x, std::move(x));
        Coupling coupling;
        addClipLegs(kStep, stage.world.scene(), coupling);
        state.x = kept;
        std::vector<Vec3> forces(nodes);
        for (const Constraint& leg : coupling.constraints) // as the solve has them for bodies at rest
            for (std::size_t side = 0; side < 2; ++side)
                for (const NodeWeight& each : nodeWeights(leg.sides[side])) {
                    const double share = (side == 0 ? -1.0 : 1.0) * each.weight * leg.softness * leg.bias.x / kStep;
                    forces[static_cast<std::size_t>(each.node)] += share * leg.frame[0];
                }
        return forces;
    };
    const auto energyAt = [&](const std::vector<Vec3>& x) {
        double sum = 0.0;
        for (const ClipPair& each : clip.pairs) {
            const double d = distance(meanOf(each[0], x), meanOf(each[1], x));
            const double k = clip.def.stiffness / static_cast<double>(clip.pairs.size());
            sum += 0.5 * k * std::pow(std::max(0.0, d - clip.gap), 2);
        }
        return sum;
    };
    const std::vector<Vec3> forces = forcesAt(state.x);
    Vec3 sum, moment;
    double largest = 0.0, error = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        sum += forces[i];
        moment += cross(state.x[i], forces[i]);
        largest = std::max(largest, length(forces[i]));
        for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            std::vector<Vec3> more = state.x, less = state.x;
            more[i] += 1e-8 * axis;
            less[i] = less[i] - 1e-8 * axis;
            const double slope = (energyAt(more) - energyAt(less)) / 2e-8;
            error = std::max(error, std::abs(dot(forces[i], axis) + slope));
        }
    }
    CHECK(largest > 1e-4);
    CHECK(error < 1e-4 * largest);
    CHECK(length(sum) < 1e-12);
    CHECK(length(moment) < 1e-14);
}

TEST_CASE("a clip on a free block does not move it")
{
    Stage stage;
    const BodyId soft = stage.add(block()), rigid = stage.add(clipBody());
    apply(stage, rigid, soft, {.length = 6e-3, .width = 3e-3, .closingForce = 0.02, .stiffness = 500.0});
    double fastest = 0.0;
    for (int i = 0; i < 400; ++i) {
        stage.step(kStep);
        fastest = std::max(fastest, length(momentum(stage)));
    }
    const double mass = 1000.0 * 3e-3 * 4e-3 * 6e-3;
    CHECK(fastest < 1e-4 * mass); // [m/s] times mass: it closes with 20 mm/s
}

TEST_CASE("a clip closes a soft tube down to its gap, with less force than it bears")
{
    Stage stage;
    const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody());
    apply(stage, rigid, soft, {});
    const StepReport all = stage.run(800, kStep);
    CHECK(report(stage).gap < 0.45e-3);
    CHECK(report(stage).force > 0.1);
    CHECK(report(stage).force < 5.0);
    CHECK_FALSE(all.has(StepFlag::Undone));
    CHECK(report(stage).tissue == soft);
    CHECK(report(stage).clip == rigid);
    // The tissue between the legs is flat.
    const Clip& clip = stage.soft().clips.front();
    for (const ClipPair& each : clip.pairs)
        CHECK(distance(meanOf(each[0], stage.soft().x), meanOf(each[1], stage.soft().x)) < 1.1e-3); // the tube has 4 mm
}

TEST_CASE("a clip bears twice mu times the force of its legs, and slips off if it is pulled harder")
{
    Stage stage;
    const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody());
    apply(stage, rigid, soft, {.friction = 0.25});
    stage.run(800, kStep);
    double bears = 0.0, pull = 0.0;
    int slipped = 0;
    for (int i = 0; i < 6000 && slipped == 0; ++i) {
        bears = 2.0 * 0.25 * report(stage).force;
        pull = 1e-3 * i;
        stage.post(SetWrench{rigid, 0, {0, 0, pull}, {}});
        slipped += stage.step(kStep).clips.slipped;
    }
    CHECK(pull == Approx(bears).epsilon(0.1)); // the tube still moves
    CHECK(bears > 0.05);                       // at rest; a shaking clip once seemed to press with 1 to 4 N
    stage.run(100, kStep);
    CHECK(slipped == 1);
    CHECK(stage.world.scene().clipReports.empty());
    CHECK(stage.soft().clips.empty());
    CHECK(stage.world.scene().rigid.front().state.poses.front().position.z > 10e-3); // it flies off
}

TEST_CASE("a clip with nothing between its legs is told, and does nothing")
{
    Stage stage;
    const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody({0, 20e-3, 0}));
    apply(stage, rigid, soft, {});
    const StepReport step = stage.step(kStep);
    CHECK(step.clips.missed == 1);
    CHECK(step.has(StepFlag::NothingAttached));
    CHECK(stage.soft().clips.empty());
    CHECK(stage.world.scene().attachments.empty());
}

TEST_CASE("release opens a clip, and so does a reset")
{
    for (const bool reset : {false, true}) {
        Stage stage;
        const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody());
        const AttachmentId id = apply(stage, rigid, soft, {});
        stage.run(500, kStep);
        REQUIRE(stage.soft().clips.size() == 1);
        reset ? stage.post(Reset{}) : stage.post(Release{id});
        const StepReport step = stage.step(kStep);
        CHECK(step.clips.slipped == 0);
        CHECK(stage.soft().clips.empty());
        CHECK(stage.world.scene().clipReports.empty());
        CHECK(stage.world.scene().attachments.empty());
        stage.run(2000, kStep);
        double farthest = 0.0;
        for (std::size_t i = 0; i < stage.soft().x.size(); ++i)
            farthest = std::max(farthest, distance(stage.soft().x[i], stage.model().rest[i]));
        CHECK(farthest < 0.1e-3); // the tissue is as it was
    }
}

TEST_CASE("a clip hangs at the corners of its legs, and on what there is")
{
    for (const double x : {0.0, 10.3e-3}) { // in the middle, and with one of its three lines on the tube's end
        Stage stage;
        const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody({x, 0, 0}));
        apply(stage, rigid, soft, {});
        stage.step(kStep);
        REQUIRE(stage.world.scene().attachments.size() == 1);
        const AttachedPairs& hold = stage.world.scene().attachments.front().pairs;
        Vec3 sum, most;
        for (const auto& [on, at] : hold) {
            sum += on.place;
            most = {std::max(most.x, on.place.x), 0, std::max(most.z, on.place.z)};
        }
        CHECK(std::abs(sum.z) < 1e-6);
        CHECK(most.z > 1.2e-3);
        CHECK(hold.size() == (x == 0.0 ? 4 : 2));
        if (x == 0.0) CHECK(std::abs(sum.x) < 1e-6);
        if (x == 0.0) CHECK(most.x == Approx(0.4e-3));
    }
}

TEST_CASE("a clip without friction closes, and slips off at the least pull")
{
    Stage stage;
    const BodyId soft = stage.add(duct()), rigid = stage.add(clipBody());
    apply(stage, rigid, soft, {.friction = 0.0});
    int slipped = 0;
    for (int i = 0; i < 20; ++i) {
        const StepReport step = stage.step(kStep);
        checkAttachments(stage.world.scene()); // its attachment bears something as long as it is there
        slipped += step.clips.slipped;
        CHECK(step.clips.applied == (i == 0 ? 1 : 0));
    }
    CHECK(slipped == 1);
    CHECK(stage.soft().clips.empty());
}

TEST_CASE("if a piece of the tissue in a clip is removed, it holds the rest, and is lost with the last of it")
{
    for (const bool rest : {true, false}) {
        Stage stage;
        const BodyId soft = stage.add(twoBlocks()), rigid = stage.add(clipBody({rest ? 0.0 : 2e-3, 0, 0}));
        const double width = rest ? 6e-3 : 1e-3;
        apply(stage, rigid, soft, {.length = 5e-3, .width = width, .closingForce = 0.02, .stiffness = 500.0});
        stage.run(20, kStep);
        REQUIRE(stage.soft().clips.size() == 1);
        const std::size_t pairs = stage.soft().clips.front().pairs.size();
        stage.post(RemovePiece{soft, 1});
        const StepReport step = stage.step(kStep);
        CHECK(step.topology.noPiece == 0);
        CHECK(step.clips.slipped == (rest ? 0 : 1));
        CHECK(stage.world.scene().attachments.size() == (rest ? 1 : 0));
        CHECK(stage.world.scene().clipReports.size() == (rest ? 1 : 0));
        REQUIRE(stage.soft().clips.size() == (rest ? 1 : 0));
        if (!rest) continue;
        CHECK(2 * stage.soft().clips.front().pairs.size() == pairs);
        CHECK(stage.run(200, kStep).flags == 0);
        CHECK(report(stage).place.x < -1e-3);
        CHECK(stage.world.scene().attachments.size() == 1);
    }
}

TEST_CASE("a clip that is closed drives nothing: what moves on beside it is restless")
{
    Stage stage;
    const BodyId soft = stage.add(block()), rigid = stage.add(clipBody());
    RigidBodyDef top{.name = "top", .elements = {Pose{{1, 0, 0}, {}}}, .mesh = shapes::box({0.1, 0.1, 0.1})};
    top.dynamic = true;
    top.gravity = false;
    top.angularVelocity = {0, 0, 1.0};
    stage.add(top);
    apply(stage, rigid, soft, {.length = 6e-3, .width = 3e-3, .closingForce = 0.02, .stiffness = 500.0});
    stage.run(1000, 5e-3);
    CHECK(report(stage).closed);
    CHECK(stage.soft().clips.front().age == 0.3);
    CHECK(stage.run(600, 5e-3).has(StepFlag::Restless));
}

TEST_CASE("two clips close the same tube, and are part of hash and saved state")
{
    Stage stage;
    const BodyId soft = stage.add(duct());
    const BodyId one = stage.add(clipBody({-3e-3, 0, 0})), two = stage.add(clipBody({3e-3, 0, 0}));
    stage.run(10, kStep);
    apply(stage, one, soft, {});
    stage.run(200, kStep);
    const auto saved = stage.world.save();
    const std::uint64_t hash = stage.world.hash();
    const auto finish = [&] {
        stage.post(ApplyClip{AttachmentId{50}, two, soft, {}});
        stage.run(600, kStep);
        CHECK(stage.world.scene().clipReports.size() == 2);
        return stage.world.hash();
    };
    const std::uint64_t end = finish();
    stage.world.restore(*saved);
    CHECK(stage.world.hash() == hash);
    Scene other = stage.world.scene();
    const auto changes = [&](auto& value, auto by) {
        value += by;
        const bool does = hashOf(other) != hash;
        value -= by;
        return does;
    };
    Clip& clip = other.soft.front().state.clips.front();
    clip.gap *= 2.0;
    CHECK(hashOf(other) != hash);
    clip.gap *= 0.5;
    CHECK(hashOf(other) == hash);
    CHECK(changes(clip.pairs.front()[0].front().node, 1));
    CHECK(changes(clip.pairs.front()[1].front().weight, 0.25));
    CHECK(changes(clip.def.closingForce, 1.0));
    CHECK(finish() == end);
    CHECK(report(stage, 0).gap < 0.45e-3);
    CHECK(report(stage, 1).gap < 0.45e-3);
}

TEST_CASE("what a clip cannot be put on is one clear Error")
{
    PhysicsServer server(std::make_unique<World>(NativeEngineDef{.threads = 1}));
    const BodyId soft = server.add(duct()), rigid = server.add(clipBody());
    SoftBodyDef exact = duct();
    exact.name = "exact";
    exact.solver = Cholesky{};
    const BodyId other = server.add(exact);
    RigidBodyDef fixed = clipBody();
    fixed.name = "fixed";
    fixed.dynamic = false;
    fixed.mass = {};
    const BodyId kinematic = server.add(fixed);
    const auto problem = [&](BodyId clip, BodyId tissue, const ClipDef& def) -> std::string {
        try {
            server.clip(clip, tissue, def);
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    CHECK(problem(soft, soft, {}) == "soft body 'duct': must be a rigid body to be a clip");
    CHECK(problem(rigid, rigid, {}) == "rigid body 'clip': must be a soft body to be clipped");
    CHECK(problem(kinematic, soft, {}) == "rigid body 'fixed': clip must be a dynamic body; it is kinematic");
    CHECK(problem(rigid, other, {}) == "soft body 'exact': clips need integrator ImplicitEuler and the default solver");
    CHECK(problem(rigid, soft, {.element = 1}) == "rigid body 'clip': clip.element must be in [0, 1), got 1");
    CHECK(problem(rigid, soft, {.opening = 0.3e-3}) ==
          "rigid body 'clip': clip.opening must be > gap, 4e-04 m, got 3e-04");
    CHECK(problem(rigid, soft, {.closingForce = 0.0}).find("closingForce must be in (0, 10000]") != std::string::npos);
    CHECK(problem(rigid, BodyId{99}, {}) == "body 99: no such body (it was never added)");
    CHECK(problem(rigid, soft, {}) == "none");
}

} // namespace clips_test

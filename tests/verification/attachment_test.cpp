#include "verification/attached.h"

namespace attachment_test {

using namespace filasofia;
using namespace filasofia::engine;

TEST_CASE("a hanging body's pins bear its weight and do not move, whatever solves it")
{
    struct Kind {
        const char* name;
        physics::SoftMaterial material;
        physics::Integrator integrator;
        physics::Solver solver;
    };
    const physics::FemMaterial fem{.youngModulus = 5e4, .poissonRatio = 0.3};
    const physics::MassSpringMaterial springs{.stiffness = 200.0, .damping = 0.1};
    const physics::ImplicitEuler implicit;
    const physics::ConjugateGradient cg;
    const Kind kinds[] = {{"matrix-free", fem, implicit, cg},
                          {"Cholesky", fem, implicit, physics::Cholesky{}},
                          {"mass-spring", springs, implicit, cg},
                          {"explicit", fem, physics::ExplicitEuler{.symplectic = true}, cg}};
    for (const Kind& kind : kinds) {
        const double dt = std::holds_alternative<physics::ExplicitEuler>(kind.integrator) ? 1e-4 : 2e-3;
        Stage stage = withGravity();
        physics::SoftBodyDef def = beam({6, 2, 2}, {0.06, 0.02, 0.02});
        def.material = kind.material;
        def.integrator = kind.integrator;
        def.solver = kind.solver;
        def.rayleigh = {.mass = 4.0, .stiffness = 2e-3};
        if (dt < 1e-3) def.rayleigh = {.mass = 20.0, .stiffness = 0.0};
        def.attachments = {{.box = kLeft}};
        stage.add(def);
        stage.run(static_cast<int>(std::lround(2.0 / dt)), dt);
        const double weight = weightOf(stage, 0);
        const frame::Attachment& pins = attachmentOf(stage, {1});
        CHECK(pins.points == 9);
        verify(text("hanging beam, ", kind.name, ": reaction of its pins over its weight, minus one"),
               length(pins.force - Vec3{0, weight, 0}) / weight, 0.01);
        for (int node : nodesWhere(*std::get<1>(def.mesh), [](Vec3 p) { return p.x < 1e-6; }))
            CHECK(distance(stage.soft().x[static_cast<std::size_t>(node)],
                           stage.model().rest[static_cast<std::size_t>(node)]) <= 1e-9);
    }
}

TEST_CASE("pins bear in every step what the body's momentum lacks of its weight")
{
    physics::FemMaterial fibres{.youngModulus = 5e4, .poissonRatio = 0.3};
    fibres.fibres = {{.stiffness = 2e4}};
    physics::FemMaterial relaxing{.youngModulus = 5e4, .poissonRatio = 0.3};
    relaxing.relaxation = {{.share = 0.4, .time = 0.05}};
    const std::pair<const char*, physics::SoftMaterial> kinds[] = {
        {"neo-Hookean", physics::FemMaterial{.youngModulus = 5e4, .poissonRatio = 0.45}},
        {"corotational",
         physics::FemMaterial{.youngModulus = 5e4, .poissonRatio = 0.3, .law = physics::Corotational{}}},
        {"nearly incompressible", physics::FemMaterial{.youngModulus = 5e4, .poissonRatio = 0.4999}},
        {"with fibres", fibres},
        {"relaxing", relaxing},
        {"mass-spring", physics::MassSpringMaterial{.stiffness = 200.0, .damping = 0.1}}};
    for (const auto& [name, material] : kinds) {
        constexpr double dt = 5e-3;
        Stage stage = withGravity();
        physics::SoftBodyDef def = beam({6, 2, 2}, {0.06, 0.02, 0.02});
        def.material = material;
        def.solver = physics::ConjugateGradient{.tolerance = 1e-6};
        def.rayleigh = {.mass = 0.0, .stiffness = 1e-3};
        def.attachments = {{.box = kLeft}};
        stage.add(def);
        Vec3 before;
        double worst = 0.0, farthest = 0.0;
        for (int i = 0; i < 100; ++i) {
            stage.step(dt);
            const double weight = weightOf(stage, 0);
            Vec3 momentum;
            for (std::size_t n = 0; n < stage.soft().v.size(); ++n)
                momentum += stage.model().masses[n] * stage.soft().v[n];
            const Vec3 change = 1.0 / dt * (momentum - before);
            farthest = std::max(farthest, length(change) / weight);
            worst = std::max(worst, length(change - attachmentOf(stage, {1}).force + Vec3{0, weight, 0}) / weight);
            before = momentum;
        }
        CHECK(farthest > 0.3); // it swings
        verify(text("falling beam, ", name, ": largest imbalance of its momentum, over its weight"), worst,
               std::string_view(name) == "nearly incompressible" ? 5e-3 : 1e-5); // float has no more digits there
    }
}

TEST_CASE("nodes pinned at run time stay where they were, and bear the weight")
{
    Stage stage = withGravity();
    stage.add(beam({6, 2, 2}, {0.06, 0.02, 0.02}));
    stage.post(physics::Attach{{1}, {1}, {.box = kLeft}});
    double worst = 0.0;
    for (int i = 0; i < 3000; ++i) {
        stage.step(1e-3);
        worst = std::max(worst, worstGap(stage));
    }
    const double weight = weightOf(stage, 0);
    verify("falling beam, pinned at run time: largest distance of a node from its place during the fall [m]", worst,
           1e-5);
    verify("beam pinned at run time, at rest: largest distance of a node from its place [m]", worstGap(stage), 1e-6);
    verify("beam pinned at run time: reaction over its weight, minus one",
           length(attachmentOf(stage, {1}).force - Vec3{0, weight, 0}) / weight, 0.01);
}

TEST_CASE("a spring extends as far as its stiffness says")
{
    const double k = 50.0;
    Stage stage = withGravity();
    physics::RigidBodyDef box = rigidBox("box", {0.02, 0.02, 0.02}, {});
    box.attachments = {{.points = {{0, 0.02, 0}}, .stiffness = k}};
    stage.add(box);
    stage.run(2000, 5e-3);
    const double weight = 0.064 * kG;
    const double fell = -stage.world.scene().rigid[0].state.poses[0].position.y;
    verify("box on a spring: k x over its weight, minus one", std::abs(k * fell / weight - 1.0), 0.01);
    verify("box on a spring: reported force over k x, minus one",
           std::abs(attachmentOf(stage, {1}).force.y / (k * fell) - 1.0), 0.01);

    Stage soft = withGravity();
    physics::SoftBodyDef def = beam({3, 2, 2}, {0.03, 0.02, 0.02});
    def.attachments = {{.box = kLeft, .stiffness = 20.0}};
    soft.add(def);
    soft.run(4000, 1e-3);
    verify("beam on pin springs: reported force over its weight, minus one",
           std::abs(attachmentOf(soft, {1}).force.y / weightOf(soft, 0) - 1.0), 0.01);
}

TEST_CASE("two blocks whose meshes do not match transmit pull and twist")
{
    for (const bool twist : {false, true}) {
        Stage stage;
        physics::SoftBodyDef left = beam({4, 3, 3}, {0.04, 0.03, 0.03}),
                             right = beam({5, 2, 4}, {0.04, 0.03, 0.03}, 0.038);
        left.attachments = {{.box = kLeft}};
        right.attachments = {{.to = {1}}}; // attached to the nodes inside the other block
        const Vec3 axis{0.0, 0.015, 0.015};
        Wrench applied;
        for (int node : nodesWhere(*std::get<1>(right.mesh), [](Vec3 p) { return p.x > 0.0399; })) {
            const Vec3 arm = std::get<1>(right.mesh)->nodes[static_cast<std::size_t>(node)] - axis;
            const Vec3 force = twist ? 4.0 * Vec3{0.0, -arm.z, arm.y} : Vec3{0.02, 0.0, 0.0};
            right.forces.push_back({node, force});
        }
        stage.add(left);
        stage.add(right);
        int highest = 0;
        for (int i = 0; i < 2500; ++i) highest = std::max(highest, stage.step(2e-3).solves[0].iterations);
        for (const physics::NodalForce& each : right.forces) {
            applied.force += each.force;
            applied.torque += cross(stage.soft(1).x[static_cast<std::size_t>(each.node)], each.force);
        }
        const Wrench handed = wrenchOf(stage, {2});
        CHECK(attachmentOf(stage, {2}).points >= 15);
        if (twist) {
            tell("two blocks twisted by [N m]", applied.torque.x);
            verify("two blocks twisted: transmitted torque over the applied torque, minus one",
                   std::abs(-handed.torque.x / applied.torque.x - 1.0), 0.01);
        } else {
            verify("two blocks pulled: transmitted force over the applied force, minus one",
                   length(handed.force + applied.force) / length(applied.force), 0.01);
            verify("two blocks pulled: reaction of the pins over the applied force, minus one",
                   length(attachmentOf(stage, {1}).force + applied.force) / length(applied.force), 0.01);
        }
        tell(text("two blocks ", twist ? "twisted" : "pulled", ": largest number of iterations per step"), highest);
        verify(text("two blocks ", twist ? "twisted" : "pulled", ": largest gap [m]"), worstGap(stage), 1e-6);
    }
}

TEST_CASE("a rigid box hangs from a soft beam with its weight")
{
    Stage stage = withGravity();
    physics::SoftBodyDef def = beam({4, 2, 2}, {0.04, 0.02, 0.02});
    def.attachments = {{.box = kLeft}};
    def.rayleigh = {.mass = 4.0, .stiffness = 0.01};
    stage.add(def);
    physics::RigidBodyDef box = rigidBox("box", {0.01, 0.01, 0.01}, {0.05, 0.01, 0.01});
    stage.add(box);
    stage.post(physics::Attach{{2}, {1}, {.within = 1e-4, .to = {2}}});
    stage.run(2000, 2e-3);
    const double weight = 8e-6 * 1000 * kG;
    CHECK(attachmentOf(stage, {2}).points == 9);
    verify("rigid box on a soft beam: force of its attachment over its weight, minus one",
           length(attachmentOf(stage, {2}).force + Vec3{0, weight, 0}) / weight, 0.01);
    verify("rigid box on a soft beam: reaction of the beam's pins over the weight of both, minus one",
           length(attachmentOf(stage, {1}).force - Vec3{0, weight + weightOf(stage, 0), 0}) /
               (weight + weightOf(stage, 0)),
           0.01);
    verify("rigid box on a soft beam: largest gap [m]", worstGap(stage), 1e-6);
}

TEST_CASE("a rod that hangs from a point swings with the theoretical period")
{
    const Vec3 half{0.005, 0.1, 0.005};
    Stage stage = withGravity();
    physics::RigidBodyDef rod = rigidBox("rod", half, {});
    const double tilt = 0.02;
    const Vec3 hinge{0, 0.1, 0};
    rod.elements = {Pose{rotate(axisAngle({0, 0, 1}, tilt), -hinge), axisAngle({0, 0, 1}, tilt)}};
    rod.attachments = {{.points = {hinge}}};
    stage.add(rod);
    const double d = 0.1, about = (4.0 * half.x * half.x + 4.0 * half.y * half.y) / 12.0 + d * d;
    const double period = 2.0 * std::numbers::pi * std::sqrt(about / (kG * d));
    double worst = 0.0, first = 0.0, last = 0.0, before = 0.0;
    int crossings = 0;
    const double dt = 2.5e-4;
    for (int i = 0; i < static_cast<int>(5.2 * period / dt); ++i) {
        stage.step(dt);
        worst = std::max(worst, worstGap(stage));
        const double x = stage.world.scene().rigid[0].state.poses[0].position.x;
        if (i > 0 && before > 0.0 && x <= 0.0) {
            last = dt * (i - x / (x - before));
            if (crossings++ == 0) first = last;
        }
        before = x;
    }
    REQUIRE(crossings >= 5);
    verify("rod on a point: period over theory, minus one", std::abs((last - first) / (crossings - 1) / period - 1.0),
           0.005);
    verify("rod on a point: largest distance of the point from its place [m]", worst, 1e-6);
}

TEST_CASE("boxes welded to each other and to space stand like a cantilever")
{
    Stage stage = withGravity();
    const Vec3 half{0.02, 0.01, 0.01};
    for (int k = 0; k < 4; ++k) {
        physics::RigidBodyDef box = rigidBox(text("box ", k), half, {0.04 * k, 0, 0});
        box.attachments = {{.to = BodyId{static_cast<std::uint32_t>(k)}}}; // the first box is attached to space
        stage.add(box);
    }
    double worst = 0.0;
    for (int i = 0; i < 3000; ++i) {
        stage.step(1e-3);
        worst = std::max(worst, worstGap(stage));
    }
    const double weight = 8 * half.x * half.y * half.z * 1000 * kG;
    for (std::uint32_t k = 0; k < 4; ++k)
        CHECK(length(attachmentOf(stage, {k + 1}).force - Vec3{0, (4 - k) * weight, 0}) < 0.01 * weight);
    const Wrench atRoot = wrenchOf(stage, {1});
    verify("four welded boxes: moment at the root over theory, minus one",
           std::abs(atRoot.torque.z / (4 * weight * 0.06) - 1.0), 0.01);
    verify("four welded boxes: largest gap after the start [m]", worst, 1e-5);
    verify("four welded boxes: largest gap at rest [m]", worstGap(stage), 1e-6);
}

TEST_CASE("a ring of hard attachments holds, and its forces do not grow")
{
    Stage stage = withGravity();
    const Vec3 half{0.01, 0.01, 0.01};
    for (int k = 0; k < 3; ++k) {
        physics::RigidBodyDef box = rigidBox(text("box ", k), half, {0.02 * k, k == 1 ? 0.01 : 0.0, 0});
        box.attachments = {{.to = BodyId{static_cast<std::uint32_t>(k)}}};
        stage.add(box);
    }
    stage.post(physics::AttachRigid{{4}, {1}, {.to = {3}}}); // closes the ring
    stage.run(2000, 1e-3);
    const double after2 = length(attachmentOf(stage, {4}).force);
    stage.run(8000, 1e-3);
    const double weight = 8e-6 * 1000 * kG;
    CHECK(length(attachmentOf(stage, {1}).force - Vec3{0, 3 * weight, 0}) < 0.01 * weight);
    verify("three boxes in a ring of hard attachments: force that closes it after 10 s over that after 2 s, minus one",
           std::abs(length(attachmentOf(stage, {4}).force) / after2 - 1.0), 0.01);
    verify("three boxes in a ring of hard attachments: largest gap [m]", worstGap(stage), 1e-6);
}

TEST_CASE("attachments come out the same for any number of threads")
{
    std::vector<std::uint64_t> hashes;
    for (int threads : {1, 2, 8}) {
        Stage stage({.threads = threads});
        stage.post(physics::SetGravity{{0, -kG, 0}});
        physics::SoftBodyDef left = beam({12, 6, 6}, {0.04, 0.03, 0.03}), // large enough for threads to share it
            right = beam({6, 4, 7}, {0.04, 0.03, 0.03}, 0.038);
        left.attachments = {{.box = kLeft}};
        right.attachments = {{.to = {1}}};
        stage.add(left);
        stage.add(right);
        physics::RigidBodyDef box = rigidBox("box", {0.01, 0.01, 0.01}, {0.09, 0.01, 0.01});
        box.attachments = {{.stiffness = 100.0, .to = {2}}};
        stage.add(box);
        stage.run(100, 1e-3);
        CHECK((threads == 1 || threadsShare(stage, threads)));
        hashes.push_back(stage.world.hash());
    }
    for (std::uint64_t hash : hashes) CHECK(hash == hashes.front());
}

} // namespace attachment_test

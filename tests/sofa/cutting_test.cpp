#include "sofa/sofa_stage.h"

#include "filasofia/frame/topology_edit.h"

#include <algorithm>
#include <cmath>
#include <map>

/// Cuts by told blades on both engines, and what follows a cut in SOFA's.
namespace cutting_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

constexpr double kStep = 2e-3;  // [s]
constexpr double kDeep = 0.015; // [m] below where the bar is

/// A bar along x, held at its low end, 30 x 10 x 10 mm.
SoftBodyDef barDef(const Solver& solver = ConjugateGradient{.tolerance = 1e-8})
{
    return {.name = "bar",
            .mesh = bar(9, 3, 3, {0.03, 0.01, 0.01}),
            .material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4, .law = Corotational{}},
            .rayleigh = {.mass = 1.0, .stiffness = 1e-3},
            .solver = solver,
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
            .dynamicTopology = true};
}
/// A sheet across the bar, whose outline cuts. Its origin is at its lower edge.
RigidBodyDef bladeDef(int group = 0)
{
    const geometry::TriangleMesh sheet{.vertices = {{0, 0, -0.01}, {0, 0, 0.02}, {0, 0.03, 0.02}, {0, 0.03, -0.01}},
                                       .triangles = {{0, 1, 2}, {0, 2, 3}},
                                       .uv = {}};
    return {.name = "blade",
            .elements = {{{0.0155, 0.012, 0}, {}}},
            .collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(sheet),
                           .proximity = 0.0,
                           .group = group,
                           .cutting = true}}};
}

struct Cut {
    std::unique_ptr<PhysicsServer> server;
    BodyId body, blade;
    std::vector<Rupture> ruptures = {};
    TopologyReport counts = {};
    std::uint32_t flags = 0;

    explicit Cut(const std::string& engine, const SoftBodyDef& def = barDef(), Vec3 gravity = {})
        : server(serverWith(engine, kStep, gravity)), body(server->add(def)), blade(server->add(bladeDef()))
    {
        step();
    }
    StepReport step()
    {
        StepReport report = server->step(kStep);
        for (const Rupture& each : report.topology.ruptures) ruptures.push_back(each);
        counts.bladeTooFast += report.topology.bladeTooFast;
        counts.bladeOff += report.topology.bladeOff;
        counts.noPiece += report.topology.noPiece;
        flags |= report.flags;
        return report;
    }
    void run(int count)
    {
        for (int i = 0; i < count; ++i) step();
    }
    /// Moves the blade's edge at x from a height to another, in steps.
    void stroke(double x, double from, double to, int count = 40)
    {
        for (int i = 1; i <= count; ++i) {
            server->setPose(blade, {{x, from + (to - from) * i / count, 0}, {}});
            step();
        }
    }
    void through(double x = 0.0155)
    {
        server->setPose(blade, {{x, 0.012, 0}, {}});
        step();
        stroke(x, 0.012, -kDeep);
    }
    [[nodiscard]] double area() const
    {
        double sum = 0.0;
        for (const Rupture& each : ruptures) sum += each.area;
        return sum;
    }
    [[nodiscard]] std::vector<LoosePiece> detached() const
    {
        std::vector<LoosePiece> all;
        for (const Rupture& each : ruptures) all.insert(all.end(), each.detached.begin(), each.detached.end());
        return all;
    }
    [[nodiscard]] frame::SoftBodyFrame frame() const { return *server->latest()->softBody(body); }
};

/// Each edge of the boundary has two faces, in opposite directions.
bool isClosed(const frame::Boundary& boundary)
{
    std::map<std::array<int, 2>, int> uses;
    for (const geometry::Triangle& t : boundary.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            uses[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    return std::ranges::all_of(uses, [](const auto& each) { return each.second == 0; });
}

double meanHeight(const frame::SoftBodyFrame& body, double beyond)
{
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < body.positions.size(); ++i)
        if (body.boundary->rest[i].x > beyond) {
            sum += body.positions[i].y;
            ++count;
        }
    return sum / count;
}

} // namespace

TEST_CASE("a blade cuts a bar of SOFA's into the same pieces as one of ours")
{
    Cut native("native"), sofa("sofa");
    native.through();
    sofa.through();
    REQUIRE(sofa.ruptures.size() == native.ruptures.size());
    for (std::size_t i = 0; i < sofa.ruptures.size(); ++i) {
        CHECK(sofa.ruptures[i].nodes == native.ruptures[i].nodes);
        CHECK(sofa.ruptures[i].elements == native.ruptures[i].elements);
        CHECK(sofa.ruptures[i].area == Approx(native.ruptures[i].area).epsilon(1e-4)); // ours multiplies in float
        CHECK(length(sofa.ruptures[i].place - native.ruptures[i].place) < 1e-7);
    }
    CHECK(sofa.area() == Approx(1e-4).epsilon(0.05)); // of the bar's cross-section
    const auto loose = sofa.detached(), theirs = native.detached();
    REQUIRE(loose.size() == 1);
    REQUIRE(theirs.size() == 1);
    CHECK(loose[0].elements.size() == theirs[0].elements.size()); // ours numbers them along a curve
    CHECK(loose[0].mass == Approx(theirs[0].mass).epsilon(1e-4));
    CHECK_FALSE(loose[0].held);
    const frame::SoftBodyFrame body = sofa.frame(), other = native.frame();
    REQUIRE(body.positions.size() == other.positions.size());
    for (std::size_t i = 0; i < body.positions.size(); ++i)
        REQUIRE(length(body.positions[i] - other.positions[i]) < 1e-7);
    CHECK(body.boundary->triangles.size() == other.boundary->triangles.size());
    CHECK(std::ranges::count(body.boundary->opened, 1) == std::ranges::count(other.boundary->opened, 1));
    CHECK(isClosed(*body.boundary));
    CHECK(sofa.flags == 0);
}

TEST_CASE("a piece that was cut off falls freely, and what is left stays", "[slow]")
{
    const Solver solver = GENERATE(as<Solver>(), ConjugateGradient{.tolerance = 1e-8},
                                   ConjugateGradient{.tolerance = 1e-6, .assembled = true}, Cholesky{});
    const ElasticLaw law = GENERATE(as<ElasticLaw>(), Corotational{}, NeoHookean{});
    SoftBodyDef def = barDef(solver);
    std::get<FemMaterial>(def.material).law = law;
    def.rayleigh.mass = 0.0;
    Cut cut("sofa", def);
    cut.through();
    REQUIRE(cut.detached().size() == 1);
    const double before = meanHeight(cut.frame(), 0.016), left = meanHeight(cut.frame(), 0.005);
    cut.server->setGravity({0, -9.81, 0});
    cut.run(50);
    const double t = 50 * kStep;
    CHECK(meanHeight(cut.frame(), 0.016) - before == Approx(-9.81 * t * (t + kStep) / 2).epsilon(1e-3));
    CHECK(left - meanHeight(cut.frame(), 0.005) < 0.03);
    CHECK((cut.flags & static_cast<std::uint32_t>(StepFlag::Undone)) == 0);
}

TEST_CASE("a cut conserves mass and momentum")
{
    SoftBodyDef def = barDef(Cholesky{});
    def.attachments = {};
    def.rayleigh = {.mass = 0.0, .stiffness = 0.0};
    Cut cut("sofa", def);
    const auto motion = [&] { // all nodes move alike, and go on so if masses and momenta are right
        const frame::SoftBodyFrame body = cut.frame();
        const Vec3 first = body.velocities[0];
        double apart = 0.0;
        for (const Vec3 v : body.velocities) apart = std::max(apart, length(v - first));
        return std::pair{first, apart};
    };
    cut.server->setGravity({0, 0, -9.81});
    cut.run(10);
    cut.server->setGravity({});
    cut.step();
    const Vec3 before = motion().first;
    cut.through();
    REQUIRE(cut.detached().size() == 1);
    CHECK(length(motion().first - before) < 1e-9 * length(before));
    CHECK(motion().second < 1e-9 * length(before));
}

TEST_CASE("a reset makes a cut body whole, and a saved state brings the cut back")
{
    Cut cut("sofa");
    const auto start = cut.server->save();
    cut.through();
    const auto after = cut.server->save();
    const frame::SoftBodyFrame then = cut.frame();
    cut.server->setGravity({0, -9.81, 0});
    cut.run(5);
    const auto further = cut.frame();
    SECTION("reset")
    {
        cut.server->reset();
        cut.server->setGravity({});
        cut.step();
        CHECK(cut.frame().positions.size() == 10 * 4 * 4);
        CHECK(cut.frame().boundary->revision == 0);
        const std::size_t before = cut.ruptures.size();
        cut.server->setPose(cut.blade, {{0.0155, 0.012, 0}, {}});
        cut.step();
        cut.through(); // and it is cut again, in the same way
        std::size_t elements = 0;
        for (std::size_t i = before; i < cut.ruptures.size(); ++i) elements += cut.ruptures[i].elements;
        std::size_t first = 0;
        for (std::size_t i = 0; i < before; ++i) first += cut.ruptures[i].elements;
        CHECK(elements == first);
    }
    SECTION("back to the cut, after more")
    {
        cut.through(0.0255);
        CHECK(cut.frame().positions.size() > then.positions.size());
        cut.server->restore(*after);
        CHECK(cut.frame().positions == then.positions);
        CHECK(cut.frame().boundary->triangles == then.boundary->triangles);
        cut.server->setGravity({0, -9.81, 0});
        cut.run(5);
        for (std::size_t i = 0; i < further.positions.size(); ++i)
            REQUIRE(length(cut.frame().positions[i] - further.positions[i]) < 1e-9);
    }
    SECTION("back to the start, and on to the cut")
    {
        cut.server->restore(*start);
        CHECK(cut.frame().positions.size() == 160);
        cut.server->step(kStep);
        cut.server->restore(*after);
        CHECK(cut.frame().positions == then.positions);
    }
}

TEST_CASE("a state in the middle of a stroke goes on as it did")
{
    Cut cut("sofa");
    cut.stroke(0.0155, 0.012, 0.005, 10);
    const auto half = cut.server->save();
    cut.stroke(0.0155, 0.005, -kDeep, 20);
    const frame::SoftBodyFrame once = cut.frame();
    cut.server->restore(*half);
    cut.stroke(0.0155, 0.005, -kDeep, 20);
    CHECK(cut.frame().positions == once.positions);
    CHECK(cut.frame().boundary->triangles == once.boundary->triangles);
}

TEST_CASE("a piece can be removed, and what falls for ever is")
{
    Cut cut("sofa");
    cut.through();
    REQUIRE(cut.detached().size() == 1);
    SECTION("removed")
    {
        const std::size_t faces = cut.frame().boundary->triangles.size();
        cut.server->removePiece(cut.body, cut.detached()[0].piece);
        cut.server->setGravity({0, -9.81, 0});
        cut.step();
        const frame::SoftBodyFrame body = cut.frame();
        CHECK(body.boundary->triangles.size() < faces);
        CHECK(isClosed(*body.boundary));
        cut.run(20);
        const frame::SoftBodyFrame later = cut.frame();
        for (std::size_t i = 0; i < body.positions.size(); ++i) // its nodes stay where they are
            if (body.boundary->rest[i].x > 0.016) REQUIRE(later.positions[i] == body.positions[i]);
        CHECK(meanHeight(later, -1.0) < meanHeight(body, -1.0));
        cut.server->removePiece(cut.body, 0); // all that is left
        cut.server->removePiece(cut.body, 77);
        cut.step();
        CHECK(cut.counts.noPiece == 2);
        cut.server->reset();
        cut.step();
        CHECK(cut.frame().boundary->triangles.size() == 2 * (2 * 9 + 4 * 27));
    }
    SECTION("lost")
    {
        cut.server->setGravity({0, -2000, 0});
        int lost = 0;
        for (int i = 0; i < 80; ++i) lost += cut.step().topology.lost;
        CHECK(lost == 1);
        for (const Vec3 each : cut.frame().positions) REQUIRE(length(each) < 50.0);
    }
}

TEST_CASE("pins, material, loads and ties follow a cut")
{
    SoftBodyDef def = barDef(Cholesky{});
    def.attachments.push_back({.box = geometry::Box{{0.0299, -1, -1}, {1, 1, 1}}, .stiffness = 50.0});
    Cut cut("sofa", def);
    const BodyId holder = cut.server->add(RigidBodyDef{.name = "holder"});
    cut.server->step(kStep);
    const AttachmentId tie =
        cut.server->attach(cut.body, {.box = geometry::Box{{0.0199, 0.0099, -1}, {0.0234, 1, 1}}, .to = holder});
    cut.step();
    const auto force = [&] { // of the tie, which holds the piece beside the springs
        for (const frame::Attachment& each : cut.server->latest()->attachments)
            if (each.id == tie) return each.force;
        return Vec3{};
    };
    cut.through();
    REQUIRE(cut.detached().size() == 1);
    CHECK(cut.detached()[0].held); // by springs
    cut.server->setGravity({0, -9.81, 0});
    cut.run(300);
    // The piece hangs on the weld and the springs: together they carry it.
    double springs = 0.0;
    const frame::SoftBodyFrame body = cut.frame();
    for (std::size_t i = 0; i < 160; ++i)
        if (body.boundary->rest[i].x > 0.0299) springs += 50.0 * (body.boundary->rest[i].y - body.positions[i].y);
    CHECK(force().y + springs == Approx(9.81 * cut.detached()[0].mass).epsilon(0.01));
    SECTION("a softer material sags more")
    {
        const double before = meanHeight(body, 0.005);
        auto material = std::get<FemMaterial>(def.material);
        material.youngModulus = 5e3;
        cut.server->setMaterial(cut.body, material);
        cut.run(200);
        CHECK(meanHeight(cut.frame(), 0.005) < before);
        CHECK(cut.flags == 0);
    }
    SECTION("after a reset all of it holds again")
    {
        cut.server->reset();
        cut.server->setGravity({});
        cut.run(3);
        CHECK(cut.frame().positions.size() == 160);
        for (const frame::Attachment& each : cut.server->latest()->attachments)
            if (each.id == tie) CHECK((each.points > 0 && !each.broken));
    }
}

TEST_CASE("a blade parts the attachments that it comes near to")
{
    const std::string engine = GENERATE("native", "sofa");
    Cut cut(engine);
    const BodyId holder = cut.server->add(RigidBodyDef{.name = "holder"});
    cut.server->step(kStep);
    cut.server->attach(cut.body,
                       {.box = geometry::Box{{0.009, 0.0099, -1}, {0.021, 1, 1}}, .to = holder, .cutDistance = 2e-3});
    cut.step();
    const auto points = [&] {
        int sum = 0;
        for (const frame::Attachment& each : cut.server->latest()->attachments)
            if (each.to == holder) sum += each.points;
        return sum;
    };
    const int before = points();
    int parted = 0;
    cut.server->setPose(cut.blade, {{0.0155, 0.012, 0}, {}});
    for (int i = 1; i <= 10; ++i) {
        cut.server->setPose(cut.blade, {{0.0155, 0.012 - 4e-4 * i, 0}, {}});
        cut.step();
        for (const frame::Attachment& each : cut.server->latest()->attachments) parted += each.parted;
    }
    CHECK(before == 16);
    CHECK(parted == 4); // the row of nodes at 16.7 mm
}

TEST_CASE("a body that collides is cut, and rests on the floor in two pieces", "[slow]")
{
    SoftBodyDef def = barDef();
    def.attachments = {};
    def.collision = {{}};
    Cut cut("sofa", def, {0, -9.81, 0});
    cut.server->add(RigidBodyDef{
        .name = "floor",
        .collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(geometry::TriangleMesh{
                           {{-0.1, -2e-4, -0.1}, {-0.1, -2e-4, 0.1}, {0.1, -2e-4, 0.1}, {0.1, -2e-4, -0.1}},
                           {{0, 1, 2}, {0, 2, 3}},
                           {}})}}});
    cut.run(50);
    cut.server->setPose(cut.blade, {{0.0155, 0.012, 0}, {}});
    cut.step();
    cut.stroke(0.0155, 0.012, -1.5e-4);
    cut.stroke(0.0155, -1.5e-4, 0.02);
    cut.run(100);
    REQUIRE(cut.detached().size() == 1);
    double weight = 0.0;
    for (const frame::Contact& each : cut.server->latest()->contacts) weight += each.normalForce;
    CHECK(weight == Approx(9.81 * 3e-6 * 1000).epsilon(0.02));
    for (const Vec3 each : cut.frame().positions) REQUIRE(each.y > -1e-3);
    CHECK((cut.flags &
           (static_cast<std::uint32_t>(StepFlag::Undone) | static_cast<std::uint32_t>(StepFlag::Intersecting))) == 0);
}

TEST_CASE("a blade that is off pushes, one of another group does neither, one that jumps cuts nothing")
{
    SoftBodyDef def = barDef();
    def.collision = {{}};
    Cut cut("sofa", def);
    SECTION("off")
    {
        cut.server->setCutting(cut.blade, false);
        double force = 0.0;
        for (int i = 1; i <= 20; ++i) {
            cut.server->setPose(cut.blade, {{0.0155, 0.012 - 2e-4 * i, 0}, {}});
            cut.step();
            for (const frame::Contact& each : cut.server->latest()->contacts) force += each.normalForce;
        }
        CHECK(cut.ruptures.empty());
        CHECK(force > 0.0);
        cut.stroke(0.0155, 0.008, 0.012, 10);
        cut.server->setCutting(cut.blade, true);
        cut.through();
        CHECK_FALSE(cut.ruptures.empty());
    }
    SECTION("off inside")
    {
        cut.stroke(0.0155, 0.012, 0.0085, 20);
        REQUIRE_FALSE(cut.ruptures.empty());
        const std::size_t made = cut.ruptures.size();
        cut.server->setCutting(cut.blade, false);
        double force = 0.0;
        for (int i = 0; i < 10; ++i) {
            cut.server->setPose(cut.blade, {{0.0155, 0.0085 + 1e-4 * i, 0}, {}});
            cut.step();
            for (const frame::Contact& each : cut.server->latest()->contacts) force += each.normalForce;
        }
        CHECK(cut.ruptures.size() == made);
        CHECK(force == 0.0);
        CHECK(cut.counts.bladeOff == 0);
        cut.stroke(0.0155, 0.0094, -0.001, 20);
        CHECK(cut.counts.bladeOff > 0);
    }
    SECTION("jump")
    {
        cut.server->setPose(cut.blade, {{0.0155, -0.1, 0}, {}});
        cut.step();
        CHECK(cut.ruptures.empty());
        CHECK(cut.counts.bladeTooFast == 1);
    }
    SECTION("another group")
    {
        const BodyId other = cut.server->add(bladeDef(3));
        for (int i = 0; i <= 40; ++i) {
            cut.server->setPose(other, {{0.0155, 0.012 - 6e-4 * i, 0}, {}});
            cut.step();
        }
        CHECK(cut.ruptures.empty());
    }
}

TEST_CASE("springs, and bodies by explicit steps, are cut too")
{
    SoftBodyDef def = barDef();
    SECTION("springs") { def.material = MassSpringMaterial{.stiffness = 5.0, .damping = 0.01}; }
    SECTION("explicit")
    {
        def.integrator = ExplicitEuler{};
        std::get<FemMaterial>(def.material).youngModulus = 10.0; // small parts bear these steps
    }
    Cut native("native", def), sofa("sofa", def);
    native.through();
    sofa.through();
    REQUIRE(sofa.detached().size() == 1);
    CHECK(sofa.detached()[0].mass == Approx(native.detached()[0].mass).epsilon(1e-3));
    sofa.server->setGravity({0, -9.81, 0});
    sofa.run(20);
    CHECK(meanHeight(sofa.frame(), 0.016) < -1e-3);
    CHECK((sofa.flags & static_cast<std::uint32_t>(StepFlag::Undone)) == 0);
}

TEST_CASE("stress tears a bar of SOFA's like one of ours", "[slow]")
{
    SoftBodyDef def = barDef(ConjugateGradient{.tolerance = 1e-9});
    std::get<FemMaterial>(def.material).tearingThreshold = 8e3;
    std::get<FemMaterial>(def.material).regions = {
        {.where = Ball{{0.0155, 0.005, 0.005}, 0.003}, .tearingThreshold = 2e3}};
    def.rayleigh.mass = 20.0;
    const auto torn = [&](const std::string& engine) {
        Cut cut(engine, def);
        const BodyId hand = cut.server->add(RigidBodyDef{.name = "hand"});
        cut.server->attach(cut.body, {.box = geometry::Box{{0.0299, -1, -1}, {1, 1, 1}}, .to = hand});
        for (int i = 1; i <= 250 && cut.detached().empty(); ++i) {
            cut.server->setPose(hand, {{6e-5 * i, 0, 0}, {}});
            cut.step();
        }
        return std::pair{cut.ruptures, cut.detached()};
    };
    const auto [ours, ourPieces] = torn("native");
    const auto [theirs, theirPieces] = torn("sofa");
    REQUIRE_FALSE(ours.empty());
    REQUIRE_FALSE(theirs.empty());
    CHECK(theirs.front().kind == Rupture::Kind::Tear);
    CHECK(length(theirs.front().place - ours.front().place) < 2e-3);
    CHECK_FALSE(theirPieces.empty());
    CHECK_FALSE(ourPieces.empty());
}

TEST_CASE("components of a user are lost with a cut, and a body without dynamicTopology is not cut")
{
    SoftBodyDef def = barDef();
    def.dynamicTopology = false;
    Cut cut("sofa", def);
    cut.through();
    CHECK(cut.ruptures.empty());
    CHECK(cut.frame().boundary == nullptr);
}

} // namespace cutting_test

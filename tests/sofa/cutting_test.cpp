#include "sofa/cut_stage.h"

/// Cuts by told blades and tears, on both engines.
namespace cutting_test {

using namespace filasofia;
using namespace filasofia::cut_test;

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
    CHECK(sofa.area() == Approx(1e-4).epsilon(0.05)); // the bar's cross-section
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

namespace {

/// [m] The mean height of the nodes between the pins and the cut.
double stumpHeight(const frame::SoftBodyFrame& body)
{
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < body.positions.size(); ++i)
        if (const double x = body.boundary->rest[i].x; x > 0.005 && x < 0.0154) {
            sum += body.positions[i].y;
            ++count;
        }
    return sum / count;
}

} // namespace

TEST_CASE("a piece that was cut off falls freely, and what is left stays", "[slow]")
{
    const Solver solver = GENERATE(as<Solver>(), ConjugateGradient{.tolerance = 1e-8},
                                   ConjugateGradient{.tolerance = 1e-6, .assembled = true}, Cholesky{});
    const ElasticLaw law = GENERATE(as<ElasticLaw>(), Corotational{}, NeoHookean{});
    SoftBodyDef def = barDef(solver);
    std::get<FemMaterial>(def.material).law = law;
    def.rayleigh.mass = 0.0;
    Cut cut("sofa", def), native("native", def);
    std::array<double, 2> sunk{}; // what is left, on both engines
    for (Cut* each : {&cut, &native}) {
        each->through();
        REQUIRE(each->detached().size() == 1);
        const double before = meanHeight(each->frame(), 0.016), left = stumpHeight(each->frame());
        each->server->setGravity({0, -9.81, 0});
        each->run(50);
        const double t = 50 * kStep;
        CHECK(meanHeight(each->frame(), 0.016) - before == Approx(-9.81 * t * (t + kStep) / 2).epsilon(1e-3));
        sunk[each == &cut ? 0 : 1] = left - stumpHeight(each->frame());
    }
    UNSCOPED_INFO("sunk " << sunk[0] << " " << sunk[1]);
    CHECK(sunk[1] > 1e-6);
    CHECK(sunk[0] == Approx(sunk[1]).epsilon(0.02));
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

TEST_CASE("a piece that falls out of the scene is told with its mass, and something of a body stays")
{
    const std::string engine = GENERATE("native", "sofa");
    const bool held = GENERATE(true, false);
    INFO(engine << (held ? ", held" : ", free"));
    SoftBodyDef def = barDef();
    def.rayleigh.mass = 0.0;
    if (!held) def.attachments = {};
    Cut cut(engine, def);
    cut.through();
    const auto loose = cut.detached();
    REQUIRE(loose.size() == 1);
    cut.server->setGravity({0, -200, 0});
    std::vector<LostPiece> lost;
    const auto fall = [&](int count) {
        int counted = 0;
        for (int i = 0; i < count; ++i) {
            const TopologyReport topology = cut.step().topology;
            counted += topology.lost;
            lost.insert(lost.end(), topology.lostPieces.begin(), topology.lostPieces.end());
        }
        return counted;
    };
    CHECK(fall(150) == 0); // 9.1 m: g t (t + dt) / 2
    CHECK(fall(15) == 1);  // 11.0 m
    REQUIRE(lost.size() == 1);
    CHECK(lost[0].body == cut.body);
    CHECK(lost[0].piece == loose[0].piece);
    CHECK(lost[0].mass == Approx(loose[0].mass));
    CHECK(lost[0].share == Approx(loose[0].mass / (1000.0 * 3e-6)).epsilon(1e-4)); // the whole bar's mass
    const auto isThere = [&](double x) {
        const frame::SoftBodyFrame body = cut.frame();
        return std::ranges::any_of(body.boundary->triangles, [&](const geometry::Triangle& each) {
            return std::abs(body.boundary->rest[static_cast<std::size_t>(each[0])].x - x) < 1e-6;
        });
    };
    CHECK(isThere(0.0));
    CHECK_FALSE(isThere(0.03));
    CHECK(fall(10) == 0); // what is left of a free bar is beyond too
    CHECK(isThere(0.0));
}

} // namespace cutting_test

#include "sofa/cut_stage.h"

#include "filasofia/core/log.h"
#include "filasofia/sofa/tune.h"

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/MutationListener.h>
#include <sofa/simulation/Node.h>

/// What follows a cut in SOFA's engine: pins, ties, resets, saved states, and what SOFA refuses.
namespace cut_state_test {

using namespace filasofia;
using namespace filasofia::cut_test;

namespace {

/// Throws where the node of a body would come into a graph.
struct Refusing final : ::sofa::simulation::MutationListener {
    void onBeginAddChild(::sofa::simulation::Node* /*parent*/, ::sofa::simulation::Node* child) override
    {
        if (child->getName().starts_with("body")) throw std::runtime_error("full");
    }
};

/// A component of a user.
class BodyNote final : public ::sofa::core::objectmodel::BaseObject {
public:
    SOFA_CLASS(BodyNote, ::sofa::core::objectmodel::BaseObject);
};

} // namespace

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

TEST_CASE("if SOFA cannot make what a removed piece leaves, the piece stays, and it is not counted as missing")
{
    Cut cut("sofa");
    cut.through();
    REQUIRE(cut.detached().size() == 1);
    const std::size_t faces = cut.frame().boundary->triangles.size();
    Refusing refusing;
    const auto listen = [&](bool on) {
        sofaengine::tune(*cut.server, [&refusing, on](::sofa::simulation::Node& root, const auto&) {
            if (on) root.addListener(&refusing);
            if (!on) root.removeListener(&refusing);
        });
        cut.step();
    };
    listen(true);
    cut.server->removePiece(cut.body, cut.detached()[0].piece);
    const StepReport report = cut.step();
    CHECK(report.topology.noPiece == 0);
    CHECK(report.has(StepFlag::TuneRejected));
    CHECK(cut.frame().boundary->triangles.size() == faces);
    listen(false);
    cut.server->removePiece(cut.body, cut.detached()[0].piece);
    CHECK(cut.step().topology.noPiece == 0);
    CHECK(cut.frame().boundary->triangles.size() < faces);
}

TEST_CASE("pins, material, loads and ties follow a cut")
{
    SoftBodyDef def = barDef(Cholesky{});
    def.attachments.push_back({.box = kFarEnd, .stiffness = 50.0});
    Cut cut("sofa", def);
    const BodyId holder = cut.server->add(RigidBodyDef{.name = "holder"});
    cut.server->step(kStep);
    const AttachmentId tie =
        cut.server->attach(cut.body, {.box = geometry::Box{{0.0199, 0.0099, -1}, {0.0234, 1, 1}}, .to = holder});
    cut.step();
    const auto force = [&] { // the tie's, which holds the piece beside the springs
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

TEST_CASE("a body without dynamicTopology is not cut")
{
    SoftBodyDef def = barDef();
    def.dynamicTopology = false;
    Cut cut("sofa", def);
    cut.through();
    CHECK(cut.ruptures.empty());
    CHECK(cut.frame().boundary == nullptr);
}

TEST_CASE("if SOFA cannot make a cut body, it stays whole with a flag, and can be cut later")
{
    Cut cut("sofa");
    const std::vector<Vec3> before = cut.frame().positions;
    Refusing refusing;
    sofaengine::tune(*cut.server, [&](::sofa::simulation::Node& root, const auto&) { root.addListener(&refusing); });
    cut.through();
    CHECK((cut.flags & static_cast<std::uint32_t>(StepFlag::Undone)) != 0);
    CHECK(cut.ruptures.empty());
    CHECK(cut.frame().positions == before);
    CHECK(cut.frame().boundary->revision == 0);
    CHECK(isClosed(*cut.frame().boundary));
    sofaengine::tune(*cut.server, [&](::sofa::simulation::Node& root, const auto&) { root.removeListener(&refusing); });
    cut.through();
    CHECK(cut.detached().size() == 1);
    CHECK(isClosed(*cut.frame().boundary));
}

TEST_CASE("the log says that components of a user are gone with a cut, and nothing else")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    const Solver solver = GENERATE(as<Solver>(), ConjugateGradient{}, ConjugateGradient{.assembled = true}, Cholesky{});
    Cut cut("sofa", barDef(solver));
    cut.through();
    CHECK(cut.detached().size() == 1);
    CHECK(lines.empty());
    const bool below = GENERATE(false, true);
    sofaengine::tune(*cut.server, [&](auto&, const sofaengine::NodeOf& nodeOf) {
        if (below)
            nodeOf(cut.body)->createChild("mine");
        else
            nodeOf(cut.body)->addObject(::sofa::core::objectmodel::New<BodyNote>());
    });
    cut.through(0.0255);
    setLogSink({});
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Catch::Contains("soft body 'bar': components that tune() has added"));
}

TEST_CASE("only those who ask for a cut body that meets itself are told that SOFA has none")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    const std::optional<bool> asked = GENERATE(as<std::optional<bool>>(), std::nullopt, false, true);
    const bool anyway = GENERATE(false, true);
    SoftBodyDef def = barDef();
    def.collision = {{.self = anyway, .selfOnceCut = asked}};
    const auto server = serverWith("sofa");
    server->add(def);
    setLogSink({});
    CAPTURE(asked.has_value(), anyway, lines.size());
    if (asked == true && !anyway) {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Catch::Contains("soft body 'bar': collision[0].selfOnceCut: with the engine 'sofa'"));
    } else {
        CHECK(lines.empty());
    }
}

TEST_CASE("bodies are cut, removed and added again many times", "[slow]")
{
    Cut cut("sofa", barDef(Cholesky{}));
    for (int i = 0; i < 20; ++i) {
        cut.through();
        REQUIRE(cut.detached().size() == static_cast<std::size_t>(i + 1));
        cut.server->remove(cut.body);
        cut.body = cut.server->add(barDef(i % 2 == 0 ? Solver{ConjugateGradient{}} : Solver{Cholesky{}}));
    }
    CHECK((cut.flags & static_cast<std::uint32_t>(StepFlag::Undone)) == 0);
}

} // namespace cut_state_test

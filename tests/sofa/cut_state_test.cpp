#include "sofa/cut_stage.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/sofa/tune.h"

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/MutationListener.h>
#include <sofa/simulation/Node.h>

/// What follows a cut in SOFA's engine: pieces, pins, ties, resets, saved states, and what SOFA refuses.
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

TEST_CASE("a piece can be removed, but not all that is left")
{
    Cut cut("sofa");
    cut.through();
    REQUIRE(cut.detached().size() == 1);
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

namespace {

/// A bar that is held at both ends: the first by its Def, the second by its Def or by a command. The far end has been
/// cut off.
struct HeldTwice {
    Cut cut;
    AttachmentId second;
    HeldTwice(const std::string& engine, bool byCommand) : cut(engine, heldDef(byCommand))
    {
        if (byCommand) second = cut.server->attach(cut.body, {.box = kFarEnd});
        cut.step();
        cut.through();
        REQUIRE(cut.detached().size() == 1);
    }
    static SoftBodyDef heldDef(bool byCommand)
    {
        SoftBodyDef def = barDef();
        if (!byCommand) def.attachments.push_back({.box = kFarEnd});
        return def;
    }
    /// How far the far end sinks in 0.1 s under gravity.
    double sink()
    {
        const double before = meanHeight(cut.frame(), 0.0299);
        cut.server->setGravity({0, -9.81, 0});
        cut.run(50);
        cut.server->setGravity({});
        return before - meanHeight(cut.frame(), 0.0299);
    }
    inline static const geometry::Box kFarEnd{{0.0299, -1, -1}, {1, 1, 1}};
};

} // namespace

TEST_CASE("a reset brings back the pins that the Def gives a piece that was removed, but no others")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool byCommand = GENERATE(false, true);
    CAPTURE(engine, byCommand);
    HeldTwice held(engine, byCommand);
    held.cut.server->removePiece(held.cut.body, held.cut.detached()[0].piece);
    held.cut.step();
    const auto saved = held.cut.server->save();
    held.cut.server->restore(*saved); // a saved state has them too
    held.cut.server->reset();
    held.cut.step();
    REQUIRE(held.cut.frame().positions.size() == 160);
    const double sunk = held.sink();
    if (byCommand)
        CHECK(sunk > 1e-3);
    else
        CHECK(sunk == 0.0);
}

TEST_CASE("a removed piece is not attached")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    Cut cut(engine);
    const BodyId holder = cut.server->add(RigidBodyDef{.name = "holder", .elements = {{{0.028, 0.005, 0.005}, {}}}});
    RigidBodyDef solid{.name = "solid",
                       .elements = {{{0.028, 0.005, 0.005}, {}}},
                       .mesh = geometry::shapes::box({0.002, 0.02, 0.02}),
                       .dynamic = true};
    const BodyId body = cut.server->add(solid);
    cut.through();
    REQUIRE(cut.detached().size() == 1);
    cut.server->removePiece(cut.body, cut.detached()[0].piece);
    cut.step();
    int gone = -1; // a node of what is removed
    for (std::size_t i = 0; i < 160; ++i)
        if (cut.frame().boundary->rest[i].x > 0.0299) gone = static_cast<int>(i);
    const auto holdsNothing = [&](BodyId id, const AttachmentDef& def) {
        cut.server->attach(id, def);
        return cut.step().has(StepFlag::NothingAttached);
    };
    CHECK(holdsNothing(cut.body, {.nodes = {gone}, .to = holder}));
    CHECK(holdsNothing(cut.body, {.box = geometry::Box{{0.0299, -1, -1}, {1, 1, 1}}, .to = holder}));
    CHECK(holdsNothing(cut.body, {.within = 1e-3, .to = body}));
    CHECK(holdsNothing(cut.body, {.nodes = {gone}, .breakForce = 1.0}));
    const auto ties = [&] { // without pins in space
        std::vector<frame::Attachment> all = cut.server->latest()->attachments;
        std::erase_if(all, [](const frame::Attachment& each) { return !each.to; });
        return all;
    };
    CHECK(ties().empty());
    SECTION("a pair of which one is gone is left out")
    {
        const BodyId other = cut.server->add(barDef());
        cut.step();
        CHECK_FALSE(holdsNothing(other, {.nodes = {159, 158}, .to = cut.body, .toNodes = {gone, 0}}));
        REQUIRE(ties().size() == 1);
        CHECK(ties()[0].points == 1);
        CHECK(holdsNothing(other, {.nodes = {159}, .to = cut.body, .toNodes = {gone}}));
    }
    SECTION("what is nearest to it is what is left")
    {
        // The piece stays where it was: what is attached to it would be held in space.
        for (const AttachMode mode : {AttachMode::Nearest, AttachMode::Barycentric}) {
            SoftBodyDef def = barDef();
            def.attachments = {};
            def.pose.position = {0.01, 0, 0};
            const BodyId other = cut.server->add(def);
            cut.step();
            CHECK_FALSE(holdsNothing(other, {.nodes = {80}, .to = cut.body, .mode = mode}));
            cut.server->setGravity({0, -9.81, 0});
            cut.run(5);
            cut.server->setGravity({});
            double held = 0.0; // [N] on the node, by what is left: that one sinks too
            for (const frame::Attachment& each : ties()) held += length(each.force);
            CHECK(held > 0.0);
            CHECK(cut.frame().velocities[static_cast<std::size_t>(gone)] == Vec3{});
            double moved = 0.0;
            for (std::size_t i = 0; i < 160; ++i)
                if (cut.frame().boundary->rest[i].x > 0.0099 && cut.frame().boundary->rest[i].x < 0.0155)
                    moved = std::max(moved, length(cut.frame().positions[i] - cut.frame().boundary->rest[i]));
            CHECK(moved > 1e-5); // it is pulled
            cut.server->remove(other);
            cut.step();
        }
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

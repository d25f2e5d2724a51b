#include "sofa/cut_stage.h"

#include "filasofia/geometry/shapes.h"

/// Pieces that were cut off and are removed: what is left, what a reset brings back, what can be attached.
namespace removed_piece_test {

using namespace filasofia;
using namespace filasofia::cut_test;

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
    CHECK(holdsNothing(cut.body, {.box = kFarEnd, .to = holder}));
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

} // namespace removed_piece_test

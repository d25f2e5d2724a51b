#include "engine/rupture/meshes.h"

#include "filasofia/engine/rupture/pieces.h"

#include "effort.h"

#include <algorithm>
#include <random>

namespace cut_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// Cuts straight down through the bar at this x.
RuptureReport cutAcross(EditableMesh& mesh, double x, int steps, const CutParameters& parameters = {})
{
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report = sweep(mesh, stroke, {x, 0.02, -0.03}, {x, 0.02, 0.03}, {0, -0.04, 0}, steps, parameters);
    finish(mesh, stroke, report, parameters);
    return report;
}

} // namespace

TEST_CASE("a blade that passes through a bar, in many steps or few, leaves two valid pieces")
{
    for (int steps : {1, 2, 7, 50, 400})
        for (double x : {0.0, 1e-14, -1e-12, 1e-9, 0.0013, 0.0025, 0.005, 0.0071}) { // 0 and 0.005 are planes of nodes
            CAPTURE(steps, x);
            EditableMesh mesh = bar();
            Pieces pieces(mesh.data());
            const RuptureReport report = cutAcross(mesh, x, steps);
            CHECK(faultsOf(mesh) == "");
            const auto detached = pieces.update(mesh.data(), mesh.takeEdit({1}));
            REQUIRE(pieces.count() == 2);
            REQUIRE(detached.size() == 1);
            CHECK(detached[0].id == 1);
            CHECK(detached[0].from == 0);
            double volume = 0.0;
            for (int t : detached[0].tetrahedra) volume += restVolume(mesh.data(), t);
            CHECK(volume == Approx((0.02 - std::abs(x)) * 0.02 * 0.02).epsilon(0.03));
            CHECK(report.openedArea == Approx(0.02 * 0.02).epsilon(0.15));
            CHECK(std::abs(report.openedMoment.x / report.openedArea - x) < 1e-3);
            CHECK(report.pending == 0);
            CHECK(report.givenUp == 0);
        }
}

TEST_CASE("a cut that stops inside remains, and can be continued later as the same surface")
{
    EditableMesh mesh = bar();
    BladeStroke first(mesh.newSheet());
    RuptureReport report = sweep(mesh, first, {0.002, 0.02, -0.03}, {0.002, 0.02, 0.03}, {0, -0.0213, 0}, 40);
    CHECK(!first.away());
    finish(mesh, first, report);
    CHECK(report.openedArea > 0.4 * 0.02 * 0.02);
    CHECK(faultsOf(mesh) == "");
    mesh.takeEdit({1});
    Pieces pieces(mesh.data());
    CHECK(pieces.count() == 1);
    // A blade that returns to the place, in the plane of the cut, finds the same surface.
    const auto found = [&](Vec3 from, Vec3 to) {
        const BladeSegment s{from, to, from, to};
        return sheetAt(mesh, {&s, 1});
    };
    CHECK(found({0.002, -0.001, -0.03}, {0.002, -0.001, 0.03}) == first.sheet());
    CHECK(found({-0.03, -0.001, 0}, {0.03, -0.001, 0}) == 0);
    CHECK(found({0.012, -0.001, -0.03}, {0.012, -0.001, 0.03}) == 0);
    BladeStroke second(first.sheet());
    report = sweep(mesh, second, {0.002, -0.001, -0.03}, {0.002, -0.001, 0.03}, {0, -0.02, 0}, 40);
    CHECK(second.away());
    finish(mesh, second, report);
    CHECK(faultsOf(mesh) == "");
    CHECK(pieces.update(mesh.data(), mesh.takeEdit({1})).size() == 1);
}

TEST_CASE("scissors whose jaws close from both sides cut the bar through")
{
    EditableMesh mesh = bar();
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report;
    const int steps = 60;
    for (int i = 0; i < steps; ++i) {
        const auto jaws = [&](int step) {
            const double y = 0.015 * (1.0 - static_cast<double>(step) / steps);
            return std::array{std::array{Vec3{0.001, y + 0.004, -0.012}, Vec3{0.001, y - 0.001, 0.012}},
                              std::array{Vec3{0.001, -y - 0.004, -0.012}, Vec3{0.001, -y + 0.001, 0.012}}};
        };
        const auto before = jaws(i), now = jaws(i + 1);
        const std::array<BladeSegment, 2> blade{BladeSegment{now[0][0], now[0][1], before[0][0], before[0][1]},
                                                BladeSegment{now[1][0], now[1][1], before[1][0], before[1][1]}};
        report += stroke.step(mesh, blade, {});
    }
    // closed: the jaws have passed each other
    const std::array<BladeSegment, 1> last{
        BladeSegment{{0.001, -0.005, -0.012}, {0.001, -0.006, 0.012}, {0.001, 0.004, -0.012}, {0.001, -0.001, 0.012}}};
    report += stroke.step(mesh, last, {});
    finish(mesh, stroke, report);
    CHECK(faultsOf(mesh) == "");
    CHECK(Pieces(mesh.data()).count() == 2);
}

TEST_CASE("a bent blade of several segments leaves no gap at its joints")
{
    for (const double joint : {0.002, 0.0025, 0.004, 0.005}) { // on nodes, on edges, between
        CAPTURE(joint);
        EditableMesh mesh = bar();
        BladeStroke stroke(mesh.newSheet());
        RuptureReport report;
        const std::array<Vec3, 4> line{
            Vec3{0.004, 0, -0.03}, {0.004 - joint, 0, -joint}, {0.001, 0, joint}, {0, 0, 0.03}};
        const int steps = 80;
        for (int i = 0; i < steps; ++i) {
            const Vec3 before{0, 0.02 - 0.04 * i / steps, 0}, now{0, 0.02 - 0.04 * (i + 1) / steps, 0};
            std::array<BladeSegment, 3> blade;
            for (int k = 0; k < 3; ++k)
                blade[k] = {line[k] + now, line[k + 1] + now, line[k] + before, line[k + 1] + before};
            report += stroke.step(mesh, blade, {});
        }
        finish(mesh, stroke, report);
        CHECK(faultsOf(mesh) == "");
        CHECK(Pieces(mesh.data()).count() == 2);
    }
}

TEST_CASE("a blade with a corner of 45 degrees cuts through, wherever the corner crosses the mesh")
{
    for (int place = 0; place < 16; ++place) {
        CAPTURE(place);
        EditableMesh mesh = bar();
        BladeStroke stroke(mesh.newSheet());
        RuptureReport report;
        const double x = -0.004 + 0.0005 * place;
        const std::array<Vec3, 3> line{Vec3{-0.03, 0, x}, {x, 0, x}, {x + 0.03, 0, x + 0.03}};
        for (int i = 0; i < 80; ++i) {
            const Vec3 before{0, 0.02 - 0.0005 * i, 0}, now{0, 0.02 - 0.0005 * (i + 1), 0};
            std::array<BladeSegment, 2> blade;
            for (int k = 0; k < 2; ++k)
                blade[k] = {line[k] + now, line[k + 1] + now, line[k] + before, line[k + 1] + before};
            report += stroke.step(mesh, blade, {});
        }
        finish(mesh, stroke, report);
        CHECK(faultsOf(mesh) == "");
        CHECK(Pieces(mesh.data()).count() == 2);
    }
}

TEST_CASE("two blades at once make three pieces, and the largest keeps its id")
{
    EditableMesh mesh = bar();
    Pieces pieces(mesh.data());
    std::array<BladeStroke, 2> strokes{BladeStroke(mesh.newSheet()), BladeStroke(mesh.newSheet())};
    RuptureReport report;
    std::vector<DetachedPiece> detached;
    for (int i = 0; i < 50; ++i)
        for (int k = 0; k < 2; ++k) {
            const double x = k == 0 ? -0.012 : 0.0135;
            const Vec3 before{x, 0.02 - 0.0008 * i, 0}, now{x, 0.02 - 0.0008 * (i + 1), 0}, half{0, 0, 0.03};
            const BladeSegment s{now - half, now + half, before - half, before + half};
            report += strokes[k].step(mesh, {&s, 1}, {});
            if (i == 49) finish(mesh, strokes[k], report);
            for (DetachedPiece& piece : pieces.update(mesh.data(), mesh.takeEdit({1}))) detached.push_back(piece);
        }
    CHECK(faultsOf(mesh) == "");
    CHECK(pieces.count() == 3);
    REQUIRE(detached.size() == 2);
    for (const DetachedPiece& piece : detached) {
        CHECK(piece.from == 0);
        CHECK(piece.id > 0);
        double volume = 0.0;
        for (int t : piece.tetrahedra) {
            volume += restVolume(mesh.data(), t);
            CHECK(pieces.ofTetrahedron()[t] == piece.id);
        }
        CHECK(volume < 0.25 * mesh.startVolume());
    }
}

TEST_CASE("tissue that moves over a blade at rest is cut as by a moving blade")
{
    EditableMesh mesh = bar();
    BladeStroke stroke(mesh.newSheet());
    const std::vector<Vec3> rest = mesh.data().rest;
    mesh.placeAt(rest);
    RuptureReport report;
    const Vec3 from{0.0022, 0.015, -0.03}, to{0.0022, 0.015, 0.03};
    for (int i = 1; i <= 200; ++i) {
        std::vector<Vec3> x = mesh.data().rest;
        for (Vec3& p : x) p.y += 0.03 * i / 200;
        mesh.moveTo(x);
        const BladeSegment segment{from, to, from, to};
        report += stroke.step(mesh, {&segment, 1}, {});
    }
    finish(mesh, stroke, report);
    CHECK(faultsOf(mesh) == "");
    CHECK(Pieces(mesh.data()).count() == 2);
}

TEST_CASE("an invalid blade is refused and counted, and the mesh stays bit-identical")
{
    EditableMesh mesh = bar();
    cutAcross(mesh, 0.003, 20);
    const std::uint64_t before = hashOf(mesh.data());
    BladeStroke stroke(mesh.newSheet());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refuses = [&](BladeSegment segment, RuptureRefusal reason) {
        const RuptureReport report = stroke.step(mesh, {&segment, 1}, {});
        CHECK(report.refused[static_cast<int>(reason)] == 1);
        CHECK(hashOf(mesh.data()) == before);
    };
    const Vec3 a{0, 0.02, -0.03}, b{0, 0.02, 0.03}, down{0, -0.04, 0}, far{0, -0.05, 0};
    refuses({a, a, a, a}, RuptureRefusal::BladeNoLength);
    refuses({a + down, a + down, a, b}, RuptureRefusal::BladeNoLength);
    refuses({a + down, {0, nan, 0}, a, b}, RuptureRefusal::BladeNotFinite);
    refuses({a + down, b + down, {nan, 0, 0}, b}, RuptureRefusal::BladeNotFinite);
    refuses({a + far, b + far, a, b}, RuptureRefusal::BladeJump);
    CHECK(stroke.step(mesh, {}, {}).refused[static_cast<int>(RuptureRefusal::BladeNoLength)] == 1);
    BladeSegment fine{a + down, b + down, a, b};
    CHECK(stroke.step(mesh, {&fine, 1}, {}).openedFaces > 0);
}

TEST_CASE("the crossings are searched again after a blade was lifted or refused, or the tissue moved unseen")
{
    for (const int pause : {0, 1, 2}) {
        CAPTURE(pause);
        EditableMesh mesh = bar();
        BladeStroke stroke(mesh.newSheet());
        RuptureReport report = sweep(mesh, stroke, {-0.0123, 0.02, -0.03}, {-0.0123, 0.02, 0.03}, {0, -0.0095, 0}, 40);
        double x = -0.0123;
        if (pause == 0) x = 0.0077; // placed elsewhere
        if (pause == 1) {           // the same after a refused jump
            x = 0.0077;
            const BladeSegment jump{{x, 1, -0.03}, {x, 1, 0.03}, {0, 0.02, -0.03}, {0, 0.02, 0.03}};
            CHECK(stroke.step(mesh, {&jump, 1}, {}).refused[static_cast<int>(RuptureRefusal::BladeJump)] == 1);
        }
        if (pause == 2) // the body moved past the blade in a step that the stroke did not see
            for (const double way : {0.01, 0.02, 0.02}) { // the last step does not move
                std::vector<Vec3> moved = mesh.data().rest;
                for (Vec3& p : moved) p.x -= way;
                mesh.moveTo(moved);
            }
        // 0.0105 is where the previous sweep ended.
        report += sweep(mesh, stroke, {x, 0.0105, -0.03}, {x, 0.0105, 0.03}, {0, -0.021, 0}, 300);
        finish(mesh, stroke, report);
        CHECK(faultsOf(mesh) == "");
        CHECK(Pieces(mesh.data()).count() == 2);
    }
}

TEST_CASE("crossings beyond the limit of one step wait for the next, and the mesh is valid in between")
{
    const CutParameters few{.maxNewTetrahedra = 30};
    EditableMesh mesh = bar();
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report = sweep(mesh, stroke, {0.0023, 0.02, -0.03}, {0.0023, 0.02, 0.03}, {0, -0.04, 0}, 1, few);
    CHECK(report.pending > 0);
    CHECK(faultsOf(mesh) == "");
    int more = 0;
    for (bool done = false; !done; ++more) {
        const int before = mesh.tetrahedra();
        RuptureReport rest;
        done = stroke.finish(mesh, few, rest);
        CHECK(mesh.tetrahedra() - before < 200); // the limit, plus the last edge's elements and what repairs need
        CHECK(faultsOf(mesh) == "");
        report += rest;
    }
    CHECK(more > 3);
    CHECK(Pieces(mesh.data()).count() == 2);
}

TEST_CASE("elements, boundary, positions and embedded points can be followed from the edits alone", "[cases]")
{
    std::mt19937 random(5);
    const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    for (const bool moveNodes : {false, true}) {
        const CutParameters parameters{.moveNodes = moveNodes};
        EditableMesh mesh = bar();
        frame::TopologyMirror mirror(mesh.data().tetrahedra);
        std::vector<geometry::Tetrahedron> tetrahedra = mesh.data().tetrahedra;
        std::vector<Vec3> positions = mesh.data().rest, rest = positions;
        std::vector<int> materials(mesh.tetrahedra()); // the element that each one descends from
        std::vector<frame::EmbeddedPoint> points;
        for (int t = 0; t < mesh.tetrahedra(); ++t) {
            materials[t] = t;
            points.push_back({t, {0.1, 0.2, 0.3, 0.4}});
        }
        const auto at = [&](const frame::EmbeddedPoint& p) {
            Vec3 sum;
            for (int k = 0; k < 4; ++k) sum += p.weights[k] * rest[tetrahedra[p.tetrahedron][k]];
            return sum;
        };
        std::vector<Vec3> places;
        for (const auto& p : points) places.push_back(at(p));
        int edits = 0;
        const auto follow = [&] {
            const frame::TopologyEdit edit = mesh.takeEdit({1});
            edits += edit.empty() ? 0 : 1;
            frame::followNodes(edit, positions);
            frame::followElements(edit, materials);
            frame::followPoints(edit, tetrahedra, rest, points);
            mirror.apply(edit);
            CHECK(mirror.tetrahedra() == mesh.data().tetrahedra);
            for (const frame::TetNodes& now : edit.changed)
                if (mesh.data().tetrahedra[now.tetrahedron] != now.nodes) FAIL_CHECK(now.tetrahedron);
        };
        for (int cut = 0; cut < cases(125); ++cut) {
            BladeStroke stroke(mesh.newSheet());
            const Vec3 start{uniform(-0.02, 0.02), uniform(-0.01, 0.01), uniform(-0.01, 0.01)};
            const Vec3 d = normalized({uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
            const Vec3 along = normalized(cross(d, {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}));
            RuptureReport report;
            for (int i = 0; i < 60; ++i) {
                const Vec3 before = start + 0.0004 * (i - 30) * d, now = before + 0.0004 * d;
                const BladeSegment s{now, now + 0.02 * along, before, before + 0.02 * along};
                report += stroke.step(mesh, {&s, 1}, parameters);
                if (i == 59) finish(mesh, stroke, report, parameters);
                if (i % 3 == 2) follow(); // one edit may contain the operations of several steps
            }
            CHECK(checkMirror(mesh.data(), mirror, positions).empty());
            CHECK(faultsOf(mesh) == "");
        }
        CHECK(edits > cases(1000));
        CHECK(tetrahedra == mesh.data().tetrahedra);
        CHECK(rest == mesh.data().rest);
        CHECK(materials.size() == tetrahedra.size());
        double lowest = 0.0, farthest = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            farthest = std::max(farthest, distance(at(points[i]), places[i]));
            lowest = std::min(lowest, std::ranges::min(points[i].weights));
            if (!moveNodes) CHECK(materials[points[i].tetrahedron] == static_cast<int>(i));
        }
        CAPTURE(lowest);
        CHECK(farthest < 1e-14 * mesh.diagonal());
        CHECK(lowest >= (moveNodes ? -3.0 : 0.0));
        if (moveNodes) CHECK(lowest < 0.0);
    }
}

} // namespace cut_test

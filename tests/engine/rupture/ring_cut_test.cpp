#include "engine/rupture/meshes.h"

#include "filasofia/engine/rupture/pieces.h"

#include "effort.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>

namespace ring_cut_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A blade of n straight sides around the y axis, turned by `turn` [rad]; as wide in z as `width` says.
std::vector<Vec3> ringOf(int n, double radius, double turn, double width = 1.0)
{
    std::vector<Vec3> ring;
    for (int i = 0; i < n; ++i) {
        const double a = 2.0 * std::numbers::pi * i / n;
        const Vec3 p{radius * std::cos(a), 0, width * radius * std::sin(a)};
        ring.push_back({p.x * std::cos(turn) - p.z * std::sin(turn), 0, p.x * std::sin(turn) + p.z * std::cos(turn)});
    }
    return ring;
}

struct Punched {
    int pieces = 0;
    double area = 0.0, core = 0.0; ///< [-] the area cut and the second piece's volume over those of the ring
    std::string faults = {};
};

/// Pushes a ring down through a slab of 60 x 12 x 60 mm in steps of 0.2 mm, turning it by `twist` [rad] all the way.
/// The segments come in no order and run both ways round, as the edges of a collision model do.
Punched punch(const std::vector<Vec3>& ring, Vec3 at, int cells, double twist = 0.0)
{
    EditableMesh mesh(*geometry::shapes::block({0.06, 0.012, 0.06}, {5 * cells, cells, 5 * cells}));
    const auto n = ring.size();
    std::vector<std::array<std::size_t, 2>> segments;
    for (std::size_t i = 0; i < n; ++i) segments.push_back({i, (i + 1) % n});
    std::mt19937 random(3);
    std::ranges::shuffle(segments, random);
    for (auto& segment : segments)
        if (random() % 2 == 0) std::swap(segment[0], segment[1]);

    BladeStroke stroke(mesh.newSheet());
    RuptureReport report;
    constexpr int kSteps = 90;
    const auto place = [&](Vec3 p, int step) {
        const double a = twist * step / kSteps;
        return at + Vec3{p.x * std::cos(a) - p.z * std::sin(a), 0.009 - 0.0002 * step,
                         p.x * std::sin(a) + p.z * std::cos(a)};
    };
    for (int step = 0; step < kSteps; ++step) {
        std::vector<BladeSegment> blade;
        for (const auto& [a, b] : segments)
            blade.push_back(
                {place(ring[a], step + 1), place(ring[b], step + 1), place(ring[a], step), place(ring[b], step)});
        report += stroke.step(mesh, blade, {});
    }
    finish(mesh, stroke, report);

    double around = 0.0, inside = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        around += distance(ring[i], ring[(i + 1) % n]);
        inside += 0.5 * std::abs(cross(ring[i], ring[(i + 1) % n]).y);
    }
    const Pieces pieces(mesh.data());
    std::vector<double> volumes(static_cast<std::size_t>(pieces.count()));
    for (int t = 0; t < mesh.tetrahedra(); ++t)
        volumes[static_cast<std::size_t>(pieces.ofTetrahedron()[t])] += restVolume(mesh.data(), t);
    std::ranges::sort(volumes, std::greater{});
    return {pieces.count(), report.openedArea / (0.012 * around),
            volumes.size() > 1 ? volumes[1] / (0.012 * inside) : 0.0, faultsOf(mesh)};
}

} // namespace

TEST_CASE("a ring of any number of sides that is pushed through a slab frees its core", "[cases]")
{
    std::mt19937 random(11);
    const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    for (const double radius : {0.006, 0.012, 0.015, 0.018, 0.02})
        for (const int sides : {4, 6, 8, 12, 24, 48})
            for (int place = 0; place < cases(3); ++place) {
                const Vec3 at{uniform(-3e-3, 3e-3), 0, uniform(-3e-3, 3e-3)};
                const double turn = place == 0 ? 0.0 : uniform(0, 3);
                CAPTURE(radius, sides, at.x, at.z, turn);
                const Punched done = punch(ringOf(sides, radius, turn), at, 4);
                CHECK(done.faults == "");
                CHECK(done.pieces == 2);
                CHECK(done.core == Approx(1.0).epsilon(radius < 0.01 ? 0.16 : 0.06));
                CHECK(done.area == Approx(1.0).epsilon(radius < 0.01 ? 0.16 : 0.12));
            }
}

TEST_CASE("a finer mesh gives a ring's core its mass to 1.5 percent")
{
    for (const int sides : {4, 24}) {
        CAPTURE(sides);
        const Punched done = punch(ringOf(sides, 0.012, 0.4), {3e-4, 0, 4e-4}, 8);
        CHECK(done.faults == "");
        CHECK(done.pieces == 2);
        CHECK(done.core == Approx(1.0).epsilon(0.015));
        CHECK(done.area == Approx(1.0).epsilon(0.05));
    }
}

TEST_CASE("a ring that turns while it is pushed, and an oval one, free their cores")
{
    for (int place = 0; place < 4; ++place) {
        CAPTURE(place);
        const Vec3 at{1e-3 * place, 0, 7e-4 * place};
        CHECK(punch(ringOf(32, 0.012, 0.1 * place), at, 4, 3.0).pieces == 2);
        CHECK(punch(ringOf(24, 0.015, 0.3 * place, 0.6), at, 4).pieces == 2);
    }
}

TEST_CASE("a ring that is open on one side frees nothing")
{
    std::vector<Vec3> line = ringOf(24, 0.012, 0.0);
    EditableMesh mesh(*geometry::shapes::block({0.06, 0.012, 0.06}, {20, 4, 20}));
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report;
    for (int step = 0; step < 90; ++step) {
        const Vec3 before{0, 0.009 - 0.0002 * step, 0}, now{0, 0.009 - 0.0002 * (step + 1), 0};
        std::vector<BladeSegment> blade;
        for (std::size_t i = 0; i < 21; ++i)
            blade.push_back({line[i] + now, line[i + 1] + now, line[i] + before, line[i + 1] + before});
        report += stroke.step(mesh, blade, {});
    }
    finish(mesh, stroke, report);
    CHECK(faultsOf(mesh) == "");
    CHECK(Pieces(mesh.data()).count() == 1);
    CHECK(report.openedArea == Approx(21 * distance(line[0], line[1]) * 0.012).epsilon(0.1));
}

} // namespace ring_cut_test

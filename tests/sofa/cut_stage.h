#pragma once

#include "sofa/sofa_stage.h"

#include <algorithm>
#include <map>

/// A bar and a told blade, on either engine.
namespace filasofia::cut_test {

using namespace physics;
using namespace sofa_test;

inline constexpr double kStep = 2e-3;                            // [s]
inline constexpr double kDeep = 0.015;                           // [m] below where the bar is
inline const geometry::Box kFarEnd{{0.0299, -1, -1}, {1, 1, 1}}; // the end of the bar

/// A bar along x, held at its low end, 30 x 10 x 10 mm.
inline SoftBodyDef barDef(const Solver& solver = ConjugateGradient{.tolerance = 1e-8})
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
inline RigidBodyDef bladeDef(int group = 0)
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
inline bool isClosed(const frame::Boundary& boundary)
{
    std::map<std::array<int, 2>, int> uses;
    for (const geometry::Triangle& t : boundary.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            uses[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    return std::ranges::all_of(uses, [](const auto& each) { return each.second == 0; });
}

inline double meanHeight(const frame::SoftBodyFrame& body, double beyond)
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

} // namespace filasofia::cut_test

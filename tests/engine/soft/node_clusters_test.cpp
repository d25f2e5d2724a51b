#include "filasofia/engine/soft/node_clusters.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/soft/coarse_rebuild.h"

#include "engine/stage.h"

#include <set>

namespace node_clusters_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

std::vector<std::array<int, 2>> edgesOf(const geometry::TetMesh& mesh)
{
    std::vector<std::array<int, 2>> edges;
    for (const geometry::Tetrahedron& each : mesh.tetrahedra)
        for (const auto& [i, j] : geometry::kTetrahedronEdges) edges.push_back({each[i], each[j]});
    return edges;
}

/// A sheet of 36 x 36 x 0.6 mm, pinned along an edge: its edges are 3 mm long, and 0.6 mm through its thickness.
physics::SoftBodyDef sheet()
{
    return {.mesh = shared(boxMesh({12, 12, 1}, {0.036, 0.036, 6e-4})),
            .material = physics::FemMaterial{.youngModulus = 2e4, .poissonRatio = 0.4},
            .solver = physics::ConjugateGradient{.tolerance = 1e-6},
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
            .dynamicTopology = true};
}

} // namespace

TEST_CASE("clusters have at most sixteen nodes, each node once, and no node that is not active")
{
    const geometry::TetMesh mesh = boxMesh({9, 7, 5}, {0.09, 0.05, 0.02}, 0.2);
    std::vector<bool> active(mesh.nodes.size(), true);
    for (std::size_t i = 0; i < active.size(); i += 7) active[i] = false;
    std::set<int> met;
    std::size_t nodes = 0;
    const std::vector<std::vector<int>> clusters = nodeClusters(mesh.nodes, edgesOf(mesh), active);
    for (const std::vector<int>& cluster : clusters) {
        CHECK(cluster.size() >= 2);
        CHECK(cluster.size() <= 16);
        nodes += cluster.size();
        met.insert(cluster.begin(), cluster.end());
    }
    CHECK(met.size() == nodes);
    CHECK(nodes > 0.9 * 6.0 / 7.0 * static_cast<double>(active.size()));
    CHECK(std::ranges::all_of(met, [&](int node) { return active[static_cast<std::size_t>(node)]; }));
}

TEST_CASE("clusters of a thin sheet reach through its thickness")
{
    const geometry::TetMesh mesh = boxMesh({12, 12, 1}, {0.036, 0.036, 6e-4});
    std::vector<int> clusterOf(mesh.nodes.size(), -1);
    const auto clusters = nodeClusters(mesh.nodes, edgesOf(mesh), std::vector<bool>(mesh.nodes.size(), true));
    for (std::size_t k = 0; k < clusters.size(); ++k)
        for (int node : clusters[k]) clusterOf[static_cast<std::size_t>(node)] = static_cast<int>(k);
    for (const auto& [a, b] : edgesOf(mesh)) {
        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
        if (distance(mesh.nodes[i], mesh.nodes[j]) < 1e-3) CHECK(clusterOf[i] == clusterOf[j]);
    }
}

TEST_CASE("a thin sheet converges in few iterations")
{
    Stage stage;
    stage.add(sheet());
    const physics::StepReport report = stage.step(1e-3);
    REQUIRE(report.solves.size() == 1);
    INFO(report.solves[0].iterations);
    CHECK(report.solves[0].iterations <= 60);
}

TEST_CASE("clusters are rebuilt in the background as they are built at first")
{
    Stage stage;
    stage.add(sheet());
    stage.step(0.0);
    const SoftModel& model = stage.model();
    std::vector<int> nodes;
    for (std::size_t i = 0; i < model.rest.size(); ++i)
        if (!model.pins.hard[i]) nodes.push_back(static_cast<int>(i));
    const PreconditionerPlan plan{.nodes = nodes,
                                  .scale = 1e4,
                                  .period = 1e-3,
                                  .blocks = linalg::blocksFor(static_cast<int>(nodes.size())),
                                  .clustered = true};
    linalg::TwoLevelPreconditioner built = preconditionerAtRest(model, plan, coarseChoiceAfterCut(nodes.size()));
    REQUIRE(built.hasClusters());
    BackgroundThread thread;
    CoarseRebuild remake(model, plan, thread);
    linalg::TwoLevelPreconditioner rebuilt = built;
    rebuilt.takeCoarseLevel(remake.take());
    rebuilt.setClusters(remake.takeClusters());
    REQUIRE(rebuilt.hasClusters());
    WorkerPool pool(1);
    linalg::NodeArray r(plan.blocks), a(plan.blocks), b(plan.blocks);
    for (int i = 0; i < static_cast<int>(nodes.size()); ++i) r[i][i % 3] = static_cast<float>(i % 5) - 2.0f;
    built.apply(r, a, pool);
    rebuilt.apply(r, b, pool);
    double largest = 0.0, off = 0.0;
    for (int i = 0; i < static_cast<int>(nodes.size()); ++i)
        for (int k = 0; k < 3; ++k) {
            largest = std::max(largest, std::abs(static_cast<double>(a[i][k])));
            REQUIRE(std::isfinite(b[i][k]));
            off = std::max(off, std::abs(static_cast<double>(a[i][k] - b[i][k])));
        }
    CHECK(largest > 0.0);
    CHECK(off <= 1e-4 * largest);
}

} // namespace node_clusters_test

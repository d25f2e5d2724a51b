#include "filasofia/engine/soft/coarse_rebuild.h"

#include "filasofia/core/worker_pool.h"

#include "engine/stage.h"

#include <latch>
#include <numeric>
#include <set>

namespace coarse_rebuild_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A block on pins and pin springs, with the plan that its preconditioner is built for.
struct Block {
    Stage stage;
    std::vector<int> nodes;
    PreconditionerPlan plan;

    explicit Block(const SoftMaterial& material = FemMaterial{.youngModulus = 5e3})
    {
        stage.add(SoftBodyDef{.mesh = shared(boxMesh({12, 8, 6}, {0.06, 0.04, 0.03}, 0.2)),
                              .material = material,
                              .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}},
                                              {.nodes = {100, 200}, .stiffness = 50.0}},
                              .dynamicTopology = true});
        stage.step(0.0);
        learn();
    }
    SoftModel& model() { return stage.model(); }
    void learn()
    {
        nodes.clear();
        for (std::size_t i = 0; i < model().rest.size(); ++i)
            if (!model().pins.hard[i]) nodes.push_back(static_cast<int>(i));
        const double mass = std::accumulate(model().masses.begin(), model().masses.end(), 0.0);
        plan = {.nodes = nodes,
                .scale = static_cast<double>(model().masses.size()) / mass,
                .period = 5e-3,
                .blocks = linalg::blocksFor(static_cast<int>(nodes.size()))};
    }
    /// Cuts upright in the plane x = 3.1 cm, all the way through.
    void cut()
    {
        const TriangleMeshSource mesh = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, -0.1, 0}, {0, 0.1, 0}, {0, 0.1, 0.1}, {0, -0.1, 0.1}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        const auto at = [](double z) { return Pose{.position = {0.031, 0.02, z}}; };
        const BodyId blade = stage.add(
            RigidBodyDef{.elements = {at(0.04)}, .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
        for (int i = 0; i <= 60; ++i) {
            stage.post(SetPose{blade, 0, at(0.04 - 1e-3 * i)});
            stage.step(1e-3);
        }
        learn();
    }
};

/// M^-1 of a rough vector.
std::vector<float> applied(linalg::TwoLevelPreconditioner& preconditioner, std::size_t nodes)
{
    const int blocks = linalg::blocksFor(static_cast<int>(nodes));
    linalg::NodeArray r(blocks), z(blocks);
    std::mt19937 random(1);
    for (int i = 0; i < static_cast<int>(nodes); ++i)
        for (int k = 0; k < 3; ++k) r[i][k] = static_cast<float>(random()) / 4294967296.0f - 0.3f;
    WorkerPool pool(1);
    preconditioner.apply(r, z, pool);
    return {z.data(), z.data() + 4 * nodes};
}

} // namespace

TEST_CASE("a rebuilt coarse level equals the one that the body would be built with")
{
    for (const auto& [cut, springs] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
        INFO((cut ? "cut" : "whole") << (springs ? " springs" : " elements"));
        Block block(springs ? SoftMaterial(MassSpringMaterial{.stiffness = 20.0, .damping = 0.05})
                            : SoftMaterial(FemMaterial{.youngModulus = 5e3}));
        if (cut) block.cut();
        linalg::TwoLevelPreconditioner expected = preconditionerAtRest(block.model(), block.plan,
                                                                       coarseChoiceAfterCut(block.nodes.size())),
                                       other = expected;
        BackgroundThread thread;
        CoarseRebuild remake(block.model(), block.plan, thread);
        linalg::CoarseLevel&& made = remake.take();
        REQUIRE(expected.coarseNodes() > 10);
        REQUIRE(made.coarseNodes() == expected.coarseNodes());
        other.takeCoarseLevel(std::move(made));
        const std::vector<float> a = applied(expected, block.nodes.size()), b = applied(other, block.nodes.size());
        float largest = 0.0f, off = 0.0f;
        for (std::size_t i = 0; i < a.size(); ++i) {
            largest = std::max(largest, std::abs(a[i]));
            off = std::max(off, std::abs(a[i] - b[i]));
        }
        CHECK(off < 1e-5f * largest);
    }
}

TEST_CASE("a rebuilt coarse level is bit-identical on any thread")
{
    Block block;
    block.cut();
    std::vector<std::vector<float>> results;
    for (const bool busy : {false, true}) {
        std::latch hold(1);
        BackgroundThread thread;
        if (busy) thread.submit(std::make_shared<BackgroundJob>([&] { hold.wait(); }));
        CoarseRebuild remake(block.model(), block.plan, thread);
        linalg::TwoLevelPreconditioner preconditioner =
            preconditionerAtRest(block.model(), block.plan, coarseChoiceAfterCut(block.nodes.size()));
        preconditioner.takeCoarseLevel(remake.take()); // built on this thread if the background thread is busy
        hold.count_down();
        results.push_back(applied(preconditioner, block.nodes.size()));
    }
    CHECK(results[0] == results[1]);
}

TEST_CASE("separated parts share no coarse nodes after the coarse level is rebuilt")
{
    Block block;
    const auto sidesOfCoarseNodes = [&] {
        BackgroundThread thread;
        CoarseRebuild remake(block.model(), block.plan, thread);
        const linalg::CoarseLevel made = remake.take();
        std::array<std::set<int>, 2> sides;
        for (std::size_t i = 0; i < block.nodes.size(); ++i) {
            // A node of the cut itself lies on the side of its elements' centre.
            Vec3 middle;
            double count = 0.0;
            for (const FemElement& element : block.model().elements)
                if (std::ranges::find(element.nodes, block.nodes[i]) != element.nodes.end())
                    for (int node : element.nodes) {
                        middle += block.model().rest[static_cast<std::size_t>(node)];
                        count += 1.0;
                    }
            const linalg::Interpolation how = made.interpolation(static_cast<int>(i));
            for (std::size_t k = 0; k < 4; ++k)
                if (how.weights[k] != 0.0f) sides[middle.x / count > 0.031 ? 1 : 0].insert(how.corners[k]);
        }
        std::vector<int> both;
        std::ranges::set_intersection(sides[0], sides[1], std::back_inserter(both));
        return both.size();
    };
    CHECK(sidesOfCoarseNodes() > 5);
    block.cut();
    CHECK(sidesOfCoarseNodes() == 0);
}

TEST_CASE("the motion of a cut body is the same for any number of threads, while its coarse level is rebuilt and after")
{
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 5}) {
        Stage stage({.period = 1e-3, .threads = threads});
        stage.add(SoftBodyDef{.mesh = shared(boxMesh({8, 6, 5}, {0.06, 0.04, 0.03}, 0.2)),
                              .material = FemMaterial{.youngModulus = 5e3},
                              .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}}},
                              .dynamicTopology = true});
        const TriangleMeshSource mesh = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, -0.1, 0}, {0, 0.1, 0}, {0, 0.1, 0.1}, {0, -0.1, 0.1}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        const auto at = [](double z) { return Pose{.position = {0.031, 0.02, z}}; };
        const BodyId blade = stage.add(
            RigidBodyDef{.elements = {at(0.04)}, .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
        stage.post(SetGravity{{3, 0, -9.81}});
        for (int i = 0; i < 200; ++i) {
            stage.post(SetPose{blade, 0, at(std::max(0.01, 0.04 - 5e-4 * i))});
            stage.step(1e-3);
        }
        hashes.push_back(stage.world.hash());
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
}

} // namespace coarse_rebuild_test

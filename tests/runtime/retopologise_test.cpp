#include "shown_stage.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/surface.h"

#include <atomic>
#include <latch>

namespace retopologise_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// The boundary of the block without its last `removed` tetrahedra, as after a cut. Nodes keep their numbers.
SharedSurface boundaryWithout(int removed)
{
    geometry::TetMesh rest = *ShownStage::mesh();
    rest.tetrahedra.resize(rest.tetrahedra.size() - static_cast<std::size_t>(removed));
    return std::make_shared<const mapping::MappedSurface>(mapping::mapBoundary(rest));
}

/// The result of setMesh for a surface at the body's present positions.
struct Synchronous {
    visual::VisualServer server{{.backend = visual::Backend::Null}};
    visual::VisualBody& body;

    Synchronous(const mapping::MappedSurface& surface, const frame::SoftBodyFrame& frame, int level)
        : body(server.add(defOf(level)))
    {
        geometry::TriangleMesh now = surface.surface;
        mapping::apply(surface.map, frame, now.vertices);
        body.setMesh(now, surface.surface.vertices);
    }
    static visual::VisualBodyDef defOf(int level)
    {
        visual::VisualBodyDef def;
        def.mesh = *geometry::shapes::sphere(0.01, 1);
        def.subdivision = level;
        return def;
    }
    const visual::BodyGeometry& geometry() { return ShownStage::drawn(server).front()->geometry; }
};

bool same(const visual::BodyGeometry& a, const visual::BodyGeometry& b)
{
    return a.rest == b.rest && a.indices == b.indices && a.vertices.positions == b.vertices.positions;
}

/// Lets jobs pass one by one, and records which came.
struct Gate {
    std::mutex mutex;
    std::condition_variable changed;
    int open = 0;
    int begun = 0;
    std::vector<SharedSurface> made;

    MeshResult operator()(const MeshJob& job)
    {
        std::unique_lock lock(mutex);
        ++begun;
        changed.notify_all();
        changed.wait(lock, [&] { return open > 0; });
        --open;
        made.push_back(job.to);
        return prepareMesh(job);
    }
    void letThrough(int jobs)
    {
        const std::lock_guard lock(mutex);
        open += jobs;
        changed.notify_all();
    }
    void awaitBegun(int jobs)
    {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return begun >= jobs; });
    }
};

} // namespace

TEST_CASE("new triangles come out as setMesh would make them, one topology after another, at any level")
{
    for (const int level : {0, 1, 2}) {
        ShownStage stage;
        const BodyId block = stage.addBlock();
        stage.bindings.show(block, {.subdivision = level}, stage.physics);
        stage.physics.setGravity({1, -9, 2});
        stage.step();
        for (const int removed : {6, 12, 18}) {
            const SharedSurface surface = boundaryWithout(removed);
            stage.bindings.retopologise(block, surface);
            stage.bindings.finishMeshes();
            stage.step();
            const auto frame = stage.physics.latest();
            Synchronous expected(*surface, *frame->softBody(block), level);
            CHECK(same(stage.only().geometry, expected.geometry()));
            stage.step(); // and it keeps following
            Synchronous next(*surface, *stage.physics.latest()->softBody(block), level);
            CHECK(same(stage.only().geometry, next.geometry()));
        }
        CHECK(stage.only().geometryCalls == 3);
    }
}

TEST_CASE("until new triangles are ready the old ones follow their nodes, whole")
{
    auto gate = std::make_shared<Gate>();
    ShownStage stage([gate](const MeshJob& job) { return (*gate)(job); });
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {.subdivision = 1}, stage.physics);
    stage.physics.setGravity({0, -9, 0});
    stage.step();
    const auto indices = stage.only().geometry.indices;
    stage.bindings.retopologise(block, boundaryWithout(6));
    stage.map();
    gate->awaitBegun(1);
    const SharedSurface old = boundaryWithout(0);
    for (int i = 0; i < 5; ++i) {
        stage.step();
        CHECK(stage.only().geometry.indices == indices);
        Synchronous expected(*old, *stage.physics.latest()->softBody(block), 1);
        CHECK(same(stage.only().geometry, expected.geometry()));
    }
    gate->letThrough(1);
    stage.bindings.finishMeshes();
    stage.map();
    CHECK(stage.only().geometry.indices != indices);
}

TEST_CASE("a newer edit takes the place of one that waits, not of one that is at work")
{
    auto gate = std::make_shared<Gate>();
    ShownStage stage([gate](const MeshJob& job) { return (*gate)(job); });
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    stage.step();
    const SharedSurface first = boundaryWithout(6), second = boundaryWithout(12), third = boundaryWithout(18);
    stage.bindings.retopologise(block, first);
    stage.map();
    gate->awaitBegun(1);
    stage.bindings.retopologise(block, second);
    stage.map();
    stage.bindings.retopologise(block, third);
    stage.map();
    gate->letThrough(1);
    gate->awaitBegun(2); // the first is done, the second is at work
    stage.step();
    CHECK(stage.only().geometryCalls == 1);
    CHECK(stage.only().geometry.rest.size() == first->surface.vertices.size());
    gate->letThrough(1);
    stage.bindings.finishMeshes();
    stage.step();
    CHECK(gate->made == std::vector<SharedSurface>{first, third});
    CHECK(stage.only().geometryCalls == 2);
    Synchronous expected(*third, *stage.physics.latest()->softBody(block), 0);
    CHECK(same(stage.only().geometry, expected.geometry()));
}

TEST_CASE("paint stays where it was through new triangles, also through ones that nobody saw")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    const PaintDef mark{.place = {-0.02, -0.03, -0.04}, .atRest = true, .radius = 0.03, .state = {1, 0, 0.5}};
    stage.bindings.paint(block, mark, stage.physics);
    stage.step();
    const auto stateAt = [&](visual::Float3 rest) {
        const auto& body = stage.only();
        const auto at = std::find(body.geometry.rest.begin(), body.geometry.rest.end(), rest);
        REQUIRE(at != body.geometry.rest.end());
        return body.states[static_cast<std::size_t>(at - body.geometry.rest.begin())];
    };
    const visual::Float3 corner = visual::toFloat3(ShownStage::mesh()->nodes.front());
    const visual::PackedState before = stateAt(corner);
    CHECK(before[0] == 255);
    // Two edits; the picture takes only the last.
    for (const int removed : {6, 12}) {
        stage.bindings.retopologise(block, boundaryWithout(removed));
        stage.bindings.finishMeshes();
    }
    stage.step();
    CHECK(stage.only().geometryCalls == 1);
    CHECK(stateAt(corner) == before);
    // New paint goes onto the new triangles.
    PaintDef more = mark;
    more.place = {0.02, -0.03, -0.04};
    stage.bindings.paint(block, more, stage.physics);
    stage.step();
    CHECK(stateAt(visual::toFloat3(more.place))[0] == 255);
}

TEST_CASE("a body that was cut before it is shown is shown cut")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    const SharedSurface cut = boundaryWithout(12);
    stage.bindings.retopologise(block, cut);
    stage.step();
    stage.bindings.show(block, {.subdivision = 1}, stage.physics);
    stage.step();
    stage.bindings.finishMeshes();
    stage.step();
    Synchronous expected(*cut, *stage.physics.latest()->softBody(block), 1);
    CHECK(same(stage.only().geometry, expected.geometry()));
}

TEST_CASE("a body that is shown as another surface keeps it, one removed while its triangles are made is forgotten")
{
    auto gate = std::make_shared<Gate>();
    ShownStage stage([gate](const MeshJob& job) { return (*gate)(job); });
    const BodyId block = stage.addBlock();
    const auto skin = geometry::shapes::sphere(0.015, 4);
    stage.bindings.show(block, {.surface = skin}, stage.physics);
    const ShownId own = stage.bindings.show(block, {}, stage.physics);
    stage.step();
    stage.bindings.retopologise(block, boundaryWithout(6));
    stage.map();
    gate->awaitBegun(1);
    stage.bindings.remove(own);
    stage.map();
    gate->letThrough(1);
    stage.bindings.finishMeshes();
    stage.step();
    CHECK(stage.only().geometryCalls == 0);
    CHECK(stage.only().geometry.rest.size() == skin->vertices.size());
}

TEST_CASE("new triangles on nodes that the frame does not have yet wait for them")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    stage.step();
    auto ahead = std::make_shared<mapping::MappedSurface>(*boundaryWithout(0));
    std::get<mapping::IdentityMap>(ahead->map).nodes[0] = static_cast<int>(ShownStage::mesh()->nodes.size());
    stage.bindings.retopologise(block, ahead);
    stage.bindings.finishMeshes();
    stage.step();
    CHECK(stage.only().geometryCalls == 0);
    CHECK(stage.only().vertexCalls == 2);
}

TEST_CASE("a cut surface that cannot be subdivided is drawn without subdivision, with a warning")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    {
        ShownStage stage;
        const BodyId block = stage.addBlock();
        stage.bindings.show(block, {.subdivision = 2}, stage.physics);
        stage.step();
        auto torn = std::make_shared<mapping::MappedSurface>(*boundaryWithout(0));
        torn->surface.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
        stage.bindings.retopologise(block, torn);
        stage.bindings.finishMeshes();
        stage.step();
        CHECK(stage.only().geometry.indices.size() == 9);
        // An invalid surface changes nothing.
        auto wrong = std::make_shared<mapping::MappedSurface>(*torn);
        wrong->surface.triangles = {{0, 1, -1}};
        stage.bindings.retopologise(block, wrong);
        stage.bindings.finishMeshes();
        stage.step();
        CHECK(stage.only().geometry.indices.size() == 9);
    }
    setLogSink({});
    REQUIRE(lines.size() == 2);
    CHECK_THAT(lines[0], Catch::Contains("drawn without subdivision"));
    CHECK_THAT(lines[1], Catch::Contains("new triangles of 'block'"));
}

TEST_CASE("finishMeshes() waits for the triangles of the newest frame, even if no picture was mapped since")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {.subdivision = 1}, stage.physics);
    stage.step();
    const SharedSurface cut = boundaryWithout(12);
    frame::Frame newest = *stage.physics.latest();
    auto boundary = std::make_shared<frame::Boundary>();
    const geometry::TetMesh rest = *ShownStage::mesh();
    boundary->revision = 1;
    boundary->rest = rest.nodes;
    const std::vector<int>& nodes = std::get<mapping::IdentityMap>(cut->map).nodes;
    for (const auto& [a, b, c] : cut->surface.triangles) boundary->triangles.push_back({nodes[a], nodes[b], nodes[c]});
    boundary->opened.assign(boundary->triangles.size(), 0);
    newest.softBodies[0].boundary = boundary;

    stage.bindings.finishMeshes(&newest);
    stage.bindings.addPending(stage.visual);
    stage.bindings.update(newest, stage.physics, stage.visual);
    Synchronous expected(*cut, *newest.softBody(block), 1);
    CHECK(stage.only().geometry.indices.size() == expected.geometry().indices.size());
    CHECK(stage.only().geometryCalls == 1);
}

TEST_CASE("bindings may end while triangles are being made")
{
    std::latch begun(1);
    std::atomic<int> jobsBegun = 0, jobsEnded = 0;
    for (int i = 0; i < 3; ++i) {
        ShownStage stage([&](const MeshJob& job) {
            ++jobsBegun;
            if (i == 0) begun.count_down();
            MeshResult result = prepareMesh(job);
            ++jobsEnded;
            return result;
        });
        const BodyId block = stage.addBlock();
        stage.bindings.show(block, {.subdivision = 2}, stage.physics);
        stage.step();
        stage.bindings.retopologise(block, boundaryWithout(6));
        stage.map();
        begun.wait();
    }
    CHECK(jobsBegun.load() >= 1);
    CHECK(jobsEnded.load() == jobsBegun.load()); // no job was running when its bindings had ended
}

} // namespace retopologise_test

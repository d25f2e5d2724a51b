#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/topology/apply_edit.h"

#include "engine/meshes.h"

#include "filasofia/geometry/adjacency.h"

#include <map>
#include <numeric>

namespace apply_edit_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A body with everything that belongs to it, edited at random.
struct Edited {
    SoftBody body;
    std::mt19937 random{5};

    explicit Edited(const SoftBodyDef& def)
    {
        auto built = buildBody(def, 1e-3);
        body = std::move(dynamic_cast<BuiltSoftBody&>(*built).body);
        for (std::size_t i = 0; i < body.state.x.size(); ++i) {
            if (body.model.pins.hard[i]) continue;
            body.state.x[i] += randomVec3(random, 2e-4);
            body.state.v[i] = randomVec3(random, 0.1);
            body.state.dv[i] = randomVec3(random, 1e-3);
            body.state.residual[i] = randomVec3(random, 1e-9);
        }
        body.topology.mesh->placeAt(body.state.x);
    }

    int pick(int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); }

    void bisectSome(int tries)
    {
        EditableMesh& mesh = *body.topology.mesh;
        for (int i = 0; i < tries; ++i) {
            const geometry::Tetrahedron t = mesh.data().tetrahedra[static_cast<std::size_t>(pick(mesh.tetrahedra()))];
            const auto a = static_cast<std::size_t>(pick(4)), b = (a + 1 + static_cast<std::size_t>(pick(3))) % 4;
            std::vector<int> star;
            edgeStar(mesh.data(), t[a], t[b], star);
            const double s = 0.3 + 0.1 * pick(5);
            if (mesh.qualityAfterBisecting(t[a], t[b], s, star) > 0.05) mesh.bisect(t[a], t[b], s);
        }
    }

    /// Opens a random set of faces around some nodes, after sliding one of them.
    void splitSome(int tries)
    {
        EditableMesh& mesh = *body.topology.mesh;
        for (int i = 0; i < tries; ++i) {
            const int node = pick(mesh.nodes());
            for (int t : std::vector<int>(mesh.data().around[static_cast<std::size_t>(node)]))
                for (int face = 0; face < 4; ++face)
                    if (pick(2) == 0 &&
                        mesh.data().neighbours[static_cast<std::size_t>(t)][static_cast<std::size_t>(face)] >= 0)
                        mesh.setFlagged(t, face, true);
            mesh.split(node);
            mesh.commit();
        }
    }

    /// Slides a node so that every element around it keeps a good shape: one that the edit has made, if `made`.
    void slideOne(bool made)
    {
        EditableMesh& mesh = *body.topology.mesh;
        const int known = static_cast<int>(body.model.rest.size());
        for (int tries = 0; tries < 400; ++tries) {
            const int node = pick(mesh.nodes());
            if (made != (node >= known)) continue;
            const auto& around = mesh.data().around[static_cast<std::size_t>(node)];
            const geometry::Tetrahedron t = mesh.data().tetrahedra[static_cast<std::size_t>(around.front())];
            const int toward = t[0] == node ? t[1] : t[0];
            if (onBoundary(mesh.data(), node) || (!made && body.model.pins.hard[static_cast<std::size_t>(node)]))
                continue;
            mesh.slide(node, toward, 0.05);
            return;
        }
    }

    void apply() { applyEdit(body.topology.mesh->takeEdit({}), 1e-3, body); }

    [[nodiscard]] Vec3 momentum() const
    {
        Vec3 sum;
        for (std::size_t i = 0; i < body.model.masses.size(); ++i) sum += body.model.masses[i] * body.state.v[i];
        return sum;
    }
};

SoftBodyDef pinnedBlock()
{
    return {.mesh = shared(boxMesh({6, 4, 3}, {0.06, 0.04, 0.03}, 0.2)),
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
            .dynamicTopology = true};
}

/// The largest difference relative to the largest value.
double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double most = 0.0, size = 1e-300;
    for (std::size_t i = 0; i < a.size(); ++i) {
        most = std::max(most, length(a[i] - b[i]));
        size = std::max(size, length(b[i]));
    }
    return most / size;
}

/// The result of one step of a system, which depends on everything that an edit changes.
std::vector<Vec3> stepOf(const SoftModel& model, SoftState state, MatrixFreeSystem& system)
{
    WorkerPool pool(1);
    std::vector<Vec3> given(model.rest.size(), {0, -1e-3, 0});
    system.assemble(model, given, 1e-3, 1.0, state, pool);
    std::vector<Vec3> dv(model.rest.size()), residual(model.rest.size());
    const auto report = system.solve({.tolerance = 1e-7, .maxIterations = 5000}, 0, dv, residual, pool);
    CHECK(report.converged);
    return dv;
}

} // namespace

TEST_CASE("a solver that followed edits gives the same result as a rebuilt one")
{
    const bool springs = GENERATE(false, true);
    SoftBodyDef def = pinnedBlock();
    if (springs) def.material = MassSpringMaterial{.stiffness = 30.0, .damping = 0.1};
    INFO((springs ? "springs" : "elements"));
    Edited edited(def);
    for (int round = 0; round < 12; ++round) {
        if (round % 3 != 2) edited.bisectSome(6);
        if (round % 3 != 0) edited.splitSome(4);
        if (round % 3 == 2) edited.slideOne(false);
        edited.apply();
        const SoftModel& model = edited.body.model;
        check(model, edited.body.state);
        SoftSystem fresh = makeSystem(model, 1e-3);
        const double apart = difference(stepOf(model, edited.body.state, *edited.body.system.matrixFree),
                                        stepOf(model, edited.body.state, *fresh.matrixFree));
        CHECK(apart < 5e-5);
        CHECK(edited.body.system.held.elements == fresh.held.elements);
        CHECK(edited.body.system.held.springs == fresh.held.springs);
        CHECK(edited.body.system.held.holders == fresh.held.holders);
    }
    CHECK(edited.body.model.rest.size() > pinnedBlock().attachments.size());
    CHECK(edited.body.model.elements.size() + edited.body.model.tetrahedra.size() > 500);
}

TEST_CASE("an edit conserves mass and momentum, and every element's shape and mass are correct")
{
    Edited edited(pinnedBlock());
    const SoftModel start = edited.body.model;
    const double mass = std::accumulate(start.masses.begin(), start.masses.end(), 0.0);
    for (int round = 0; round < 10; ++round) {
        const Vec3 before = edited.momentum();
        edited.bisectSome(5);
        edited.splitSome(5);
        if (round % 2 == 0) edited.slideOne(false);
        edited.apply();
        const SoftModel& model = edited.body.model;
        CHECK(length(edited.momentum() - before) < 1e-12 * mass);
        CHECK(std::accumulate(model.masses.begin(), model.masses.end(), 0.0) == Approx(mass).epsilon(1e-12));
        std::vector<double> masses(model.rest.size());
        for (const FemElement& element : model.elements) {
            for (int node : element.nodes)
                masses[static_cast<std::size_t>(node)] += 0.25 * element.volume * model.density;
            Mat3 f;
            for (std::size_t k = 0; k < 4; ++k)
                f += outer(model.rest[static_cast<std::size_t>(element.nodes[k])], element.gradients[k]);
            for (std::size_t k = 0; k < 3; ++k) CHECK(length(f[k] - Mat3::identity()[k]) < 1e-9);
        }
        for (std::size_t i = 0; i < masses.size(); ++i) CHECK(model.masses[i] == Approx(masses[i]).epsilon(1e-9));
    }
}

// Its place was written before the arrays had it, which only a sanitizer sees: they get it later anyway.
TEST_CASE("a node that an edit makes and then slides is where the mesh has it")
{
    Edited edited(pinnedBlock());
    const std::size_t before = edited.body.model.rest.size();
    edited.bisectSome(30);
    edited.slideOne(true);
    const auto edit = edited.body.topology.mesh->takeEdit({});
    const auto moved = std::ranges::find_if(
        edit.ops, [](const frame::TopologyOp& op) { return std::holds_alternative<frame::NodeMove>(op); });
    REQUIRE(moved != edit.ops.end());
    const auto node = static_cast<std::size_t>(std::get<frame::NodeMove>(*moved).node);
    REQUIRE(node >= before);
    applyEdit(edit, 1e-3, edited.body);
    CHECK(edited.body.state.x[node] == edited.body.topology.mesh->data().current[node]);
    CHECK(edited.body.model.rest[node] == std::get<frame::NodeMove>(*moved).newRest);
}

TEST_CASE("the published boundary is the surface of the edited elements")
{
    Edited edited(pinnedBlock());
    for (int round = 0; round < 8; ++round) {
        edited.bisectSome(5);
        edited.splitSome(6);
        edited.apply();
        const SoftModel& model = edited.body.model;
        const auto seen = boundaryOf(edited.body.model, edited.body.topology);
        const frame::Boundary& boundary = *seen;
        CHECK(boundary.revision == static_cast<std::uint64_t>(round) + 1);
        CHECK(boundary.triangles == model.surface);
        CHECK(boundary.rest == model.rest);
        // Every face that belongs to one element only, and no other, with its element behind it.
        std::map<geometry::Triangle, int> faces;
        for (const FemElement& element : model.elements)
            for (const auto& at : geometry::kTetrahedronFaces) {
                geometry::Triangle key{element.nodes[at[0]], element.nodes[at[1]], element.nodes[at[2]]};
                std::ranges::sort(key);
                ++faces[key];
            }
        std::erase_if(faces, [](const auto& each) { return each.second != 1; });
        CHECK(faces.size() == model.surface.size());
        double volume = 0.0, expected = 0.0;
        for (geometry::Triangle t : model.surface) {
            volume += dot(model.rest[t[0]], cross(model.rest[t[1]], model.rest[t[2]])) / 6.0;
            std::ranges::sort(t);
            CHECK(faces.count(t) == 1);
        }
        for (const FemElement& element : model.elements) expected += element.volume;
        CHECK(volume == Approx(expected).epsilon(1e-9));
    }
}

TEST_CASE("a mass-spring body has a spring on every edge after an edit too")
{
    SoftBodyDef def = pinnedBlock();
    def.material = MassSpringMaterial{.stiffness = 30.0, .damping = 0.1};
    Edited edited(def);
    for (int round = 0; round < 12; ++round) {
        edited.bisectSome(5);
        edited.splitSome(5);
        if (round % 2 == 0) edited.slideOne(false);
        edited.apply();
        const SoftModel& model = edited.body.model;
        check(model, edited.body.state);
        const auto edges = geometry::edges({model.rest, model.tetrahedra});
        REQUIRE(model.springs.size() == edges.size());
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const Spring& spring = model.springs[i];
            CHECK(spring.nodes == edges[i]);
            CHECK(spring.stiffness == 30.0);
            CHECK(spring.damping == 0.1);
            CHECK(spring.restLength == distance(model.rest[spring.nodes[0]], model.rest[spring.nodes[1]]));
        }
    }
}

} // namespace apply_edit_test

#include "filasofia/engine/collision/proximity.h"
#include "filasofia/engine/scene/check_scene.h"
#include "filasofia/engine/topology/edit_collision.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"

#include "engine/stage.h"

#include <map>
#include <set>

namespace edit_collision_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

physics::RigidBodyDef plate(Vec3 at)
{
    physics::RigidBodyDef def{.elements = {Pose{at, {}}}, .mesh = geometry::shapes::box({0.1, 0.02, 0.1})};
    def.collision = {{}};
    return def;
}

physics::SoftBodyDef block(const geometry::TetMesh& mesh)
{
    physics::SoftBodyDef def{.name = "block", .mesh = shared(mesh)};
    def.collision = {{}};
    return def;
}

/// The corners of a feature as node numbers.
std::vector<int> nodesOf(const CollisionModel& model, int feature)
{
    const CollisionShape& shape = *model.shape;
    std::vector<int> nodes;
    if (feature < shape.edgeFeature(0))
        nodes = {feature};
    else if (feature < shape.triangleFeature(0))
        nodes.assign(shape.edges[feature - shape.edgeFeature(0)].begin(),
                     shape.edges[feature - shape.edgeFeature(0)].end());
    else
        nodes.assign(shape.triangles[feature - shape.triangleFeature(0)].begin(),
                     shape.triangles[feature - shape.triangleFeature(0)].end());
    for (int& node : nodes) node = model.embedding.nodes[static_cast<std::size_t>(node)][0];
    std::ranges::sort(nodes);
    return nodes;
}

/// The features of the soft body in contact, by their nodes, and the forces there.
std::map<std::vector<int>, double> contactsOf(const CollisionModel& model, const Scene& scene)
{
    std::map<std::vector<int>, double> found;
    for (const CachedContact& each : scene.contacts) {
        const bool first = each.first == BodyId{2};
        const FeaturePair pair = featurePair(each.feature);
        found[nodesOf(model, pair.features[first ? 0 : 1])] += length(each.force);
    }
    return found;
}

using Faces = std::set<std::array<int, 3>>;

/// A face's nodes, rotated so that the lowest comes first.
std::array<int, 3> lowestFirst(std::array<int, 3> face)
{
    std::rotate(face.begin(), std::ranges::min_element(face), face.end());
    return face;
}

/// The node of a face's tetrahedron that is not on it.
int nodeBehind(const std::vector<geometry::Tetrahedron>& tetrahedra, const std::array<int, 3>& face)
{
    for (const geometry::Tetrahedron& t : tetrahedra) {
        int inside = 0, other = -1;
        for (const int node : t) std::ranges::find(face, node) != face.end() ? ++inside : other = node;
        if (inside == 3) return other;
    }
    return -1;
}

/// The edit from one mesh's surface to that of another mesh with the same nodes.
OwnSurfaceEdit editBetween(const geometry::TetMesh& from, const geometry::TetMesh& to)
{
    const geometry::Surface old = geometry::extractSurface(from), now = geometry::extractSurface(to);
    const auto facesOf = [](const geometry::Surface& surface) {
        Faces faces;
        for (const geometry::Triangle& t : surface.mesh.triangles)
            faces.insert(lowestFirst({surface.nodes[t[0]], surface.nodes[t[1]], surface.nodes[t[2]]}));
        return faces;
    };
    const Faces were = facesOf(old), are = facesOf(now);
    OwnSurfaceEdit edit;
    std::vector<std::array<int, 3>> left, fresh;
    std::map<int, int> vertexOf;
    for (std::size_t v = 0; v < old.nodes.size(); ++v) vertexOf[old.nodes[v]] = static_cast<int>(v);
    for (std::size_t t = 0; t < old.mesh.triangles.size(); ++t) {
        const geometry::Triangle& corners = old.mesh.triangles[t];
        const auto face = lowestFirst({old.nodes[corners[0]], old.nodes[corners[1]], old.nodes[corners[2]]});
        if (are.contains(face))
            left.push_back(face);
        else
            edit.surface.removed.push_back(static_cast<int>(t));
    }
    for (std::array<int, 3> face : are) {
        if (were.contains(face)) continue;
        const std::array<int, 3> nodes = face;
        for (int& node : face) {
            if (!vertexOf.contains(node)) {
                vertexOf[node] = static_cast<int>(old.nodes.size() + edit.nodes.size());
                edit.nodes.push_back(node);
                edit.surface.vertices.push_back(to.nodes[node]);
            }
            node = vertexOf[node];
        }
        edit.surface.added.push_back(face);
        fresh.push_back(nodes);
    }
    for (const auto& faces : {left, fresh})
        for (const std::array<int, 3>& face : faces) edit.behind.push_back(nodeBehind(to.tetrahedra, face));
    return edit;
}

/// The mesh without the tetrahedra whose centres lie in the box.
geometry::TetMesh without(geometry::TetMesh mesh, const geometry::Box& box)
{
    std::erase_if(mesh.tetrahedra, [&](const geometry::Tetrahedron& t) {
        Vec3 middle;
        for (const int node : t) middle += 0.25 * mesh.nodes[node];
        return merged(box, middle) == box;
    });
    return mesh;
}

} // namespace

TEST_CASE("contacts on features that an edit leaves keep their forces, and the others are erased")
{
    const geometry::TetMesh mesh = boxMesh({4, 4, 4}, {0.04, 0.04, 0.04});
    Stage stage;
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    stage.add(plate({0.02, -0.0103, 0.02}));
    stage.add(block(mesh));
    stage.run(300, 1e-3);
    const Scene& scene = stage.world.scene();
    const auto before = contactsOf(stage.model().collision[0], scene);
    REQUIRE(before.size() > 10);

    // Remove a corner at the floor and one at the top, so that numbers before and after them shift.
    geometry::TetMesh less = without(mesh, {{-1, -1, -1}, {0.0101, 0.0101, 0.0101}});
    less = without(less, {{0.0299, 0.0299, 0.0299}, {1, 1, 1}});
    REQUIRE(less.tetrahedra.size() == mesh.tetrahedra.size() - 12);
    const OwnSurfaceEdit edit = editBetween(mesh, less);
    REQUIRE(edit.surface.removed.size() > 10);
    REQUIRE(!edit.nodes.empty());
    editCollision(edit, 0, stage.model(), stage.world.scene());

    const CollisionModel& now = stage.model().collision[0];
    const auto after = contactsOf(now, scene);
    std::size_t gone = 0;
    for (const auto& [nodes, force] : before) {
        const auto found = after.find(nodes);
        if (found == after.end())
            ++gone;
        else
            CHECK(found->second == force);
    }
    CHECK(gone > 0);
    CHECK(after.size() == before.size() - gone);
    CHECK(after.size() > 5);
    CHECK(std::ranges::is_sorted(scene.contacts, {}, &CachedContact::feature));

    for (std::size_t t = 0; t < now.behind.size(); ++t) { // oriented outwards from its tetrahedron
        const auto [a, b, c] = now.shape->triangles[t];
        const auto x = [&](int v) { return mesh.nodes[now.embedding.nodes[static_cast<std::size_t>(v)][0]]; };
        CHECK(geometry::signedVolume(x(a), x(b), x(c), mesh.nodes[now.behind[t]]) < 0.0);
    }
    check(stage.model(), stage.soft());
    CHECK_NOTHROW(checkContacts(scene));
    CHECK_FALSE(stage.step(1e-3).has(physics::StepFlag::Undone));
    CHECK(!scene.contactReports.empty());
}

TEST_CASE("after a cut every triangle of the surface knows the node behind it")
{
    // A cut gave elements behind the old surface copies of their nodes. Their triangles kept the nodes of the other
    // lip, and contacts were taken to be on inverted elements, in every third step: a cut vessel never rested.
    Stage stage;
    physics::SoftBodyDef def = block(boxMesh({4, 4, 4}, {0.04, 0.04, 0.04}));
    def.gravity = false;
    def.dynamicTopology = true;
    stage.add(def);
    auto sheet = std::make_shared<geometry::TriangleMesh>();
    sheet->vertices = {{0.021, 0, -0.03}, {0.021, 0, 0.07}, {0.021, 0.05, 0.02}};
    sheet->triangles = {{0, 1, 2}};
    const BodyId blade = stage.add(
        physics::RigidBodyDef{.elements = {{{0, 0.05, 0}, {}}}, .mesh = sheet, .collision = {{.cutting = true}}});
    for (int i = 1; i <= 40; ++i) {
        stage.post(physics::SetPose{blade, 0, {{0, 0.05 - 0.001 * i, 0}, {}}});
        stage.step(1e-3);
    }
    const CollisionModel& now = stage.model().collision[0];
    REQUIRE(stage.model().opened);
    REQUIRE(now.behind.size() == now.shape->triangles.size());
    std::vector<geometry::Tetrahedron> tetrahedra;
    for (const FemElement& element : stage.model().elements) tetrahedra.push_back(element.nodes);
    int wrong = 0;
    for (std::size_t t = 0; t < now.behind.size(); ++t) {
        std::array<int, 3> face{};
        for (std::size_t k = 0; k < 3; ++k)
            face[k] = now.embedding.nodes[static_cast<std::size_t>(now.shape->triangles[t][k])][0];
        wrong += now.behind[t] != nodeBehind(tetrahedra, face);
    }
    CHECK(wrong == 0);
}

} // namespace edit_collision_test

#include "engine/rupture/meshes.h"

#include <functional>
#include <set>

namespace check_topology_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

std::set<std::string> faults(const MeshTopology& mesh, double volume)
{
    std::set<std::string> all;
    for (const TopologyViolation& v : checkTopology(mesh, {.quality = 0.15, .volume = volume, .maxViolations = 100000}))
        all.insert(name(v.fault));
    return all;
}

/// A bar cut half through.
EditableMesh cutBar()
{
    EditableMesh mesh = bar();
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report = sweep(mesh, stroke, {0.002, 0.02, -0.03}, {0.002, 0.02, 0.03}, {0, -0.0213, 0}, 40);
    finish(mesh, stroke, report);
    return mesh;
}

} // namespace

TEST_CASE("the checker finds every corruption that is planted, and names it")
{
    const EditableMesh mesh = cutBar();
    const double volume = mesh.startVolume();
    REQUIRE(faults(mesh.data(), volume).empty());
    const auto plant = [&](const char* fault, const std::function<void(MeshTopology&)>& corrupt) {
        MeshTopology bad = mesh.data();
        corrupt(bad);
        CAPTURE(fault);
        CHECK(faults(bad, volume).count(fault) == 1);
    };
    int inside = 0, face = 0, surface = 0, skin = 0; // an interior and a boundary face
    for (int t = 0; t < mesh.tetrahedra(); ++t)
        for (int f = 0; f < 4; ++f) {
            if (mesh.data().neighbours[t][f] >= 0)
                inside = t, face = f;
            else
                surface = t, skin = f;
        }
    const int node = mesh.data().tetrahedra[inside][face];
    plant("bad index", [&](MeshTopology& m) { m.tetrahedra[inside][face] = mesh.nodes(); });
    plant("bad index", [&](MeshTopology& m) { m.neighbours[inside][face] = -2; });
    plant("bad index", [&](MeshTopology& m) { m.labels.pop_back(); });
    plant("not finite", [&](MeshTopology& m) { m.current[3].y = std::numeric_limits<double>::quiet_NaN(); });
    plant("not positive", [&](MeshTopology& m) { std::swap(m.tetrahedra[inside][0], m.tetrahedra[inside][1]); });
    plant("overlap", [&](MeshTopology& m) { // a corner on the wrong side of the opposite face
        const auto& n = m.tetrahedra[inside];
        const Vec3 middle =
            (1.0 / 3.0) * (m.rest[n[(face + 1) % 4]] + m.rest[n[(face + 2) % 4]] + m.rest[n[(face + 3) % 4]]);
        m.rest[n[face]] = middle + 0.5 * (middle - m.rest[n[face]]);
    });
    plant("bad quality", [&](MeshTopology& m) {
        const auto& n = m.tetrahedra[inside];
        m.rest[n[0]] = (1.0 / 3.0) * (m.rest[n[1]] + m.rest[n[2]] + m.rest[n[3]]);
    });
    plant("volume", [&](MeshTopology& m) {
        for (Vec3& p : m.rest) p.x *= 1.01;
    });
    plant("shared face", [&](MeshTopology& m) { m.tetrahedra[inside] = m.tetrahedra[m.neighbours[inside][face]]; });
    plant("adjacency", [&](MeshTopology& m) { m.neighbours[inside][face] = -1; });
    plant("adjacency", [&](MeshTopology& m) { m.neighbours[surface][skin] = inside; });
    plant("masks", [&](MeshTopology& m) { m.flagged[inside] ^= static_cast<std::uint8_t>(1 << face); });
    plant("masks", [&](MeshTopology& m) { m.deferred[inside] ^= static_cast<std::uint8_t>(1 << face); });
    plant("masks", [&](MeshTopology& m) { m.opened[inside] ^= static_cast<std::uint8_t>(1 << face); });
    plant("masks", [&](MeshTopology& m) { m.flagged[surface] |= static_cast<std::uint8_t>(1 << skin); });
    plant("orphan", [&](MeshTopology& m) {
        m.rest.emplace_back(), m.current.emplace_back(), m.previous.emplace_back();
        m.around.emplace_back(), m.labels.emplace_back();
    });
    plant("node list", [&](MeshTopology& m) { m.around[node].pop_back(); });
    plant("node list", [&](MeshTopology& m) { m.around[node].push_back(m.around[node].front()); });
    // Elements joined at a node or an edge only: copies of a node on the open cut are merged again.
    int copies = 0, vertices = 0, edges = 0;
    for (int a = 0; a < mesh.nodes(); ++a)
        for (int b = a + 1; b < mesh.nodes(); ++b) {
            if (!(mesh.data().rest[a] == mesh.data().rest[b])) continue;
            ++copies;
            MeshTopology bad = mesh.data();
            for (geometry::Tetrahedron& t : bad.tetrahedra) std::ranges::replace(t, b, a);
            const auto found = faults(bad, volume);
            vertices += static_cast<int>(found.count("boundary vertex") + found.count("node fan"));
            edges += static_cast<int>(found.count("boundary edge"));
            CHECK(found.count("orphan") == 1);
        }
    CHECK(copies > 5);
    CHECK(vertices > 0);
    CHECK(edges > 0);
}

TEST_CASE("a mirror that missed an edit is detected")
{
    EditableMesh mesh = bar();
    const frame::TopologyMirror old(mesh.data().tetrahedra);
    CHECK(checkMirror(mesh.data(), old, mesh.data().rest).empty());
    const std::vector<Vec3> rest = mesh.data().rest;
    const geometry::Tetrahedron n = mesh.data().tetrahedra[0];
    mesh.bisect(n[0], n[1], 0.5);
    const auto found = checkMirror(mesh.data(), old, rest);
    REQUIRE(found.size() == 3);
    CHECK(found[0].fault == TopologyFault::MirrorElements);
    CHECK(found[1].fault == TopologyFault::MirrorPositions);
    CHECK(found[2].fault == TopologyFault::MirrorBoundary);
}

} // namespace check_topology_test

#include "filasofia/engine/rupture/check_topology.h"

#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/core/text.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

using geometry::Tetrahedron;

/// A face by its nodes, ascending, with the element that it belongs to.
struct Side {
    std::array<int, 3> nodes;
    int tetrahedron, face;
};

class Checker {
public:
    Checker(const MeshTopology& mesh, const TopologyBounds& bounds) : mesh_(mesh), bounds_(bounds) {}

    std::vector<TopologyViolation> run()
    {
        sizes();
        if (!found_.empty()) return found_; // later checks would index out of range
        elements();
        collectSides();
        faces();
        boundaryEdges();
        nodes();
        return found_;
    }

private:
    template <class... Parts> void add(TopologyFault fault, const Parts&... where)
    {
        if (found_.size() < bounds_.maxViolations) found_.push_back({fault, text(where...)});
    }

    [[nodiscard]] int tetrahedra() const { return static_cast<int>(mesh_.tetrahedra.size()); }
    [[nodiscard]] int nodeCount() const { return static_cast<int>(mesh_.rest.size()); }

    void sizes()
    {
        const std::size_t t = mesh_.tetrahedra.size(), n = mesh_.rest.size();
        if (mesh_.neighbours.size() != t || mesh_.flagged.size() != t || mesh_.deferred.size() != t ||
            mesh_.opened.size() != t || mesh_.sides.size() != t)
            add(TopologyFault::BadIndex, "lists of elements differ in length");
        if (mesh_.current.size() != n || mesh_.previous.size() != n || mesh_.around.size() != n ||
            mesh_.labels.size() != n)
            add(TopologyFault::BadIndex, "lists of nodes differ in length");
        if (!found_.empty()) return;
        for (int e = 0; e < tetrahedra(); ++e)
            for (int k = 0; k < 4; ++k) {
                const int node = mesh_.tetrahedra[e][k], other = mesh_.neighbours[e][k];
                if (node < 0 || node >= nodeCount()) add(TopologyFault::BadIndex, "element ", e, " has node ", node);
                if (other < -1 || other >= tetrahedra())
                    add(TopologyFault::BadIndex, "element ", e, " has neighbour ", other);
            }
    }

    void elements()
    {
        for (int n = 0; n < nodeCount(); ++n)
            if (!isFinite(mesh_.rest[n]) || !isFinite(mesh_.current[n]) || !isFinite(mesh_.previous[n]))
                add(TopologyFault::NotFinite, "node ", n);
        double sum = 0.0;
        for (int t = 0; t < tetrahedra(); ++t) {
            const double volume = restVolume(mesh_, t), q = restQuality(mesh_, t);
            sum += volume;
            if (!(volume > 0.0)) add(TopologyFault::NotPositive, "element ", t, " has ", volume, " m^3");
            if (!(q >= bounds_.quality * (1.0 - 1e-9)))
                add(TopologyFault::BadQuality, "element ", t, " has quality ", q);
        }
        if (!(std::abs(sum - bounds_.volume) <= bounds_.volumeTolerance * bounds_.volume))
            add(TopologyFault::Volume, sum, " m^3, not ", bounds_.volume);
    }

    void collectSides()
    {
        for (int t = 0; t < tetrahedra(); ++t)
            for (int f = 0; f < 4; ++f) {
                Side side{faceNodes(mesh_.tetrahedra[t], f), t, f};
                std::ranges::sort(side.nodes);
                sides_.push_back(side);
            }
        std::ranges::sort(sides_, [](const Side& a, const Side& b) {
            return std::tie(a.nodes, a.tetrahedron, a.face) < std::tie(b.nodes, b.tetrahedron, b.face);
        });
        boundary_.assign(mesh_.tetrahedra.size(), 0);
    }

    [[nodiscard]] static bool bit(std::uint8_t mask, int face) { return (mask >> face & 1) != 0; }

    void faces()
    {
        for (std::size_t i = 0, next = 0; i < sides_.size(); i = next) {
            while (next < sides_.size() && sides_[next].nodes == sides_[i].nodes) ++next;
            const Side& a = sides_[i];
            if (next - i > 2) {
                add(TopologyFault::SharedFace, "at element ", a.tetrahedron);
            } else if (next - i == 2) {
                pair(a, sides_[i + 1]);
            } else {
                boundary_[a.tetrahedron] = static_cast<std::uint8_t>(boundary_[a.tetrahedron] | 1u << a.face);
                if (mesh_.neighbours[a.tetrahedron][a.face] != -1)
                    add(TopologyFault::Adjacency, "boundary face ", a.face, " of element ", a.tetrahedron,
                        " has a neighbour");
                if (bit(mesh_.flagged[a.tetrahedron], a.face) || bit(mesh_.deferred[a.tetrahedron], a.face))
                    add(TopologyFault::Masks, "boundary face of element ", a.tetrahedron, " is marked for opening");
            }
        }
    }

    void pair(const Side& a, const Side& b)
    {
        if (mesh_.neighbours[a.tetrahedron][a.face] != b.tetrahedron ||
            mesh_.neighbours[b.tetrahedron][b.face] != a.tetrahedron)
            add(TopologyFault::Adjacency, "elements ", a.tetrahedron, " and ", b.tetrahedron);
        for (const auto* mask : {&mesh_.flagged, &mesh_.deferred})
            if (bit((*mask)[a.tetrahedron], a.face) != bit((*mask)[b.tetrahedron], b.face))
                add(TopologyFault::Masks, "elements ", a.tetrahedron, " and ", b.tetrahedron, " differ");
        if (bit(mesh_.opened[a.tetrahedron], a.face) || bit(mesh_.opened[b.tetrahedron], b.face))
            add(TopologyFault::Masks, "closed face of element ", a.tetrahedron, " counts as opened");
        const auto& x = mesh_.rest;
        const auto side = [&](const Side& s) {
            return geometry::signedVolume(x[a.nodes[0]], x[a.nodes[1]], x[a.nodes[2]],
                                          x[mesh_.tetrahedra[s.tetrahedron][s.face]]);
        };
        if ((side(a) > 0.0) == (side(b) > 0.0))
            add(TopologyFault::Overlap, "elements ", a.tetrahedron, " and ", b.tetrahedron);
    }

    void boundaryEdges()
    {
        std::vector<std::array<int, 2>> edges;
        for (int t = 0; t < tetrahedra(); ++t)
            for (int f = 0; f < 4; ++f) {
                if (!bit(boundary_[t], f)) continue;
                const std::array<int, 3> n = faceNodes(mesh_.tetrahedra[t], f);
                for (int k = 0; k < 3; ++k)
                    edges.push_back({std::min(n[k], n[(k + 1) % 3]), std::max(n[k], n[(k + 1) % 3])});
            }
        std::ranges::sort(edges);
        for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
            while (next < edges.size() && edges[next] == edges[i]) ++next;
            if (next - i != 2)
                add(TopologyFault::BoundaryEdge, "nodes ", edges[i][0], " and ", edges[i][1], ": ", next - i, " faces");
        }
    }

    void nodes()
    {
        std::vector<std::vector<int>> around(mesh_.rest.size());
        for (int t = 0; t < tetrahedra(); ++t)
            for (int n : mesh_.tetrahedra[t]) around[n].push_back(t);
        for (int n = 0; n < nodeCount(); ++n) {
            if (around[n].empty()) {
                add(TopologyFault::Orphan, "node ", n);
                continue;
            }
            std::vector<int> listed = mesh_.around[n];
            std::ranges::sort(listed);
            if (listed != around[n]) add(TopologyFault::NodeList, "node ", n);
            fan(n, around[n]);
        }
    }

    /// Checks that the node's elements are connected through shared faces, and its boundary faces through shared edges.
    void fan(int node, const std::vector<int>& star)
    {
        struct Piece {
            std::vector<int> shared; ///< the keys by which two of them are connected
            int part;
        };
        const auto parts = [](std::vector<Piece>& pieces) {
            int count = 0;
            std::vector<int> stack;
            for (std::size_t first = 0; first < pieces.size(); ++first) {
                if (pieces[first].part >= 0) continue;
                pieces[first].part = count;
                stack = {static_cast<int>(first)};
                while (!stack.empty()) {
                    const Piece& at = pieces[stack.back()];
                    stack.pop_back();
                    for (std::size_t i = 0; i < pieces.size(); ++i) {
                        if (pieces[i].part >= 0 || !std::ranges::any_of(pieces[i].shared, [&](int key) {
                                return std::ranges::find(at.shared, key) != at.shared.end();
                            }))
                            continue;
                        pieces[i].part = count;
                        stack.push_back(static_cast<int>(i));
                    }
                }
                ++count;
            }
            return count;
        };
        std::vector<Piece> volumes, areas;
        std::vector<std::array<int, 2>> keys; // the faces at the node, by their two other nodes
        for (int t : star) {
            Piece volume{{}, -1};
            for (int f = 0; f < 4; ++f) {
                if (mesh_.tetrahedra[t][f] == node) continue;
                std::array<int, 2> link{};
                int count = 0;
                for (int n : faceNodes(mesh_.tetrahedra[t], f))
                    if (n != node && count < 2) link[count++] = n;
                std::ranges::sort(link);
                auto at = std::ranges::find(keys, link);
                if (at == keys.end()) at = keys.insert(keys.end(), link);
                volume.shared.push_back(static_cast<int>(at - keys.begin()));
                if (bit(boundary_[t], f)) areas.push_back({{link[0], link[1]}, -1});
            }
            volumes.push_back(volume);
        }
        if (parts(volumes) > 1) add(TopologyFault::NodeFan, "node ", node);
        if (parts(areas) > 1) add(TopologyFault::BoundaryVertex, "node ", node);
    }

    const MeshTopology& mesh_;
    const TopologyBounds& bounds_;
    std::vector<TopologyViolation> found_;
    std::vector<Side> sides_;
    std::vector<std::uint8_t> boundary_;
};

} // namespace

const char* name(TopologyFault fault)
{
    constexpr const char* kNames[] = {
        "bad index", "not finite",      "not positive",    "bad quality",     "volume",          "shared face",
        "overlap",   "adjacency",       "masks",           "boundary edge",   "orphan",          "node list",
        "node fan",  "boundary vertex", "mirror elements", "mirror boundary", "mirror positions"};
    static_assert(std::size(kNames) == static_cast<std::size_t>(TopologyFault::count_));
    return kNames[static_cast<int>(fault)];
}

std::vector<TopologyViolation> checkTopology(const MeshTopology& mesh, const TopologyBounds& bounds)
{
    return Checker(mesh, bounds).run();
}

std::vector<TopologyViolation> checkMirror(const MeshTopology& mesh, const frame::TopologyMirror& mirror,
                                           const std::vector<Vec3>& positions)
{
    std::vector<TopologyViolation> found;
    if (mirror.tetrahedra() != mesh.tetrahedra) found.push_back({TopologyFault::MirrorElements, ""});
    if (positions != mesh.rest) found.push_back({TopologyFault::MirrorPositions, ""});
    const auto order = [](const frame::BoundaryTriangle& t) {
        return std::tuple(t.tetrahedron, t.face, t.nodes, t.opened);
    };
    std::vector<frame::BoundaryTriangle> known = mirror.boundary(), real;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        for (int f = 0; f < 4; ++f)
            if (isBoundaryFace(mesh, t, f))
                real.push_back({t, f, faceNodes(mesh.tetrahedra[t], f), (mesh.opened[t] >> f & 1) != 0});
    std::ranges::sort(known, {}, order);
    std::ranges::sort(real, {}, order);
    if (known != real) found.push_back({TopologyFault::MirrorBoundary, ""});
    return found;
}

std::uint64_t hashOf(const MeshTopology& mesh)
{
    Hasher hash;
    const auto add = [&](auto number) {
        if constexpr (std::is_floating_point_v<decltype(number)>)
            hash.add(number);
        else
            hash.add(static_cast<std::uint64_t>(number));
    };
    const auto addPoint = [&](Vec3 p) { add(p.x), add(p.y), add(p.z); };
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        for (int k = 0; k < 4; ++k) add(mesh.tetrahedra[t][k]), add(mesh.neighbours[t][k]);
        add(mesh.flagged[t]), add(mesh.deferred[t]), add(mesh.opened[t]), add(mesh.sides[t]);
    }
    for (std::size_t n = 0; n < mesh.rest.size(); ++n) {
        for (int t : mesh.around[n]) add(t);
        addPoint(mesh.rest[n]), addPoint(mesh.current[n]), addPoint(mesh.previous[n]);
        const CutLabel& label = mesh.labels[n];
        add(label.sheet), add(label.sequence), addPoint(label.point), addPoint(label.normal), addPoint(label.facet);
        add(label.swept.pass), add(label.swept.segment), add(label.swept.along), add(label.swept.way);
    }
    return hash.value();
}

void checkForCuts(const std::string& object, const EditableMesh& mesh)
{
    if (mesh.isSheet()) { // the rest of what a sheet must be was checked with its Def
        const auto faults = checkSheetTopology(mesh.data(), {.volume = mesh.startVolume(), .maxViolations = 1});
        if (!faults.empty())
            fail(object, ": dynamicTopology needs a mesh with one fan of triangles around each vertex, got: ",
                 name(faults.front().fault), " at ", faults.front().where);
        return;
    }
    const std::vector<TopologyViolation> faults =
        checkTopology(mesh.data(), {.volume = mesh.startVolume(), .maxViolations = 1});
    if (!faults.empty())
        fail(object,
             ": dynamicTopology needs a mesh whose surface is a manifold (each edge between two triangles, one "
             "fan of triangles around each node), got: ",
             faults.front().where, "; 'filasofia mesh FILE -o FILE.msh --size 4mm' meshes it anew");
    constexpr double kPoor = 0.05;
    double worst = 1.0;
    for (int t = 0; t < mesh.tetrahedra(); ++t) worst = std::min(worst, restQuality(mesh.data(), t));
    if (worst < kPoor)
        logWarning(object, ": the worst of its tetrahedra has quality ", worst,
                   " (1: regular); near such elements cuts follow existing faces");
}

} // namespace filasofia::engine

#include "filasofia/engine/rupture/check_topology.h"

#include "filasofia/core/text.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace filasofia::engine {
namespace {

/// An edge of a triangle, lower node first, with the direction in which the triangle runs along it.
struct TriangleSide {
    std::array<int, 2> ends;
    int triangle, edge;
    bool forwards;
};

class SheetChecker {
public:
    SheetChecker(const MeshTopology& mesh, const TopologyBounds& bounds) : mesh_(mesh), bounds_(bounds) {}

    std::vector<TopologyViolation> run()
    {
        indices();
        if (!found_.empty()) return found_; // later checks would index out of range
        triangles();
        edges();
        nodes();
        return found_;
    }

private:
    template <class... Parts> void add(TopologyFault fault, const Parts&... where)
    {
        if (found_.size() < bounds_.maxViolations) found_.push_back({fault, text(where...)});
    }
    [[nodiscard]] int count() const { return static_cast<int>(mesh_.tetrahedra.size()); }
    [[nodiscard]] const geometry::Tetrahedron& at(int t) const { return mesh_.tetrahedra[static_cast<std::size_t>(t)]; }
    [[nodiscard]] static std::size_t place(int i) { return static_cast<std::size_t>(i); }

    void indices()
    {
        const int nodes = static_cast<int>(mesh_.rest.size());
        for (int t = 0; t < count(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const int node = at(t)[k], other = mesh_.neighbours[place(t)][k];
                if (node < 0 || node >= nodes) add(TopologyFault::BadIndex, "triangle ", t, " has node ", node);
                if (other < -1 || other >= count())
                    add(TopologyFault::BadIndex, "triangle ", t, " has neighbour ", other);
            }
        for (const auto& list : {mesh_.current.size(), mesh_.previous.size(), mesh_.around.size()})
            if (list != mesh_.rest.size()) add(TopologyFault::BadIndex, "lists of nodes differ in length");
    }

    void triangles()
    {
        double sum = 0.0;
        for (int t = 0; t < count(); ++t) {
            const double area = restVolume(mesh_, t), q = restQuality(mesh_, t);
            sum += area;
            if (!(area > 0.0)) add(TopologyFault::NotPositive, "triangle ", t, " has ", area, " m^2");
            if (!(q >= bounds_.quality * (1.0 - 1e-9)))
                add(TopologyFault::BadQuality, "triangle ", t, " has quality ", q);
        }
        if (!(std::abs(sum - bounds_.volume) <= bounds_.volumeTolerance * bounds_.volume))
            add(TopologyFault::Volume, sum, " m^2, not ", bounds_.volume);
    }

    void edges()
    {
        std::vector<TriangleSide> sides;
        for (int t = 0; t < count(); ++t)
            for (int f = 0; f < 3; ++f) {
                const int a = at(t)[place((f + 1) % 3)], b = at(t)[place((f + 2) % 3)];
                sides.push_back({{std::min(a, b), std::max(a, b)}, t, f, a < b});
            }
        std::ranges::sort(sides, [](const TriangleSide& a, const TriangleSide& b) {
            return std::tie(a.ends, a.triangle, a.edge) < std::tie(b.ends, b.triangle, b.edge);
        });
        for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
            while (next < sides.size() && sides[next].ends == sides[i].ends) ++next;
            if (next - i > 2)
                add(TopologyFault::SharedFace, "nodes ", sides[i].ends[0], " and ", sides[i].ends[1]);
            else if (next - i == 2)
                inner(sides[i], sides[i + 1]);
            else
                rim(sides[i]);
        }
    }

    [[nodiscard]] int across(const TriangleSide& side) const
    {
        return mesh_.neighbours[place(side.triangle)][place(side.edge)];
    }

    void inner(const TriangleSide& a, const TriangleSide& b)
    {
        if (across(a) != b.triangle || across(b) != a.triangle)
            add(TopologyFault::Adjacency, "triangles ", a.triangle, " and ", b.triangle);
        if (a.forwards == b.forwards) add(TopologyFault::Overlap, "triangles ", a.triangle, " and ", b.triangle);
        if (has(mesh_.flagged[place(a.triangle)], a.edge) != has(mesh_.flagged[place(b.triangle)], b.edge))
            add(TopologyFault::Masks, "triangles ", a.triangle, " and ", b.triangle, " differ");
        if (has(mesh_.opened[place(a.triangle)], a.edge) || has(mesh_.opened[place(b.triangle)], b.edge))
            add(TopologyFault::Masks, "closed edge of triangle ", a.triangle, " counts as opened");
    }

    void rim(const TriangleSide& side)
    {
        if (across(side) != -1) add(TopologyFault::Adjacency, "edge at the rim of triangle ", side.triangle);
        if (has(mesh_.flagged[place(side.triangle)], side.edge))
            add(TopologyFault::Masks, "edge at the rim of triangle ", side.triangle, " is marked for opening");
    }

    void nodes()
    {
        std::vector<std::vector<int>> around(mesh_.rest.size());
        for (int t = 0; t < count(); ++t)
            for (int node : nodesOf(at(t))) around[place(node)].push_back(t);
        for (int n = 0; n < static_cast<int>(around.size()); ++n) {
            const std::vector<int>& star = around[place(n)];
            std::vector<int> listed = mesh_.around[place(n)];
            std::ranges::sort(listed);
            if (star.empty()) add(TopologyFault::Orphan, "node ", n);
            if (listed != star) add(TopologyFault::NodeList, "node ", n);
            if (!star.empty() && !oneFan(n, star)) add(TopologyFault::NodeFan, "node ", n);
        }
    }

    /// Whether the triangles at a node are connected through edges at it: by their nodes alone.
    [[nodiscard]] bool oneFan(int node, const std::vector<int>& star) const
    {
        const auto together = [&](int a, int b) {
            return std::ranges::count_if(nodesOf(at(a)), [&](int n) { return n != node && placeOf(at(b), n) >= 0; }) >
                   0;
        };
        std::vector<int> reached{star.front()};
        for (std::size_t i = 0; i < reached.size(); ++i)
            for (int t : star)
                if (std::ranges::find(reached, t) == reached.end() && together(reached[i], t)) reached.push_back(t);
        return reached.size() == star.size();
    }

    const MeshTopology& mesh_;
    const TopologyBounds& bounds_;
    std::vector<TopologyViolation> found_;
};

} // namespace

std::vector<TopologyViolation> checkSheetTopology(const MeshTopology& mesh, const TopologyBounds& bounds)
{
    return SheetChecker(mesh, bounds).run();
}

} // namespace filasofia::engine

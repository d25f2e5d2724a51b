#include "filasofia/engine/body/shell.h"

#include "filasofia/core/error.h"
#include "filasofia/core/sorted.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/space_order.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace filasofia::engine {
namespace {

using geometry::Triangle;

/// The corner of the triangle on the other side of each directed edge.
using Across = std::map<std::array<int, 2>, int>;

Across acrossOf(const std::vector<Triangle>& triangles)
{
    Across across;
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) across[{t[(i + 2) % 3], t[(i + 1) % 3]}] = t[i];
    return across;
}

std::array<int, 3> acrossFrom(const Triangle& t, const Across& across)
{
    std::array<int, 3> nodes{-1, -1, -1};
    for (std::size_t i = 0; i < 3; ++i)
        if (const auto other = across.find({t[(i + 1) % 3], t[(i + 2) % 3]}); other != across.end())
            nodes[i] = other->second;
    return nodes;
}

/// What a triangle resists bending with: nothing if it has no neighbour.
BendingElement bendOf(const std::array<int, 3>& t, const std::array<int, 3>& across, const std::vector<Vec3>& rest,
                      const physics::ShellMaterial& m)
{
    std::array<int, 6> nodes{t[0], t[1], t[2], t[0], t[1], t[2]};
    Hinged hinged{};
    for (std::size_t i = 0; i < 3; ++i)
        if (across[i] >= 0) {
            nodes[3 + i] = across[i];
            hinged[i] = true;
        }
    BendingElement bend = bendingOn(nodes, hinged, vectorsAt(nodes, rest), m.poissonRatio);
    bend.rigidity = m.bendingScale * plateRigidity(m.youngModulus, m.poissonRatio, m.thickness);
    return bend;
}

MembraneElement membraneOf(const Triangle& t, int ofMesh, const std::vector<Vec3>& rest,
                           const physics::ShellMaterial& m)
{
    MembraneElement element = membraneOn(t, vectorsAt(t, rest));
    element.triangle = ofMesh;
    element.shear = membraneShear(m.youngModulus, m.poissonRatio, m.thickness);
    element.poissonRatio = m.poissonRatio;
    return element;
}

template <std::size_t n> void checkNodes(const std::string& object, const std::array<int, n>& nodes, std::size_t count)
{
    for (int node : nodes)
        if (node < 0 || static_cast<std::size_t>(node) >= count)
            fail(object, ": node must be in [0, ", count, "), got ", node);
}

} // namespace

Shell makeShell(const physics::ShellMaterial& material, const std::vector<Vec3>& rest,
                const std::vector<Triangle>& triangles)
{
    Shell shell{.material = material};
    std::vector<Vec3> centres;
    for (const Triangle& t : triangles) {
        const TriangleCorners x = vectorsAt(t, rest);
        centres.push_back(1.0 / 3.0 * (x[0] + x[1] + x[2]));
    }
    const Across across = material.bendingScale > 0.0 ? acrossOf(triangles) : Across{};
    for (int each : geometry::orderAlongCurve(centres)) {
        const Triangle& t = triangles[static_cast<std::size_t>(each)];
        shell.membranes.push_back(membraneOf(t, each, rest, material));
        if (material.bendingScale > 0.0) shell.bends.push_back(bendOf(t, acrossFrom(t, across), rest, material));
    }
    return shell;
}

Shell makeShell(const physics::ShellMaterial& material, const std::vector<Vec3>& rest, const Shell& like)
{
    Shell shell{.material = material};
    std::vector<Triangle> triangles;
    for (const MembraneElement& each : like.membranes) triangles.push_back(each.nodes);
    const Across across = material.bendingScale > 0.0 ? acrossOf(triangles) : Across{};
    for (std::size_t e = 0; e < triangles.size(); ++e) {
        shell.membranes.push_back(membraneOf(triangles[e], like.membranes[e].triangle, rest, material));
        if (material.bendingScale > 0.0)
            shell.bends.push_back(bendOf(triangles[e], acrossFrom(triangles[e], across), rest, material));
    }
    return shell;
}

void shapeTriangle(const TriangleEdit& edit, const std::vector<Vec3>& rest, Shell& shell)
{
    const bool bends = shell.material.bendingScale > 0.0;
    if (edit.triangle == shell.membranes.size()) {
        shell.membranes.push_back(MembraneElement(shell.membranes[edit.parent]));
        if (bends) shell.bends.emplace_back();
    }
    MembraneElement& membrane = shell.membranes[edit.triangle];
    membrane = membraneOf(edit.nodes, membrane.triangle, rest, shell.material);
    if (bends) shell.bends[edit.triangle] = bendOf(edit.nodes, edit.across, rest, shell.material);
}

std::vector<std::array<int, 2>> edgesOf(const Shell& shell)
{
    std::vector<std::array<int, 2>> edges;
    for (const MembraneElement& each : shell.membranes)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(each.nodes[i], each.nodes[(i + 1) % 3]);
            edges.push_back({low, high});
        }
    sortUnique(edges);
    return edges;
}

void check(const Shell& shell, std::size_t nodes, const std::string& object)
{
    if (shell.membranes.empty()) return;
    validate(shell.material, object + ": material");
    for (std::size_t e = 0; e < shell.membranes.size(); ++e) {
        const MembraneElement& each = shell.membranes[e];
        const std::string name = text(object, ": triangles[", e, "]");
        checkNodes(name, each.nodes, nodes);
        if (!positive().contains(each.area)) fail(name, ".area must be > 0 m^2, got ", each.area);
        if (!positive().contains(each.shear)) fail(name, ".shear must be > 0 N/m, got ", each.shear);
        for (double metric : each.metric)
            if (!std::isfinite(metric)) fail(name, ".metric must be finite, got ", metric);
    }
    if (!shell.bends.empty() && shell.bends.size() != shell.membranes.size())
        fail(object, ": bends must have ", shell.membranes.size(), " entries or none, got ", shell.bends.size());
    for (std::size_t b = 0; b < shell.bends.size(); ++b) {
        const BendingElement& each = shell.bends[b];
        const std::string name = text(object, ": bends[", b, "]");
        checkNodes(name, each.nodes, nodes);
        if (!nonNegative().contains(each.rigidity)) fail(name, ".rigidity must be >= 0 N m, got ", each.rigidity);
        for (double angle : each.restAngles)
            if (!std::isfinite(angle)) fail(name, ".restAngles must be finite, got ", angle);
    }
}

double strainOf(const MembraneElement& element, std::span<const Vec3> x)
{
    const auto [high, low] = membraneStretches(element, vectorsAt(element.nodes, x));
    return std::max(std::abs(high - 1.0), std::abs(low - 1.0));
}

} // namespace filasofia::engine

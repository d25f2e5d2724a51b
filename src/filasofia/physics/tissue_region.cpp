#include "filasofia/physics/tissue_region.h"

#include "filasofia/core/error.h"
#include "filasofia/core/sorted.h"
#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/harmonic.h"
#include "filasofia/geometry/surface.h"

#include <algorithm>
#include <cmath>

namespace filasofia::physics {
namespace {

using geometry::TetMesh;

constexpr double kShortest = 1e-6; // [-] length of a direction

Vec3 centreOf(const TetMesh& mesh, const geometry::Tetrahedron& t)
{
    return 0.25 * (mesh.nodes[t[0]] + mesh.nodes[t[1]] + mesh.nodes[t[2]] + mesh.nodes[t[3]]);
}

/// The tetrahedra for which `isIn` (number) holds.
template <class IsIn> std::vector<int> selected(const TetMesh& mesh, const IsIn& isIn)
{
    std::vector<int> out;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        if (isIn(t)) out.push_back(t);
    return out;
}

std::string namesOf(const TetMesh& mesh)
{
    std::string all;
    for (const geometry::MeshLabel& each : mesh.labelNames) all += (all.empty() ? "'" : ", '") + each.name + "'";
    return all.empty() ? "none" : all;
}

/// Finds the tetrahedra of a region.
struct Find {
    const TetMesh& mesh;
    std::string_view object;

    [[nodiscard]] std::vector<int> operator()(const Labelled& labelled) const
    {
        const int label = numberOf(labelled);
        return selected(mesh, [&](int t) { return mesh.labels[static_cast<std::size_t>(t)] == label; });
    }
    [[nodiscard]] std::vector<int> operator()(const geometry::Box& box) const
    {
        if (geometry::isEmpty(box)) fail(object, ": box: high must be >= low in every axis");
        return centresIn([&](Vec3 p) { return geometry::squaredDistance(box, p) == 0.0; });
    }
    [[nodiscard]] std::vector<int> operator()(const Ball& ball) const
    {
        return centresIn([&](Vec3 p) { return distance(p, ball.centre) <= ball.radius; });
    }
    [[nodiscard]] std::vector<int> operator()(const NearSurface& near) const
    {
        const geometry::TriangleMesh surface = geometry::extractSurface(mesh).mesh;
        std::vector<geometry::Box> boxes;
        for (const geometry::Triangle& t : surface.triangles)
            boxes.push_back(geometry::boxAround(
                std::array{surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]}));
        const geometry::Bvh tree(boxes);
        return centresIn([&](Vec3 p) {
            const auto squared = [&](int i) {
                const geometry::Triangle& t = surface.triangles[i];
                return geometry::nearestOnTriangle(p, surface.vertices[t[0]], surface.vertices[t[1]],
                                                   surface.vertices[t[2]])
                    .squaredDistance;
            };
            return tree.nearest(p, squared, near.depth * near.depth).primitive >= 0;
        });
    }
    [[nodiscard]] std::vector<int> operator()(const AtInterface& interface) const
    {
        const int first = numberOf(interface.first), second = numberOf(interface.second);
        if (first == second) fail(object, ": second must be another label than first, got ", second, " for both");
        std::vector<std::array<bool, 2>> touches(mesh.nodes.size());
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
            for (int node : mesh.tetrahedra[t]) {
                if (mesh.labels[t] == first) touches[node][0] = true;
                if (mesh.labels[t] == second) touches[node][1] = true;
            }
        return selected(mesh, [&](int t) {
            const int label = mesh.labels[static_cast<std::size_t>(t)];
            return (label == first || label == second) &&
                   std::ranges::any_of(mesh.tetrahedra[t], [&](int n) { return touches[n][0] && touches[n][1]; });
        });
    }
    [[nodiscard]] std::vector<int> operator()(const Listed& listed) const
    {
        std::vector<int> out = listed.tetrahedra;
        sortUnique(out);
        const auto count = static_cast<int>(mesh.tetrahedra.size());
        for (int each : out)
            if (each < 0 || each >= count) fail(object, ": tetrahedra must be in [0, ", count, "), got ", each);
        return out;
    }

    [[nodiscard]] int numberOf(const Labelled& labelled) const
    {
        if (mesh.labels.empty()) fail(object, ": the mesh must have labels, has none");
        if (labelled.name.empty()) return labelled.label;
        const auto found = std::ranges::find(mesh.labelNames, labelled.name, &geometry::MeshLabel::name);
        if (found == mesh.labelNames.end())
            fail(object, ": the mesh has no label named '", labelled.name, "'; its names: ", namesOf(mesh));
        return found->label;
    }

private:
    template <class IsIn> [[nodiscard]] std::vector<int> centresIn(const IsIn& isIn) const
    {
        return selected(mesh, [&](int t) { return isIn(centreOf(mesh, mesh.tetrahedra[t])); });
    }
};

Vec3 unit(Vec3 direction, std::string_view object, std::string_view field)
{
    const double size = length(direction);
    if (!(size > kShortest)) fail(object, ".", field, " must have a length > ", kShortest, ", got ", size);
    return 1.0 / size * direction;
}

/// The direction of the fibres in each of these tetrahedra.
struct Direct {
    const TetMesh& mesh;
    std::string object;
    const std::vector<int>& where;
    std::vector<Vec3> out = std::vector<Vec3>(mesh.tetrahedra.size());

    void operator()(const Along& along)
    {
        const Vec3 direction = unit(along.direction, object, "direction");
        for (int t : where) out[t] = direction;
    }
    void operator()(const Around& around)
    {
        const Vec3 axis = unit(around.axis, object, "axis");
        for (int t : where) {
            const Vec3 ring = cross(axis, centreOf(mesh, mesh.tetrahedra[t]) - around.point);
            const double radius = length(ring);
            if (!(radius > kShortest * 1e-3)) continue; // on the axis no direction goes around it
            out[t] = std::cos(around.pitch) / radius * ring + std::sin(around.pitch) * axis;
        }
    }
    void operator()(const DirectionField& field)
    {
        if (field.directions.size() != mesh.tetrahedra.size())
            fail(object, ".directions must have one entry per tetrahedron (", mesh.tetrahedra.size(), "), got ",
                 field.directions.size());
        for (int t : where)
            if (const double size = length(field.directions[t]); size > kShortest)
                out[t] = 1.0 / size * field.directions[t];
    }
    void operator()(const HarmonicField& field)
    {
        std::vector<std::optional<double>> given(mesh.nodes.size());
        const std::vector<int> from = tetrahedraOf(field.from, mesh, object + ".from");
        const std::vector<int> to = tetrahedraOf(field.to, mesh, object + ".to");
        for (int t : from)
            for (int node : mesh.tetrahedra[t]) given[node] = 0.0;
        for (int t : to)
            for (int node : mesh.tetrahedra[t]) {
                if (given[node] == 0.0) fail(object, ": from and to must have no node in common, got node ", node);
                given[node] = 1.0;
            }
        const std::vector<Vec3> slopes = geometry::gradients(mesh, geometry::harmonicFunction(mesh, given));
        // Inside the two regions, and in pieces of the mesh with only one of them, the function is constant but for
        // rounding: no fibre. On the way from one to the other it rises by 1 within the size of the mesh.
        const geometry::Box box = geometry::boxAround(mesh.nodes);
        const double flat = kShortest / length(box.high - box.low);
        for (int t : where)
            if (const double size = length(slopes[t]); size > flat) out[t] = 1.0 / size * slopes[t];
    }
};

} // namespace

void resolveNames(const TetMesh& mesh, std::string_view object, RegionShape& where)
{
    const auto resolve = [&](Labelled& each) { each = {.name = {}, .label = Find{mesh, object}.numberOf(each)}; };
    if (auto* labelled = std::get_if<Labelled>(&where)) {
        resolve(*labelled);
    } else if (auto* interface = std::get_if<AtInterface>(&where)) {
        resolve(interface->first);
        resolve(interface->second);
    }
}

std::vector<int> tetrahedraOf(const RegionShape& where, const TetMesh& mesh, std::string_view object)
{
    std::vector<int> out = std::visit(Find{mesh, object}, where);
    if (out.empty()) fail(object, ": must contain at least one tetrahedron of the mesh, got none");
    return out;
}

std::vector<Vec3> directionsOf(const FibreFamily& family, const TetMesh& mesh, std::string_view object)
{
    std::vector<int> where;
    if (family.where)
        where = tetrahedraOf(*family.where, mesh, text(object, ".where"));
    else
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) where.push_back(static_cast<int>(t));
    Direct direct{mesh, text(object, ".direction"), where};
    std::visit([&](const auto& each) { direct(each); }, family.direction);
    if (std::ranges::all_of(direct.out, [](Vec3 d) { return d == Vec3{}; }))
        fail(object, ".direction must have a length in at least one tetrahedron, has none");
    return std::move(direct.out);
}

} // namespace filasofia::physics

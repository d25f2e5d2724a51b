#include "filasofia/physics/mesh_warnings.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/box.h"
#include "filasofia/geometry/mesh_pieces.h"
#include "filasofia/geometry/surface_fit.h"
#include "filasofia/math/rounded.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace filasofia::physics {
namespace {

/// Most organ meshes are in millimetres; if one is read as metres, nothing fails, but the body is as large as a bridge
/// and sags like one.
void warnOfSize(const std::string& object, const std::vector<Vec3>& nodes, const std::string& remedy)
{
    constexpr double kLargest = 10.0; // [m]
    const geometry::Box box = geometry::boxAround(nodes);
    const double size = length(box.high - box.low);
    if (size > kLargest)
        logWarning(object, ": is ", std::round(1e3 * size) / 1e3, " m large; if its coordinates are millimetres, ",
                   remedy);
}

/// Whether it is thinner than a millimetre that is read as a metre: a floor or a wall.
bool isPlate(const std::vector<Vec3>& nodes)
{
    constexpr double kThinnest = 1.0; // [m]
    const geometry::Box around = geometry::boxAround(nodes);
    const Vec3 size = around.high - around.low;
    return std::min({size.x, size.y, size.z}) < kThinnest;
}

/// How a file in millimetres is read, by a scene, in C++ and in Python.
std::string scaleOf(const char* type, const char* cpp, const char* python)
{
    return text("give it a scale of 0.001 (in a scene \"mesh\": {\"type\": \"", type,
                "\", \"file\": ..., \"scale\": 0.001}; in C++ ", cpp, "(file, 1e-3); in Python ", python,
                "(file, 1e-3))");
}

/// Whether nodes that lie on each other are those which loaded() has split: joined, the mesh would be split there
/// again.
bool onlyTouches(const geometry::TetMesh& mesh)
{
    try {
        return geometry::withSplitNodes(geometry::withJoinedNodes(mesh, "")).nodes.size() == mesh.nodes.size();
    } catch (const Error&) { // joined, tetrahedra overlap
        return false;
    }
}

/// Nothing fails either if tetrahedra do not share their nodes: each falls for itself, or a seam gapes.
void warnOfPieces(const std::string& object, const geometry::TetMesh& mesh, bool split)
{
    geometry::MeshPieces found = geometry::piecesOf(mesh);
    if (split && found.doubled > 0 && onlyTouches(mesh)) found.doubled = 0;
    if (found.pieces == 1 && found.doubled == 0) return;
    const std::string pieces =
        found.pieces > 1 ? text(" has ", found.pieces, " pieces that share no node, and move apart") : std::string();
    if (found.doubled == 0)
        return logWarning(object, ": the mesh", pieces, "; make a body of each, or attach them to each other");
    logWarning(object, ": the mesh", pieces, pieces.empty() ? " is open along a seam: " : "; ", found.doubled,
               " of its ", mesh.nodes.size(),
               " nodes lie on others; to join them, read it with join (in a scene \"mesh\": {\"type\": \"tetrahedra\", "
               "\"file\": ..., \"join\": true}; in C++ geometry::withJoinedNodes(); in Python load_tet_mesh(file, "
               "join=True))");
}

/// Thin elements are stiff: solvers need more iterations, and a small strain inverts them.
constexpr double kLargestAspect = 100.0; ///< [-]
/// [-] If most elements are beyond this, the body is a sheet or a wall of one layer. One of 0.1 mm in elements of 5 mm
/// that fell on a floor stopped at the iteration limit in most steps, and was thrown to 6 m.
constexpr double kFlatAspect = 40.0;

/// [-] Longest edge over smallest height; 1.22 for a regular tetrahedron.
double aspectOf(const geometry::TetMesh& mesh, std::size_t tetrahedron)
{
    std::array<Vec3, 4> at;
    for (std::size_t i = 0; i < 4; ++i) at[i] = mesh.nodes[static_cast<std::size_t>(mesh.tetrahedra[tetrahedron][i])];
    double longest = 0.0, largest = 0.0; // [m], [m^2]
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = 0; k < i; ++k) longest = std::max(longest, distance(at[i], at[k]));
        const Vec3 &a = at[(i + 1) % 4], &b = at[(i + 2) % 4], &c = at[(i + 3) % 4];
        largest = std::max(largest, 0.5 * length(cross(b - a, c - a)));
    }
    return longest * largest / (3.0 * geometry::signedVolume(mesh, static_cast<int>(tetrahedron)));
}

void warnOfThinElements(const std::string& object, const geometry::TetMesh& mesh)
{
    std::size_t thin = 0, flat = 0, worst = 0;
    double most = 0.0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const double aspect = aspectOf(mesh, t);
        if (aspect > kLargestAspect) ++thin;
        if (aspect > kFlatAspect) ++flat;
        if (aspect > most) most = aspect, worst = t;
    }
    const bool sheet = 2 * flat > mesh.tetrahedra.size();
    const std::size_t count = sheet ? flat : thin;
    if (count == 0) return;
    logWarning(object, ": ", count, " of ", mesh.tetrahedra.size(), count == 1 ? " tetrahedra is" : " tetrahedra are",
               " thin: longest edge over smallest height is ", std::round(most), " in tetrahedron ", worst,
               " (at most ", sheet ? kFlatAspect : kLargestAspect,
               " is advised); solvers need more iterations, and little strain turns them inside out",
               sheet ? "; if it is a sheet or a wall, make it a shell (ShellMaterial)" : "");
}

/// Edges far shorter than the radius collide with hundreds of others.
void warnOfShortEdges(const std::string& object, const RodBodyDef& rod, const std::vector<double>& edges)
{
    constexpr double kShortest = 0.25; // [-], relative to the radius
    const double least = kShortest * rod.radius, shortest = std::ranges::min(edges);
    const auto count = std::ranges::count_if(edges, [&](double each) { return each < least; });
    if (count == 0 || !rod.collision) return;
    logWarning(object, ": ", count, " of its ", edges.size(), count == 1 ? " edges is" : " edges are",
               " shorter than a quarter of its radius, the shortest is 1/", std::round(rod.radius / shortest),
               " of it; each collides with very many others, and a step may take seconds; give it a spacing of at "
               "least ",
               least, " m (two to ten radii are usual), or no collision");
}

/// Where a rod is twisted by more than half a turn from edge to edge, it would coil more finely than its edges can.
void warnOfTwist(const std::string& object, const RodBodyDef& rod, std::size_t edges)
{
    const std::size_t joints = rod.closed ? edges : edges - 1;
    const double most = std::numbers::pi * static_cast<double>(joints);
    if (std::abs(rod.twist) > most)
        logWarning(object, ": twist of ", rod.twist, " rad is more than pi rad from edge to edge; its ", edges,
                   " edges can follow at most ", std::floor(most), " rad; give it less, or more nodes");
}

/// A length that was meant in millimetres makes bodies hover, and a step take very long.
void warnOfLength(const std::string& field, double value, std::span<const Vec3> nodes)
{
    constexpr double kUsual = 5e-3, kLargest = 0.25; // [m], and [-] relative to the diagonal; usual are 1/50 and less
    const geometry::Box box = geometry::boxAround(nodes);
    const double size = length(box.high - box.low);
    if (nodes.empty() || !(value > std::max(kUsual, kLargest * size))) return;
    logWarning(field, " is ", value, " m, and the body is ", size > 0.0 ? advised(size) : 0.0,
               " m large; if it is meant in millimetres, write ", 1e-3 * value);
}

/// `own`: the body's mesh, which a model without one of its own collides with.
void warnOfProximity(const std::string& object, const std::vector<CollisionDef>& collision, std::span<const Vec3> own)
{
    for (std::size_t i = 0; i < collision.size(); ++i) {
        const auto* mesh = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&collision[i].mesh);
        warnOfLength(text(object, ": collision[", i, "].proximity"), collision[i].proximity,
                     mesh && *mesh ? std::span<const Vec3>((*mesh)->vertices) : own);
    }
}

/// A collision mesh moves with the tetrahedra, however far from them it is.
void warnOfCollision(const std::string& object, const SoftBodyDef& soft, const geometry::TetMesh& mesh)
{
    for (std::size_t i = 0; i < soft.collision.size(); ++i) {
        const auto* own = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&soft.collision[i].mesh);
        if (own == nullptr || !*own) continue;
        if (const std::string odd = geometry::oddFit((*own)->vertices, mesh.nodes); !odd.empty())
            logWarning(object, ": collision[", i, "].mesh ", odd);
    }
}

void warnOfRod(const std::string& object, const RodBodyDef& rod)
{
    warnOfSize(object, rod.points, "use metres");
    const std::vector<Vec3> nodes = centreLine(rod);
    std::vector<double> edges; // [m]
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) edges.push_back(distance(nodes[i], nodes[i + 1]));
    if (rod.closed) edges.push_back(distance(nodes.back(), nodes.front()));
    warnOfShortEdges(object, rod, edges);
    warnOfTwist(object, rod, edges.size());
}

} // namespace

void warnOfMesh(const BodyDef& def)
{
    const std::string object = describeBody(def);
    if (const auto* rod = std::get_if<RodBodyDef>(&def)) return warnOfRod(object, *rod);
    if (const auto* rigid = std::get_if<RigidBodyDef>(&def)) {
        const auto* surface = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&rigid->mesh);
        if (surface && *surface && !(isPlate((*surface)->vertices) && !rigid->dynamic)) // a floor may be that large
            warnOfSize(object, (*surface)->vertices, scaleOf("surface", "loadTriangleMesh", "load_triangle_mesh"));
        warnOfProximity(object, rigid->collision,
                        surface && *surface ? std::span<const Vec3>((*surface)->vertices) : std::span<const Vec3>());
    }
    const auto* soft = std::get_if<SoftBodyDef>(&def);
    if (!soft) return;
    if (const auto* sheet = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&soft->mesh)) {
        warnOfSize(object, (*sheet)->vertices, scaleOf("surface", "loadTriangleMesh", "load_triangle_mesh"));
        warnOfProximity(object, soft->collision, (*sheet)->vertices);
        if (const auto* shell = std::get_if<ShellMaterial>(&soft->material))
            warnOfLength(object + ": material.thickness", shell->thickness, (*sheet)->vertices);
    }
    if (const auto* solid = std::get_if<std::shared_ptr<const geometry::TetMesh>>(&soft->mesh)) {
        warnOfSize(object, (*solid)->nodes, scaleOf("tetrahedra", "loadTetMesh", "load_tet_mesh"));
        warnOfPieces(object, **solid, soft->dynamicTopology);
        warnOfThinElements(object, **solid);
        warnOfCollision(object, *soft, **solid);
        warnOfProximity(object, soft->collision, (*solid)->nodes);
    }
}

} // namespace filasofia::physics

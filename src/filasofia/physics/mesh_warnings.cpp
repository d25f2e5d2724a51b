#include "filasofia/physics/mesh_warnings.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/box.h"
#include "filasofia/geometry/mesh_pieces.h"

#include <cmath>

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

/// How a file in millimetres is read, by a scene, in C++ and in Python.
std::string scaleOf(const char* type, const char* cpp, const char* python)
{
    return text("give it a scale of 0.001 (in a scene \"mesh\": {\"type\": \"", type,
                "\", \"file\": ..., \"scale\": 0.001}; in C++ ", cpp, "(file, 1e-3); in Python ", python,
                "(file, 1e-3))");
}

/// Nothing fails either if tetrahedra do not share their nodes: each falls for itself, or a seam gapes.
void warnOfPieces(const std::string& object, const geometry::TetMesh& mesh)
{
    const geometry::MeshPieces found = geometry::piecesOf(mesh);
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

} // namespace

void warnOfMesh(const BodyDef& def)
{
    const std::string object = describeBody(def);
    if (const auto* rod = std::get_if<RodBodyDef>(&def)) return warnOfSize(object, rod->points, "use metres");
    const auto* soft = std::get_if<SoftBodyDef>(&def);
    if (!soft) return;
    if (const auto* sheet = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&soft->mesh))
        warnOfSize(object, (*sheet)->vertices, scaleOf("surface", "loadTriangleMesh", "load_triangle_mesh"));
    if (const auto* solid = std::get_if<std::shared_ptr<const geometry::TetMesh>>(&soft->mesh)) {
        warnOfSize(object, (*solid)->nodes, scaleOf("tetrahedra", "loadTetMesh", "load_tet_mesh"));
        warnOfPieces(object, **solid);
    }
}

} // namespace filasofia::physics

#include "filasofia/geometry/mesh_file.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"
#include "filasofia/core/word.h"
#include "filasofia/geometry/announced_size.h"
#include "filasofia/geometry/assimp_reader.h"
#include "filasofia/geometry/gmsh_reader.h"
#include "filasofia/geometry/medit_reader.h"
#include "filasofia/geometry/number_source.h"
#include "filasofia/geometry/obj_text.h"
#include "filasofia/geometry/off_reader.h"
#include "filasofia/geometry/tetgen_reader.h"
#include "filasofia/geometry/vtk_reader.h"
#include "filasofia/geometry/vtu_reader.h"

#include <algorithm>
#include <cmath>

namespace filasofia::geometry {
namespace {

std::string extensionOf(const std::filesystem::path& file) { return lowered(file.extension().string()); }

std::string shownExtension(const std::string& extension)
{
    return extension.empty() ? "a name without an ending" : text("'", extension, "'");
}

std::string bytesOf(const std::filesystem::path& file)
{
    std::string bytes = readFile(file, file.string());
    if (bytes.empty()) fail(file.string(), ": is empty");
    return bytes;
}

TetMesh loadTetGen(std::filesystem::path file)
{
    // A name in upper case has a partner in upper case.
    const bool upper = file.extension() == ".NODE" || file.extension() == ".ELE";
    const std::filesystem::path nodes = file.replace_extension(upper ? ".NODE" : ".node");
    const std::filesystem::path elements = file.replace_extension(upper ? ".ELE" : ".ele");
    const std::string nodeBytes = bytesOf(nodes), elementBytes = bytesOf(elements);
    return parseTetGen({nodeBytes, nodes.string()}, {elementBytes, elements.string()});
}

TetMesh readTetMesh(const std::filesystem::path& file, const std::string& labels)
{
    const std::string extension = extensionOf(file);
    if (extension == ".vtk") return parseVtk(bytesOf(file), file.string(), labels);
    if (extension == ".vtu") return parseVtu(bytesOf(file), file.string(), labels);
    if (!labels.empty())
        fail(file.string(), ": labels names a list of a .vtk or .vtu file, got ", shownWord(labels), " for a '",
             extension, "' file");
    if (extension == ".msh") return parseGmsh(bytesOf(file), file.string());
    if (extension == ".mesh") return parseMedit(bytesOf(file), file.string());
    if (extension == ".node" || extension == ".ele") return loadTetGen(file);
    fail(file.string(), ": a tetrahedral mesh must be a .msh, .mesh, .vtk, .vtu, .node or .ele file, got ",
         shownExtension(extension));
}

TriangleMesh readTriangleMesh(const std::filesystem::path& file)
{
    static constexpr std::string_view kExtensions[] = {".obj", ".stl", ".ply", ".gltf", ".glb"};
    const std::string extension = extensionOf(file);
    if (extension == ".vtk") return parseVtkSurface(bytesOf(file), file.string());
    if (extension == ".vtp" || extension == ".vtu") return parseVtuSurface(bytesOf(file), file.string());
    if (extension == ".off") return parseOff(bytesOf(file), file.string());
    if (extension == ".mesh") return parseMeditSurface(bytesOf(file), file.string());
    if (std::ranges::find(kExtensions, extension) == std::end(kExtensions))
        fail(file.string(),
             ": a triangle mesh must be an .obj, .stl, .ply, .gltf, .glb, .off, .vtk, .vtp, .vtu or .mesh file, got ",
             shownExtension(extension));
    const std::string bytes = bytesOf(file);
    if (extension == ".obj") return readWithAssimp(file, checkedObj(bytes, file.string()));
    checkAnnouncedSizes(file, extension, bytes);
    return readWithAssimp(file);
}

void multiply(std::vector<Vec3>& points, double scale)
{
    for (Vec3& point : points) point = scale * point;
}

void checkAsked(const std::filesystem::path& file, double scale)
{
    std::error_code none;
    if (file.empty()) fail("a file of a mesh must have a name, got ''");
    if (std::filesystem::is_directory(file, none)) fail(file.string(), ": must be a file, got a directory");
    if (!(scale > 0.0 && std::isfinite(scale))) fail(file.string(), ": scale must be in (0, inf), got ", scale);
}

} // namespace

TetMesh loadTetMesh(const std::filesystem::path& file, double scale, const std::string& labels)
{
    checkAsked(file, scale);
    TetMesh mesh = readTetMesh(file, labels);
    multiply(mesh.nodes, scale);
    return mesh;
}

TriangleMesh loadTriangleMesh(const std::filesystem::path& file, double scale)
{
    checkAsked(file, scale);
    TriangleMesh mesh = readTriangleMesh(file);
    multiply(mesh.vertices, scale);
    return mesh;
}

} // namespace filasofia::geometry

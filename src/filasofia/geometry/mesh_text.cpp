#include "filasofia/geometry/mesh_text.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/texture_seams.h"
#include "filasofia/geometry/vtk_reader.h"

#include <charconv>
#include <span>

namespace filasofia::geometry {
namespace {

/// Appends numbers with a space before each; read back, they have the same bits.
template <class Number> void append(std::string& out, std::span<const Number> numbers)
{
    char digits[32];
    for (const Number number : numbers) {
        out += ' ';
        out.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
    }
}
void append(std::string& out, Vec3 point)
{
    const double numbers[] = {point.x, point.y, point.z};
    append<double>(out, numbers);
}

void appendLine(std::string& out, std::string_view head, std::size_t count, std::string_view tail = {})
{
    out += head;
    out += std::to_string(count);
    out += tail;
    out += '\n';
}

} // namespace

std::string gmshText(const TetMesh& mesh)
{
    std::string out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    if (!mesh.labelNames.empty()) {
        appendLine(out, "$PhysicalNames\n", mesh.labelNames.size());
        for (const MeshLabel& each : mesh.labelNames)
            out += "3 " + std::to_string(each.label) + " \"" + each.name + "\"\n";
        out += "$EndPhysicalNames\n";
    }
    appendLine(out, "$Nodes\n", mesh.nodes.size());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        out += std::to_string(i + 1);
        append(out, mesh.nodes[i]);
        out += '\n';
    }
    appendLine(out, "$EndNodes\n$Elements\n", mesh.tetrahedra.size());
    for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
        const Tetrahedron& t = mesh.tetrahedra[i];
        const int label = mesh.labels.empty() ? 0 : mesh.labels[i];
        const int numbers[] = {4, 2, label, label, t[0] + 1, t[1] + 1, t[2] + 1, t[3] + 1};
        out += std::to_string(i + 1);
        append<int>(out, numbers);
        out += '\n';
    }
    return out + "$EndElements\n";
}

std::string vtkText(const TriangleMesh& mesh)
{
    std::string out = "# vtk DataFile Version 3.0\na surface\nASCII\nDATASET POLYDATA\n";
    appendLine(out, "POINTS ", mesh.vertices.size(), " double");
    for (const Vec3 each : mesh.vertices) {
        append(out, each);
        out += '\n';
    }
    appendLine(out, "POLYGONS " + std::to_string(mesh.triangles.size()) + ' ', 4 * mesh.triangles.size());
    for (const Triangle& each : mesh.triangles) {
        out += '3';
        append<int>(out, each);
        out += '\n';
    }
    if (mesh.uv.empty()) return out;
    if (perCorner(mesh)) { // VTK has no name for that
        appendLine(out, "CELL_DATA ", mesh.triangles.size());
        appendLine(out, text("FIELD FieldData 1\n", kUvOfCorners, " 6 "), mesh.triangles.size(), " double");
        for (std::size_t i = 0; i < mesh.uv.size(); ++i) {
            append<double>(out, mesh.uv[i]);
            if (i % 3 == 2) out += '\n';
        }
        return out;
    }
    appendLine(out, "POINT_DATA ", mesh.uv.size());
    out += "TEXTURE_COORDINATES uv 2 double\n";
    for (const auto& each : mesh.uv) {
        append<double>(out, each);
        out += '\n';
    }
    return out;
}

} // namespace filasofia::geometry

#include "filasofia/geometry/vtu_reader.h"

#include "filasofia/geometry/vtk_cells.h"
#include "filasofia/geometry/vtk_xml.h"

// The format: VTK user's guide, "XML file formats".
namespace filasofia::geometry {
namespace {

std::vector<Vec3> pointsOf(const VtkXml& xml, const pugi::xml_node& piece)
{
    const std::int64_t count = xml.countOf(piece, "NumberOfPoints");
    const pugi::xml_node array = xml.child(xml.child(piece, "Points"), "DataArray");
    const std::vector<double> numbers = xml.realsOf(array);
    if (numbers.size() != static_cast<std::size_t>(3 * count))
        xml.failAt(array, "Points must have 3 numbers per point (", 3 * count, "), got ", numbers.size());
    std::vector<Vec3> points;
    points.reserve(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
        const double* at = numbers.data() + 3 * i;
        if (!isFinite(Vec3{at[0], at[1], at[2]})) xml.failAt(array, "point ", i, " must be finite");
        points.push_back({at[0], at[1], at[2]});
    }
    return points;
}

/// The cells of an element with arrays; those of polydata have no types.
VtkCells cellsOf(const VtkXml& xml, const pugi::xml_node& cells, std::size_t count, bool typed)
{
    VtkCells out;
    const pugi::xml_node connectivity = xml.arrayOf(cells, "connectivity"), offsets = xml.arrayOf(cells, "offsets");
    const auto checkCount = [&](const pugi::xml_node& array, std::size_t size) {
        if (size != count) xml.failAt(array, "must have one number per cell (", count, "), got ", size);
    };
    out.connectivity = xml.integersOf(connectivity);
    out.offsets = xml.integersOf(offsets); // the ends
    checkCount(offsets, out.offsets.size());
    if (typed) {
        const pugi::xml_node types = xml.arrayOf(cells, "types");
        out.types = xml.integersOf(types);
        checkCount(types, out.types.size());
    }
    out.offsets.insert(out.offsets.begin(), 0);
    checkOffsets(out, xml.file(), xml.lineOf(offsets));
    out.places.assign(count, xml.lineOf(connectivity));
    return out;
}

VtkCells gridCellsOf(const VtkXml& xml, const pugi::xml_node& piece)
{
    const auto count = static_cast<std::size_t>(xml.countOf(piece, "NumberOfCells"));
    return cellsOf(xml, xml.child(piece, "Cells"), count, true);
}

// Every array of one number per cell: any may be the labels.
void readNumbers(const VtkXml& xml, const pugi::xml_node& piece, VtkCells& cells)
{
    for (const pugi::xml_node& array : piece.child("CellData").children("DataArray")) {
        if (array.attribute("NumberOfComponents").as_int(1) > 1) continue;
        const std::vector<double> values = xml.realsOf(array, cells.haveLabels());
        if (values.size() != cells.types.size())
            xml.failAt(array, "must have one number per cell (", cells.types.size(), "), got ", values.size());
        CellNumbers& out = cells.numbers.emplace_back(CellNumbers{array.attribute("Name").value(), {}});
        for (const double value : values)
            if (const std::optional<int> label = labelOf(value)) out.whole.push_back(*label);
        if (out.whole.size() < values.size()) out.whole.clear();
    }
}

VtkCells polygonsOf(const VtkXml& xml, const pugi::xml_node& piece)
{
    if (piece.attribute("NumberOfStrips").as_llong(0) != 0)
        xml.failAt(piece, "a surface must consist of Polys, got Strips");
    const auto count = static_cast<std::size_t>(xml.countOf(piece, "NumberOfPolys"));
    return cellsOf(xml, xml.child(piece, "Polys"), count, false);
}

/// The list of points that polydata names as their texture coordinates.
std::vector<std::array<double, 2>> textureOf(const VtkXml& xml, const pugi::xml_node& piece, std::size_t points)
{
    const pugi::xml_node data = piece.child("PointData");
    const char* named = data.attribute("TCoords").value();
    const pugi::xml_node array = data.find_child_by_attribute("DataArray", "Name", named);
    if (*named == '\0' || !array || array.attribute("NumberOfComponents").as_int(1) != 2) return {};
    const std::vector<double> numbers = xml.realsOf(array);
    if (numbers.size() != 2 * points)
        xml.failAt(array, "texture coordinates must be 2 numbers per point (", 2 * points, "), got ", numbers.size());
    std::vector<std::array<double, 2>> out;
    for (std::size_t i = 0; i < numbers.size(); i += 2) out.push_back({numbers[i], numbers[i + 1]});
    return out;
}

} // namespace

TetMesh parseVtu(std::string_view bytes, std::string_view name, const std::string& labels)
{
    const VtkXml xml(bytes, name);
    if (xml.type() != "UnstructuredGrid")
        xml.file().failAt(1, "a .vtu file must be a VTKFile of the type UnstructuredGrid");
    const pugi::xml_node piece = xml.piece();
    RawTetMesh mesh;
    const std::size_t place = xml.lineOf(piece.child("Points").child("DataArray"));
    for (const Vec3 each : pointsOf(xml, piece))
        mesh.nodes.push_back({static_cast<std::int64_t>(mesh.nodes.size()), place, each});
    VtkCells cells = gridCellsOf(xml, piece);
    readNumbers(xml, piece, cells);
    addCells(cells, labelsAmong(cells, labels, name), xml.file(), mesh);
    return resolve(mesh, xml.file(), xml.file(), name);
}

TriangleMesh parseVtuSurface(std::string_view bytes, std::string_view name)
{
    const VtkXml xml(bytes, name);
    const bool polydata = xml.type() == "PolyData";
    if (!polydata && xml.type() != "UnstructuredGrid")
        xml.file().failAt(1, "a surface must be a VTKFile of the type PolyData or UnstructuredGrid");
    const pugi::xml_node piece = xml.piece();
    RawSurface raw{.points = pointsOf(xml, piece), .keepsUnused = polydata};
    if (polydata) raw.uv = textureOf(xml, piece, raw.points.size());
    addPolygons(polydata ? polygonsOf(xml, piece) : gridCellsOf(xml, piece), xml.file(), raw);
    return resolve(raw, xml.file(), name);
}

} // namespace filasofia::geometry

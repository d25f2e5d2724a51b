#include "filasofia/geometry/vtk_reader.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/vtk_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>

// The format: VTK user's guide, "Legacy file formats"; version 5.1 has offsets and connectivity instead of counts.
namespace filasofia::geometry {
namespace {

/// A type of numbers in the file, whose name may be in any case.
struct NumberType {
    std::string_view name;
    int bytes = 0; ///< 0: no numbers, or less than a byte each; they are passed over
    bool real = false;
};
constexpr NumberType kNumberTypes[] = {
    {"char", 1},          {"unsigned_char", 1}, {"short", 2},         {"unsigned_short", 2}, {"int", 4},
    {"unsigned_int", 4},  {"long", 8},          {"vtkidtype", 4}, // written as int
    {"unsigned_long", 8}, {"vtktypeint64", 8},  {"vtktypeuint64", 8}, {"vtktypeint32", 4},   {"vtktypeuint32", 4},
    {"float", 4, true},   {"double", 8, true},  {"signed_char", 1},   {"string", 0},         {"bit", 0},
};

class VtkReader {
public:
    VtkReader(std::string_view bytes, std::string_view name) : in_(bytes, name), name_(name) {}

    TetMesh read(const std::string& labels)
    {
        readSections();
        if (cells_.types.empty()) fail(name_, ": must have CELLS and CELL_TYPES sections, found none");
        addCells(cells_, labelsAmong(cells_, labels, name_), in_, mesh_);
        return resolve(mesh_, in_, in_, name_);
    }
    TriangleMesh readSurface()
    {
        surface_ = true;
        readSections();
        if (cells_.places.empty())
            fail(name_, ": must have a ", polydata_ ? "POLYGONS section with polygons" : "CELLS section with cells",
                 ", found none");
        if (!polydata_ && cells_.types.empty()) fail(name_, ": must have a CELL_TYPES section, found none");
        RawSurface raw{.uv = uv_, .uvOfCorners = uvOfCorners_, .keepsUnused = polydata_};
        for (const RawTetMesh::Node& each : mesh_.nodes) raw.points.push_back(each.position);
        addPolygons(cells_, in_, raw);
        return resolve(raw, in_, name_);
    }

private:
    void readSections();
    void readHeader();
    void readSection(const std::string& keyword);
    void readPoints();
    void readCells(std::string_view section, VtkCells& cells);
    void readTypes();
    void readTextureCoordinates();
    void readUv(std::size_t count, const NumberType& of, std::vector<std::array<double, 2>>& out);
    void readAttribute(const std::string& keyword);
    void readArray(std::string_view name, std::int64_t components, std::int64_t tuples, const NumberType& type);
    void passOver(std::size_t count, const NumberType& type);
    void readNumbers(std::string_view name, const NumberType& type);
    [[nodiscard]] NumberType type();
    [[nodiscard]] NumberType anyType();
    void passOverOdd(std::int64_t components, std::int64_t tuples, bool bits);
    std::int64_t textCount(std::string_view what, std::size_t numbers, std::size_t rawBytes);
    std::vector<std::int64_t> readIntegers(std::size_t count, std::string_view what, int bytes);
    void beginRaw();

    NumberSource in_;
    std::string_view name_;
    bool version5_ = false;
    RawTetMesh mesh_;
    VtkCells cells_;
    std::int64_t attributes_ = 0; ///< number of values that the attributes now have
    bool ofCells_ = false;        ///< they are those of cells
    bool surface_ = false;        ///< the polygons are asked for
    bool polydata_ = false;       ///< the cells are its polygons
    std::vector<std::array<double, 2>> uv_;
    std::vector<std::array<double, 2>> uvOfCorners_;
};

void VtkReader::readSections()
{
    readHeader();
    for (std::string word = lowered(in_.word()); !word.empty(); word = lowered(in_.word())) readSection(word);
    if (mesh_.nodes.empty()) fail(name_, ": must have a POINTS section with points, found none");
}

void VtkReader::readHeader()
{
    const std::string_view first = in_.restOfLine();
    constexpr std::string_view kBegin = "# vtk DataFile Version ";
    if (!first.starts_with(kBegin)) in_.failHere("a legacy VTK file must begin with '", kBegin, "'");
    version5_ = first.substr(kBegin.size()).starts_with("5");
    in_.restOfLine(); // the title
    const std::string form = lowered(in_.word());
    if (form != "ascii" && form != "binary") in_.failHere("the third line must be ASCII or BINARY");
    const std::string keyword = lowered(in_.word()), dataset = lowered(in_.word());
    polydata_ = surface_ && dataset == "polydata";
    if (keyword != "dataset" || (!polydata_ && dataset != "unstructured_grid"))
        in_.failHere("the file must hold a DATASET ", surface_ ? "POLYDATA or " : "", "UNSTRUCTURED_GRID");
    if (form == "binary") in_.becomeBinary(std::endian::native == std::endian::little); // the file is big-endian
}

void VtkReader::readSection(const std::string& keyword)
{
    if (keyword == "points") return readPoints();
    if (keyword == (polydata_ ? "polygons" : "cells")) return readCells(polydata_ ? "POLYGONS" : "CELLS", cells_);
    if (!polydata_ && keyword == "cell_types") return readTypes();
    if (polydata_ && keyword == "triangle_strips")
        in_.failHere("a surface must consist of POLYGONS, got TRIANGLE_STRIPS");
    if (polydata_ && (keyword == "lines" || keyword == "vertices")) { // they bound no surface
        VtkCells passed;
        return readCells(keyword == "lines" ? "LINES" : "VERTICES", passed);
    }
    if (keyword == "cell_data" || keyword == "point_data") {
        attributes_ = in_.integerIn(in_.word(), "a number of values");
        ofCells_ = keyword == "cell_data";
        if (attributes_ < 0) in_.failHere("a number of values must be >= 0, got ", attributes_);
        if (ofCells_ && !polydata_ && attributes_ != static_cast<std::int64_t>(cells_.types.size()))
            in_.failHere("CELL_DATA must have one value per cell (", cells_.types.size(), "), got ", attributes_);
        return;
    }
    if (keyword == "metadata") { // ends with an empty line
        in_.restOfLine();
        while (in_.remaining() > 0 && in_.restOfLine().find_first_not_of(" \r\t") != std::string_view::npos) {
        }
        return;
    }
    readAttribute(keyword);
}

NumberType VtkReader::anyType()
{
    const std::string_view word = in_.word();
    const auto* found = std::ranges::find(kNumberTypes, lowered(word), &NumberType::name);
    if (found == std::end(kNumberTypes)) in_.failHere("a type of numbers must be char to double, got ", quoted(word));
    return *found;
}

NumberType VtkReader::type()
{
    const NumberType of = anyType();
    if (of.bytes == 0) in_.failHere("a type of numbers must be char to double, got ", quoted(of.name));
    return of;
}

// Counts are text even in a binary file.
std::int64_t VtkReader::textCount(std::string_view what, std::size_t numbers, std::size_t rawBytes)
{
    const std::int64_t count = in_.integerIn(in_.word(), what);
    in_.boundCount(count, what, numbers, rawBytes);
    return count;
}

// Raw data begins after the end of the line.
void VtkReader::beginRaw()
{
    if (in_.isBinary() && in_.restOfLine().find_first_not_of(" \r\t") != std::string_view::npos)
        in_.failHere("binary data must begin on a new line");
}

std::vector<std::int64_t> VtkReader::readIntegers(std::size_t count, std::string_view what, int bytes)
{
    beginRaw();
    std::vector<std::int64_t> out;
    out.reserve(count);
    for (std::size_t i = 0; i < count; ++i) out.push_back(in_.integer(what, bytes));
    return out;
}

void VtkReader::readPoints()
{
    if (!mesh_.nodes.empty()) in_.failHere("the file has a second POINTS section; at most one is allowed");
    const std::int64_t count = textCount("the number of points", 3, 12);
    const NumberType of = type();
    if (!of.real && in_.isBinary()) in_.failHere("points must be float or double, got ", of.name);
    beginRaw();
    mesh_.nodes.reserve(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
        const double x = in_.real("a point's x", of.bytes);
        const std::size_t place = in_.place();
        const double y = in_.real("a point's y", of.bytes);
        mesh_.nodes.push_back({i, place, {x, y, in_.real("a point's z", of.bytes)}});
    }
}

void VtkReader::readCells(std::string_view section, VtkCells& cells)
{
    if (!cells.offsets.empty()) in_.failHere("the file has a second ", section, " section; at most one is allowed");
    if (version5_) {
        const std::int64_t offsets = textCount("the number of offsets", 1, 4);
        const std::int64_t nodes = textCount("the number of cells' nodes", 1, 4);
        for (const auto& [keyword, count, list] :
             {std::tuple{"offsets", offsets, &cells.offsets}, {"connectivity", nodes, &cells.connectivity}}) {
            if (lowered(in_.word()) != keyword) in_.failHere(section, " must have OFFSETS and CONNECTIVITY");
            const int bytes = type().bytes;
            in_.boundCount(count, keyword, 1, static_cast<std::size_t>(bytes));
            *list = readIntegers(static_cast<std::size_t>(count), "a cell's node or offset", bytes);
        }
        if (!cells.offsets.empty()) cells.places.assign(cells.offsets.size() - 1, in_.place());
    } else {
        const std::int64_t announced = textCount("the number of cells", 1, 4);
        const std::int64_t size = textCount("the size of the list of cells", 1, 4);
        beginRaw();
        cells.offsets.push_back(0);
        for (std::int64_t i = 0, left = size; i < announced; ++i) {
            const std::int64_t count = in_.integer("a cell's number of nodes");
            cells.places.push_back(in_.place());
            if (count < 0 || count >= left)
                in_.failHere("a cell's number of nodes must be in [0, ", std::max<std::int64_t>(0, left - 1),
                             "], what is left of the list of cells, got ", count);
            for (std::int64_t k = 0; k < count; ++k) cells.connectivity.push_back(in_.integer("a cell's node"));
            cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
            left -= count + 1;
        }
    }
    checkOffsets(cells, in_, in_.place());
}

void VtkReader::readTypes()
{
    const std::int64_t count = textCount("the number of cell types", 1, 4);
    if (static_cast<std::size_t>(count) + 1 != cells_.offsets.size())
        in_.failHere("CELL_TYPES must have one type per cell (", cells_.offsets.empty() ? 0 : cells_.offsets.size() - 1,
                     "), got ", count);
    cells_.types = readIntegers(static_cast<std::size_t>(count), "a cell's type", 4);
}

// Values of points and cells. They are passed over, but for lists of one number per cell: any may be the labels.
void VtkReader::readAttribute(const std::string& keyword)
{
    if (keyword == "field") {
        in_.word(); // its name
        const std::int64_t arrays = in_.integerIn(in_.word(), "the number of arrays");
        for (std::int64_t i = 0; i < arrays; ++i) {
            std::string_view name = in_.word();
            if (lowered(name) == "metadata") readSection("metadata"), name = in_.word();
            if (name.empty()) in_.failHere("the file ends before an array");
            const std::int64_t components = in_.integerIn(in_.word(), "a number of components");
            const std::int64_t tuples = in_.integerIn(in_.word(), "a number of values");
            readArray(name, components, tuples, anyType());
        }
        return;
    }
    const std::string_view name = in_.word();
    if (name.empty()) in_.failHere("the file ends after ", quoted(keyword));
    if (keyword == "scalars") {
        const NumberType of = anyType();
        const std::string_view components = in_.wordOnThisLine();
        if (lowered(in_.word()) != "lookup_table") in_.failHere("SCALARS must have a LOOKUP_TABLE");
        in_.word();
        return readArray(name, components.empty() ? 1 : in_.integerIn(components, "a number of components"),
                         attributes_, of);
    }
    if (keyword == "vectors" || keyword == "normals") return readArray(name, 3, attributes_, anyType());
    if (keyword == "tensors") return readArray(name, 9, attributes_, anyType());
    if (keyword == "global_ids" || keyword == "pedigree_ids") return readArray(name, 1, attributes_, anyType());
    const NumberType colour = in_.isBinary() ? NumberType{"unsigned_char", 1} : NumberType{"float", 4, true};
    if (keyword == "texture_coordinates") {
        if (surface_ && !ofCells_ && uv_.empty()) return readTextureCoordinates();
        const std::int64_t dimension = in_.integerIn(in_.word(), "a dimension");
        return readArray(name, dimension, attributes_, anyType());
    }
    if (keyword == "color_scalars")
        return readArray(name, in_.integerIn(in_.word(), "a number of components"), attributes_, colour);
    if (keyword == "lookup_table") return readArray(name, 4, in_.integerIn(in_.word(), "the size of a table"), colour);
    in_.failHere("a section must be one of VTK's, got ", quoted(keyword));
}

void VtkReader::readArray(std::string_view name, std::int64_t components, std::int64_t tuples, const NumberType& of)
{
    if (of.bytes == 0) return passOverOdd(components, tuples, of.name == "bit");
    in_.boundCount(components, "a number of components", 1, 1);
    in_.boundCount(tuples, "a number of values", 1, 1);
    if (components > 0 && tuples > std::numeric_limits<std::int64_t>::max() / components / 8)
        in_.failHere("an array of ", components, " by ", tuples, " values is too large");
    in_.boundCount(components * tuples, "a number of values", 1, static_cast<std::size_t>(of.bytes));
    const auto count = static_cast<std::size_t>(components * tuples);
    beginRaw();
    if (ofCells_ && !surface_ && components == 1 && count == cells_.types.size())
        readNumbers(name, of);
    else if (ofCells_ && surface_ && name == kUvOfCorners && components == 6 && of.real)
        readUv(count / 2, of, uvOfCorners_);
    else
        passOver(count, of);
}

// Strings are a line each or, if binary, the number of their bytes and these; the two upper bits of the first byte tell
// how many further bytes the number has (vtkDataWriter). Bits are words or, if binary, eight in a byte.
void VtkReader::passOverOdd(std::int64_t components, std::int64_t tuples, bool bits)
{
    const auto most = static_cast<std::int64_t>(8 * (in_.remaining() + 1));
    if (components < 0 || tuples < 0 || (components > 0 && tuples > most / components))
        in_.failHere("an array of ", components, " by ", tuples, " values must fit into the rest of the file");
    const auto count = static_cast<std::size_t>(components * tuples);
    if (bits) {
        beginRaw();
        return in_.isBinary() ? in_.skipBytes((count + 7) / 8, "values") : passOver(count, {});
    }
    in_.restOfLine();
    for (std::size_t i = 0; i < count; ++i) {
        if (in_.remaining() == 0) in_.failHere("the file ends before a value");
        if (!in_.isBinary()) {
            in_.restOfLine();
            continue;
        }
        const auto first = static_cast<unsigned char>(in_.byte());
        constexpr int kFurther[] = {7, 3, 1, 0};
        std::uint64_t length = first & 63u;
        for (int k = 0; k < kFurther[first >> 6u]; ++k) length = length << 8u | static_cast<unsigned char>(in_.byte());
        in_.skipBytes(length, "a string");
    }
}

void VtkReader::passOver(std::size_t count, const NumberType& of)
{
    if (in_.isBinary()) return in_.skipBytes(static_cast<std::size_t>(of.bytes) * count, "values");
    for (std::size_t i = 0; i < count; ++i)
        if (in_.word().empty()) in_.failHere("the file ends before a value");
}

void VtkReader::readTextureCoordinates()
{
    const std::int64_t dimension = in_.integerIn(in_.word(), "a dimension");
    const NumberType of = type();
    if (dimension != 2) return readArray({}, dimension, attributes_, of);
    if (attributes_ != static_cast<std::int64_t>(mesh_.nodes.size()))
        in_.failHere("POINT_DATA must have one value per point (", mesh_.nodes.size(), "), got ", attributes_);
    beginRaw();
    readUv(mesh_.nodes.size(), of, uv_);
}

void VtkReader::readUv(std::size_t count, const NumberType& of, std::vector<std::array<double, 2>>& out)
{
    out.clear();
    out.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double u = in_.real("a texture coordinate", of.bytes);
        out.push_back({u, in_.real("a texture coordinate", of.bytes)});
    }
}

// Values that are no whole numbers make no labels: the rest of such a list is passed over.
void VtkReader::readNumbers(std::string_view name, const NumberType& of)
{
    const bool loose = cells_.haveLabels();
    CellNumbers& out = cells_.numbers.emplace_back(CellNumbers{std::string(name), {}});
    const std::size_t count = cells_.types.size();
    for (std::size_t i = 0; i < count; ++i) {
        const double value =
            of.real ? loose ? in_.anyReal("a cell's value", of.bytes) : in_.real("a cell's value", of.bytes)
                    : static_cast<double>(in_.integer("a cell's value", of.bytes));
        const std::optional<int> label = labelOf(value);
        if (!label) {
            out.whole.clear();
            return passOver(count - i - 1, of);
        }
        out.whole.push_back(*label);
    }
}

} // namespace

TetMesh parseVtk(std::string_view bytes, std::string_view name, const std::string& labels)
{
    return VtkReader(bytes, name).read(labels);
}
TriangleMesh parseVtkSurface(std::string_view bytes, std::string_view name)
{
    return VtkReader(bytes, name).readSurface();
}

} // namespace filasofia::geometry

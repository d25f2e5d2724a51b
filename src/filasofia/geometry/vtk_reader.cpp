#include "filasofia/geometry/vtk_reader.h"

#include "filasofia/geometry/raw_tet_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

// The format: VTK user's guide, "Legacy file formats"; version 5.1 has offsets and connectivity instead of counts.
namespace filasofia::geometry {
namespace {

/// A type of numbers in the file, whose name may be in any case.
struct NumberType {
    std::string_view name;
    int bytes = 0;
    bool real = false;
};
constexpr NumberType kNumberTypes[] = {
    {"char", 1},          {"unsigned_char", 1}, {"short", 2},         {"unsigned_short", 2},
    {"int", 4},           {"unsigned_int", 4},  {"long", 8},          {"vtkidtype", 4}, // written as int
    {"unsigned_long", 8}, {"vtktypeint64", 8},  {"vtktypeuint64", 8}, {"vtktypeint32", 4},
    {"vtktypeuint32", 4}, {"float", 4, true},   {"double", 8, true},
};

/// VTK's types of cells: points, lines and surfaces have no volume.
bool isFlat(std::int64_t type)
{
    return (type >= 1 && type <= 9) || (type >= 21 && type <= 23) || type == 28 || type == 30 || type == 34;
}

/// The solid of a type of cells, with its nodes in the order of Gmsh; none if it cannot be split.
std::optional<Solid> toSolid(std::int64_t type, std::vector<std::int64_t>& nodes, const RawTetMesh& mesh)
{
    const auto have = [&](std::size_t count) { return nodes.size() == count; };
    if (type == 10 && have(4)) return Solid::Simplex;
    if (type == 12 && have(8)) return Solid::Hexahedron;
    if (type == 14 && have(5)) return Solid::Pyramid;
    if (type == 11 && have(8)) { // a voxel counts in x, then y, then z
        std::swap(nodes[2], nodes[3]);
        std::swap(nodes[6], nodes[7]);
        return Solid::Hexahedron;
    }
    if (type != 13 || !have(6)) return {};
    // VTK's first triangle of a wedge points outwards, but many programs write it as others do.
    const auto at = [&](std::size_t k) {
        const auto node = static_cast<std::uint64_t>(nodes[k]);
        return node < mesh.nodes.size() ? mesh.nodes[node].position : Vec3{};
    };
    if (signedVolume(at(0), at(1), at(2), at(3)) < 0.0) {
        std::swap(nodes[1], nodes[2]);
        std::swap(nodes[4], nodes[5]);
    }
    return Solid::Prism;
}

class VtkReader {
public:
    VtkReader(std::string_view bytes, std::string_view name) : in_(bytes, name), name_(name) {}

    TetMesh read()
    {
        readHeader();
        for (std::string word = lowered(in_.word()); !word.empty(); word = lowered(in_.word())) readSection(word);
        if (mesh_.nodes.empty()) fail(name_, ": must have a POINTS section with points, found none");
        if (types_.empty()) fail(name_, ": must have CELLS and CELL_TYPES sections, found none");
        addCells();
        return resolve(mesh_, in_, in_, name_);
    }

private:
    void readHeader();
    void readSection(const std::string& keyword);
    void readPoints();
    void readCells();
    void readTypes();
    void readAttribute(const std::string& keyword);
    void readArray(std::int64_t components, std::int64_t tuples, const NumberType& type);
    void passOver(std::size_t count, const NumberType& type);
    void readLabels(const NumberType& type);
    void addCells();
    [[nodiscard]] NumberType type();
    std::int64_t textCount(std::string_view what, std::size_t numbers, std::size_t rawBytes);
    std::vector<std::int64_t> readIntegers(std::size_t count, std::string_view what, int bytes);
    void beginRaw();

    NumberSource in_;
    std::string_view name_;
    bool version5_ = false;
    RawTetMesh mesh_;
    std::vector<std::size_t> places_;        ///< of the cells
    std::vector<std::int64_t> connectivity_, ///< the nodes of all cells
        offsets_, types_;                    ///< per cell: where its nodes begin (and the end), its type
    std::int64_t attributes_ = 0;            ///< number of values that the attributes now have
    bool ofCells_ = false;                   ///< they are those of cells
    std::vector<int> labels_;                ///< per cell; empty: none yet
};

void VtkReader::readHeader()
{
    const std::string_view first = in_.restOfLine();
    constexpr std::string_view kBegin = "# vtk DataFile Version ";
    if (!first.starts_with(kBegin)) in_.failHere("a legacy VTK file must begin with '", kBegin, "'");
    version5_ = first.substr(kBegin.size()).starts_with("5");
    in_.restOfLine(); // the title
    const std::string form = lowered(in_.word());
    if (form != "ascii" && form != "binary") in_.failHere("the third line must be ASCII or BINARY");
    if (lowered(in_.word()) != "dataset" || lowered(in_.word()) != "unstructured_grid")
        in_.failHere("the file must hold a DATASET UNSTRUCTURED_GRID");
    if (form == "binary") in_.becomeBinary(std::endian::native == std::endian::little); // the file is big-endian
}

void VtkReader::readSection(const std::string& keyword)
{
    if (keyword == "points") return readPoints();
    if (keyword == "cells") return readCells();
    if (keyword == "cell_types") return readTypes();
    if (keyword == "cell_data" || keyword == "point_data") {
        attributes_ = in_.integerIn(in_.word(), "a number of values");
        ofCells_ = keyword == "cell_data";
        if (attributes_ < 0) in_.failHere("a number of values must be >= 0, got ", attributes_);
        if (ofCells_ && attributes_ != static_cast<std::int64_t>(types_.size()))
            in_.failHere("CELL_DATA must have one value per cell (", types_.size(), "), got ", attributes_);
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

NumberType VtkReader::type()
{
    const std::string_view word = in_.word();
    const auto* found = std::ranges::find(kNumberTypes, lowered(word), &NumberType::name);
    if (found == std::end(kNumberTypes))
        in_.failHere("a type of numbers must be char to double, got '", word.substr(0, 40), "'");
    return *found;
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

void VtkReader::readCells()
{
    if (!offsets_.empty()) in_.failHere("the file has a second CELLS section; at most one is allowed");
    if (version5_) {
        const std::int64_t offsets = textCount("the number of offsets", 1, 4);
        const std::int64_t nodes = textCount("the number of cells' nodes", 1, 4);
        for (const auto& [keyword, count, list] :
             {std::tuple{"offsets", offsets, &offsets_}, {"connectivity", nodes, &connectivity_}}) {
            if (lowered(in_.word()) != keyword) in_.failHere("CELLS must have OFFSETS and CONNECTIVITY");
            const int bytes = type().bytes;
            in_.boundCount(count, keyword, 1, static_cast<std::size_t>(bytes));
            *list = readIntegers(static_cast<std::size_t>(count), "a cell's node or offset", bytes);
        }
        places_.assign(offsets_.size(), in_.place());
    } else {
        const std::int64_t cells = textCount("the number of cells", 1, 4);
        const std::int64_t size = textCount("the size of the list of cells", 1, 4);
        beginRaw();
        offsets_.push_back(0);
        for (std::int64_t i = 0, left = size; i < cells; ++i) {
            const std::int64_t count = in_.integer("a cell's number of nodes");
            places_.push_back(in_.place());
            if (count < 0 || count >= left)
                in_.failHere("a cell's number of nodes must be in [0, ", std::max<std::int64_t>(0, left - 1),
                             "], what is left of the list of cells, got ", count);
            for (std::int64_t k = 0; k < count; ++k) connectivity_.push_back(in_.integer("a cell's node"));
            offsets_.push_back(static_cast<std::int64_t>(connectivity_.size()));
            left -= count + 1;
        }
    }
    if (offsets_.empty() || offsets_.front() != 0 || !std::ranges::is_sorted(offsets_) ||
        offsets_.back() != static_cast<std::int64_t>(connectivity_.size()))
        in_.failHere("OFFSETS must ascend from 0 to the number of cells' nodes, ", connectivity_.size());
}

void VtkReader::readTypes()
{
    const std::int64_t count = textCount("the number of cell types", 1, 4);
    if (static_cast<std::size_t>(count) + 1 != offsets_.size())
        in_.failHere("CELL_TYPES must have one type per cell (", offsets_.empty() ? 0 : offsets_.size() - 1, "), got ",
                     count);
    types_ = readIntegers(static_cast<std::size_t>(count), "a cell's type", 4);
}

// Values of points and cells. They are passed over, but for the first list of whole numbers of cells.
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
            readArray(components, tuples, type());
        }
        return;
    }
    const std::string_view name = in_.word();
    if (name.empty()) in_.failHere("the file ends after '", keyword.substr(0, 40), "'");
    if (keyword == "scalars") {
        const NumberType of = type();
        const std::string_view components = in_.wordOnThisLine();
        if (lowered(in_.word()) != "lookup_table") in_.failHere("SCALARS must have a LOOKUP_TABLE");
        in_.word();
        return readArray(components.empty() ? 1 : in_.integerIn(components, "a number of components"), attributes_, of);
    }
    if (keyword == "vectors" || keyword == "normals") return readArray(3, attributes_, type());
    if (keyword == "tensors") return readArray(9, attributes_, type());
    if (keyword == "global_ids" || keyword == "pedigree_ids") return readArray(1, attributes_, type());
    const NumberType colour = in_.isBinary() ? NumberType{"unsigned_char", 1} : NumberType{"float", 4, true};
    if (keyword == "texture_coordinates") {
        const std::int64_t dimension = in_.integerIn(in_.word(), "a dimension");
        return readArray(dimension, attributes_, type());
    }
    if (keyword == "color_scalars")
        return readArray(in_.integerIn(in_.word(), "a number of components"), attributes_, colour);
    if (keyword == "lookup_table") return readArray(4, in_.integerIn(in_.word(), "the size of a table"), colour);
    in_.failHere("a section must be one of VTK's, got '", keyword.substr(0, 40), "'");
}

void VtkReader::readArray(std::int64_t components, std::int64_t tuples, const NumberType& of)
{
    in_.boundCount(components, "a number of components", 1, 1);
    in_.boundCount(tuples, "a number of values", 1, 1);
    if (components > 0 && tuples > std::numeric_limits<std::int64_t>::max() / components / 8)
        in_.failHere("an array of ", components, " by ", tuples, " values is too large");
    in_.boundCount(components * tuples, "a number of values", 1, static_cast<std::size_t>(of.bytes));
    const auto count = static_cast<std::size_t>(components * tuples);
    beginRaw();
    if (ofCells_ && labels_.empty() && components == 1 && count == types_.size())
        readLabels(of);
    else
        passOver(count, of);
}

void VtkReader::passOver(std::size_t count, const NumberType& of)
{
    if (in_.isBinary()) return in_.skipBytes(static_cast<std::size_t>(of.bytes) * count, "values");
    for (std::size_t i = 0; i < count; ++i)
        if (in_.word().empty()) in_.failHere("the file ends before a value");
}

// Values that are no whole numbers make no labels.
void VtkReader::readLabels(const NumberType& of)
{
    std::vector<int> found;
    bool whole = true;
    for (std::size_t i = 0; i < types_.size(); ++i) {
        const double value = of.real ? in_.real("a cell's value", of.bytes)
                                     : static_cast<double>(in_.integer("a cell's value", of.bytes));
        whole = whole && value == std::floor(value) && std::abs(value) <= std::numeric_limits<int>::max();
        found.push_back(whole ? static_cast<int>(value) : 0);
    }
    if (whole) labels_ = std::move(found);
}

void VtkReader::addCells()
{
    mesh_.labelled = !labels_.empty();
    std::vector<std::int64_t> nodes;
    for (std::size_t cell = 0; cell < types_.size(); ++cell) {
        if (isFlat(types_[cell])) continue;
        nodes.assign(connectivity_.begin() + offsets_[cell], connectivity_.begin() + offsets_[cell + 1]);
        const std::optional<Solid> solid = toSolid(types_[cell], nodes, mesh_);
        if (!solid)
            in_.failAt(places_[cell], "cell ", cell,
                       " must be a tetrahedron, hexahedron, voxel, wedge or pyramid of 4, 8, "
                       "8, 6 or 5 nodes, got VTK's type ",
                       types_[cell], " with ", nodes.size(), " nodes");
        addSolid(nodes,
                 {.number = static_cast<std::int64_t>(cell),
                  .place = places_[cell],
                  .label = mesh_.labelled ? labels_[cell] : 0,
                  .partOf = *solid},
                 in_, mesh_);
    }
}

} // namespace

TetMesh parseVtk(std::string_view bytes, std::string_view name) { return VtkReader(bytes, name).read(); }

} // namespace filasofia::geometry

#include "filasofia/geometry/tetgen_reader.h"

#include "filasofia/geometry/raw_tet_mesh.h"

// The format: Si 2020, TetGen user's manual 1.6, sections 5.2.1 (.node) and 5.2.3 (.ele). Each line is a record.
namespace filasofia::geometry {
namespace {

std::int64_t integerOnLine(NumberSource& in, std::string_view what)
{
    const std::string_view word = in.wordOnThisLine();
    if (word.empty()) in.failHere("the line ends before ", what);
    return in.integerIn(word, what);
}

void endLine(NumberSource& in, std::string_view record)
{
    if (!in.wordOnThisLine().empty())
        in.failHere(record, " has more numbers than the first line of the file announces");
}

double attribute(NumberSource& in)
{
    const std::string_view word = in.wordOnThisLine();
    if (word.empty()) in.failHere("the line ends before an attribute or marker that the first line announces");
    return in.realIn(word, "an attribute or marker");
}

// Skips attributes and markers, which are not used.
void passOver(NumberSource& in, std::int64_t numbers)
{
    for (std::int64_t i = 0; i < numbers; ++i) attribute(in);
}

// The number of values of one kind per record; the bound keeps their sum far from overflow.
std::int64_t announced(NumberSource& in, std::string_view what, std::int64_t max)
{
    const std::int64_t number = integerOnLine(in, what);
    if (number < 0 || number > max) in.failHere(what, " must be in [0, ", max, "], got ", number);
    return number;
}

constexpr std::int64_t kMaxAttributes = 1000;

void readNodes(NumberSource& in, RawTetMesh& mesh)
{
    const std::size_t count = in.count("the number of points", 4, 1, 4);
    const std::int64_t dimension = integerOnLine(in, "the dimension");
    if (dimension != 3) in.failHere("the dimension must be 3, got ", dimension);
    const std::int64_t extra =
        announced(in, "the number of attributes", kMaxAttributes) + announced(in, "the number of boundary markers", 1);
    endLine(in, "the first line");
    mesh.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        RawTetMesh::Node& node = mesh.nodes.emplace_back();
        node.number = in.integer("a point's number");
        node.place = in.place();
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word = in.wordOnThisLine();
            if (word.empty()) in.failHere("the line ends before a point's three coordinates");
            node.position[axis] = in.realIn(word, "a point's coordinate");
        }
        passOver(in, extra);
        endLine(in, "a point");
        // Points are numbered consecutively from 0 or 1; anything else means that a line is missing or doubled.
        const std::int64_t first = mesh.nodes.front().number;
        if (first != 0 && first != 1) in.failHere("the first point's number must be 0 or 1, got ", first);
        if (node.number != first + static_cast<std::int64_t>(i))
            in.failHere("this point's number must be ", first + static_cast<std::int64_t>(i), ", got ", node.number);
    }
}

void readElements(NumberSource& in, RawTetMesh& mesh)
{
    const std::size_t count = in.count("the number of tetrahedra", 5, 1, 4);
    const std::int64_t corners = integerOnLine(in, "the number of nodes per tetrahedron");
    if (corners != 4 && corners != 10)
        in.failHere("the number of nodes per tetrahedron must be 4 or 10, got ", corners);
    const std::int64_t extra = announced(in, "the number of attributes", kMaxAttributes);
    endLine(in, "the first line");
    mesh.elements.reserve(count);
    mesh.labelled = extra > 0;
    std::vector<std::int64_t> nodes(static_cast<std::size_t>(corners));
    for (std::size_t i = 0; i < count; ++i) {
        RawTetMesh::Element element;
        element.number = in.integer("a tetrahedron's number");
        element.place = in.place();
        for (std::int64_t& node : nodes) node = integerOnLine(in, "a tetrahedron's nodes");
        if (extra > 0) { // the first attribute is the region, a whole number; any other makes no labels
            const std::optional<int> label = labelOf(attribute(in));
            mesh.labelled = mesh.labelled && label;
            element.label = label.value_or(0);
            passOver(in, extra - 1);
        }
        endLine(in, "a tetrahedron");
        addSolid(nodes, element, in, mesh);
    }
}

void endFile(NumberSource& in, std::string_view records)
{
    if (!in.word().empty()) in.failHere("the file has more ", records, " than its first line announces");
}

} // namespace

TetMesh parseTetGen(NamedBytes nodeFile, NamedBytes elementFile)
{
    NumberSource nodes(nodeFile.bytes, nodeFile.name), elements(elementFile.bytes, elementFile.name);
    nodes.takeComments(), elements.takeComments();
    RawTetMesh mesh;
    readNodes(nodes, mesh);
    endFile(nodes, "points");
    readElements(elements, mesh);
    endFile(elements, "tetrahedra");
    return resolve(mesh, nodes, elements, elementFile.name);
}

} // namespace filasofia::geometry

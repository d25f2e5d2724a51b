#include "filasofia/geometry/medit_reader.h"

#include "filasofia/geometry/raw_surface.h"
#include "filasofia/geometry/raw_tet_mesh.h"

#include <algorithm>
#include <limits>

// The format: Frey 2001, "Medit: an interactive mesh visualization software" (INRIA RT-0253), section 7.2. Sections
// follow each other, each a keyword, a count and its entries; an entry ends in its reference, 0 for none.
namespace filasofia::geometry {
namespace {

struct Section {
    std::string_view keyword;
    std::size_t nodes = 0;
    std::optional<Solid> solid = {}; ///< none: a polygon
};
constexpr Section kSections[] = {{"triangles", 3},
                                 {"quadrilaterals", 4},
                                 {"tetrahedra", 4, Solid::Simplex},
                                 {"hexahedra", 8, Solid::Hexahedron},
                                 {"prisms", 6, Solid::Prism},
                                 {"pyramids", 5, Solid::Pyramid}};

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

class MeditReader {
public:
    MeditReader(std::string_view bytes, std::string_view name) : in_(bytes, name), name_(name) { in_.takeComments(); }

    TetMesh readSolids()
    {
        read();
        return resolve(mesh_, in_, in_, name_);
    }
    TriangleMesh readSurface()
    {
        read();
        surface_.first = 1;
        for (const RawTetMesh::Node& each : mesh_.nodes) surface_.points.push_back(each.position);
        return resolve(surface_, in_, name_);
    }

private:
    void read();
    void readVertices();
    void readElements(const Section& section);
    void passOver(std::string_view keyword);
    int reference();

    NumberSource in_;
    std::string_view name_;
    std::string next_; ///< the keyword that follows, in small letters
    RawTetMesh mesh_;
    RawSurface surface_;
};

void MeditReader::read()
{
    if (lowered(in_.word()) != "meshversionformatted")
        in_.failHere("a Medit file must begin with MeshVersionFormatted (text; .meshb is not read)");
    in_.integer("the version");
    bool read[std::size(kSections)] = {}, haveVertices = false;
    for (next_ = lowered(in_.word()); !next_.empty() && next_ != "end";) {
        const std::string keyword = next_;
        const auto beginOnly = [&](bool& seen) {
            if (seen) in_.failHere("the file has a second section ", keyword, "; at most one is allowed");
            seen = true;
        };
        const auto* section = std::ranges::find(kSections, keyword, &Section::keyword);
        if (keyword == "dimension") {
            const std::int64_t dimension = in_.integer("the dimension");
            if (dimension != 3) in_.failHere("the dimension must be 3, got ", dimension);
        } else if (keyword == "vertices") {
            beginOnly(haveVertices), readVertices();
        } else if (section != std::end(kSections)) {
            beginOnly(read[section - kSections]), readElements(*section);
        } else {
            passOver(keyword);
            continue;
        }
        next_ = lowered(in_.word());
    }
    if (mesh_.nodes.empty()) fail(name_, ": must have a section Vertices with points, found none");
}

int MeditReader::reference()
{
    const std::int64_t value = in_.integer("a reference");
    if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
        in_.failHere("a reference must fit into 32 bits, got ", value);
    return static_cast<int>(value);
}

// Vertices are numbered from 1.
void MeditReader::readVertices()
{
    const std::size_t count = in_.count("the number of vertices", 4, 1, 4);
    mesh_.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double x = in_.real("a vertex's x");
        const std::size_t place = in_.place();
        const double y = in_.real("a vertex's y"), z = in_.real("a vertex's z");
        mesh_.nodes.push_back({static_cast<std::int64_t>(i) + 1, place, {x, y, z}});
        reference();
    }
}

void MeditReader::readElements(const Section& section)
{
    const std::size_t count = in_.count("the number of elements", section.nodes + 1, 1, 4);
    std::vector<std::int64_t> nodes(section.nodes);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::int64_t& node : nodes) node = in_.integer("an element's node");
        const std::size_t place = in_.place();
        const auto number = static_cast<std::int64_t>(i) + 1;
        const int label = reference();
        if (!section.solid) {
            surface_.add(nodes, number, place);
            continue;
        }
        ++surface_.solids;
        mesh_.labelled = mesh_.labelled || label != 0;
        addSolid(nodes, {.number = number, .place = place, .label = label, .partOf = *section.solid}, in_, mesh_);
    }
}

// Edges, corners, normals and what programs add: a section ends where a word begins with a letter. Elements of a higher
// order have their number behind the keyword; dropping them would leave holes.
void MeditReader::passOver(std::string_view keyword)
{
    if (!isLetter(keyword.front())) in_.failHere("a section must begin here, got ", quoted(keyword));
    for (const Section& each : kSections)
        if (keyword.starts_with(each.keyword)) in_.failHere("elements must be of first order, got ", quoted(keyword));
    do next_ = lowered(in_.word());
    while (!next_.empty() && !isLetter(next_.front()));
}

} // namespace

TetMesh parseMedit(std::string_view bytes, std::string_view name) { return MeditReader(bytes, name).readSolids(); }
TriangleMesh parseMeditSurface(std::string_view bytes, std::string_view name)
{
    return MeditReader(bytes, name).readSurface();
}

} // namespace filasofia::geometry

#include "filasofia/geometry/gmsh_reader.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/gmsh_types.h"
#include "filasofia/geometry/raw_tet_mesh.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

// The format: Gmsh reference manual, "MSH file format" (4.1), "version 2 (Legacy)" and "version 1 (Legacy)".
namespace filasofia::geometry {
namespace {

// The reader goes from section to section; the versions differ only inside those of nodes and elements.
class GmshReader {
public:
    GmshReader(std::string_view bytes, std::string_view name) : in_(bytes, name), name_(name) {}

    TetMesh read()
    {
        std::string_view section = readFormat();
        const std::string_view nodes = version_ == 1 ? "$NOD" : "$Nodes";
        const std::string_view elements = version_ == 1 ? "$ELM" : "$Elements";
        bool haveNodes = false, haveElements = false, haveEntities = false;
        for (; !section.empty(); section = in_.word()) {
            if (section == nodes)
                beginOnly(section, haveNodes), readNodes(), endSection(section);
            else if (section == elements)
                beginOnly(section, haveElements), readElements(), endSection(section);
            else if (section == "$PhysicalNames")
                readNames(), endSection(section);
            else if (section == "$Entities" && version_ == 4)
                beginOnly(section, haveEntities), readEntities(), endSection(section);
            else if (section == "$PartitionedEntities")
                in_.failHere("a partitioned mesh is not read; save it without partitions");
            else
                skip(section);
        }
        if (!haveNodes) fail(name_, ": must have a ", nodes, " section, found none");
        if (!haveElements) fail(name_, ": must have an ", elements, " section, found none");
        dropRepeated();
        tellSeveral();
        label();
        return resolve(mesh_, in_, in_, name_);
    }

private:
    /// What a file says of an element besides its nodes.
    struct Tags {
        std::int64_t number = 0;
        std::size_t place = 0;
        int group = 0, entity = 0;
    };

    std::string_view readFormat();
    void readByteOrder();
    void readNames();
    void readEntities();
    void readEntity(int dimension);
    void dropRepeated();
    void tellSeveral() const;
    void label();
    void readNodes();
    void readNodes2();
    void readNodes4();
    void readElements();
    void readElements1();
    void readElements2();
    void readElements4();
    void beginOnly(std::string_view section, bool& seen);
    void endSection(std::string_view section);
    void skip(std::string_view section);
    [[nodiscard]] std::string_view endMark() const { return version_ == 1 ? "$END" : "$End"; }
    GmshType checkedType(std::int64_t type) const;
    void readElement(const Tags& tags, const GmshType& type, int rawSize);
    int labelIn(std::int64_t number, std::string_view what) const;
    std::size_t readTextCount(std::string_view what, std::size_t numbers, std::size_t rawBytes);
    void beginRaw();
    Vec3 readPosition();

    NumberSource in_;
    std::string_view name_;
    int version_ = 2; ///< 1, 2 or 4
    RawTetMesh mesh_;
    std::vector<int> groups_, entities_;  ///< per tetrahedron: physical group, 0 for none, and geometric entity
    std::map<std::int64_t, int> groupOf_; ///< a volume of version 4: its first physical group
    std::set<int> further_;               ///< physical groups of volumes that have another one before
};

// Returns the first section behind the format. A file of version 1 has none, and begins with its nodes.
std::string_view GmshReader::readFormat()
{
    const std::string_view first = in_.word();
    if (first == "$NOD") {
        version_ = 1;
        return first;
    }
    if (first != "$MeshFormat") in_.failHere("a Gmsh file must begin with $MeshFormat or, in version 1, with $NOD");
    const std::string_view version = in_.word();
    constexpr std::string_view kLegacy[] = {"2", "2.0", "2.1", "2.2"};
    if (std::ranges::find(kLegacy, version) == std::end(kLegacy) && version != "4.1")
        in_.failHere("the Gmsh format must be 2 to 2.2 or 4.1, got ", version.substr(0, 10),
                     "; Gmsh can convert the file (Mesh.MshFileVersion)");
    version_ = version == "4.1" ? 4 : 2;
    const std::int64_t binary = in_.integer("the file type");
    if (binary != 0 && binary != 1) in_.failHere("the file type must be 0 (ASCII) or 1 (binary), got ", binary);
    const std::int64_t size = in_.integer("the data size");
    if (size != 8) in_.failHere("the data size must be 8, got ", size);
    if (binary == 1) readByteOrder();
    endSection("$MeshFormat");
    return in_.word();
}

// A binary file holds the number 1 in its own byte order.
void GmshReader::readByteOrder()
{
    char end = in_.byte();
    if (end == '\r') end = in_.byte();
    if (end != '\n') in_.failHere("a binary file's format line must end after the data size");
    in_.becomeBinary(false);
    const std::int64_t one = in_.integer("the byte order");
    constexpr std::int64_t kSwappedOne = 0x01000000;
    if (one != 1 && one != kSwappedOne) in_.failHere("the byte order's number must be 1 in either order, got ", one);
    in_.becomeBinary(one == kSwappedOne);
}

void GmshReader::beginOnly(std::string_view section, bool& seen)
{
    if (seen) in_.failHere("the file has a second ", section, " section; at most one is allowed");
    seen = true;
}

// Raw data begins after the end of a line, and may itself look like white space.
void GmshReader::beginRaw()
{
    if (!in_.isBinary()) return;
    char end = in_.byte();
    if (end == '\r') end = in_.byte();
    if (end != '\n') in_.failHere("binary data must begin on a new line");
}

void GmshReader::endSection(std::string_view section)
{
    const std::string_view end = endMark(), word = in_.word();
    if (!word.starts_with(end) || word.substr(end.size()) != section.substr(1))
        in_.failHere(section, " must end with ", end, section.substr(1), " after the announced number of entries");
}

void GmshReader::skip(std::string_view section)
{
    const std::string_view end = endMark();
    if (section[0] != '$') in_.failHere("a section must begin here, with its name after a $");
    if (section.starts_with(end) || section.size() < 2 || section.size() > 100)
        in_.failHere("a section name of 1 to 98 letters must begin here, got ", end, " or a longer name");
    if (!in_.skipPast(text("\n", end, section.substr(1))))
        in_.failHere("the file ends before ", end, section.substr(1).substr(0, 40));
}

int GmshReader::labelIn(std::int64_t number, std::string_view what) const
{
    if (number < std::numeric_limits<int>::min() || number > std::numeric_limits<int>::max())
        in_.failHere(what, " must fit into 32 bits, got ", number);
    return static_cast<int>(number);
}

// The names of physical groups, as text even in a binary file. Only those of volumes name tetrahedra.
void GmshReader::readNames()
{
    const std::int64_t count = in_.integerIn(in_.word(), "the number of physical names");
    in_.boundCount(count, "the number of physical names", 3, 5);
    std::set<std::string> names;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t dimension = in_.integerIn(in_.word(), "a physical name's dimension");
        const int group = labelIn(in_.integerIn(in_.word(), "a physical group"), "a physical group");
        const std::string name(in_.textInQuotes("a physical group's name"));
        if (dimension != 3) continue;
        if (!names.insert(name).second) in_.failHere("the physical name '", name.substr(0, 40), "' is given twice");
        mesh_.labelNames.push_back({group, name});
    }
}

// Notes the first physical group of a volume, and which others it has.
void GmshReader::readEntity(int dimension)
{
    const std::int64_t tag = in_.integer("an entity's number");
    for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) in_.real("an entity's bounds");
    const std::size_t groups = in_.count("the number of an entity's physical groups", 1, 4, 8);
    for (std::size_t k = 0; k < groups; ++k) {
        const int group = labelIn(in_.integer("a physical group"), "a physical group");
        if (dimension == 3 && groupOf_.emplace(tag, group).first->second != group) further_.insert(group);
    }
    if (dimension == 0) return;
    const std::size_t bounding = in_.count("the number of an entity's bounding entities", 1, 4, 8);
    for (std::size_t k = 0; k < bounding; ++k) in_.integer("a bounding entity");
}

void GmshReader::readEntities()
{
    if (!mesh_.elements.empty()) in_.failHere("$Entities must stand before $Elements");
    beginRaw();
    std::array<std::size_t, 4> counts{};
    for (std::size_t dimension = 0; dimension < 4; ++dimension)
        counts[dimension] = in_.count("the number of entities", dimension == 0 ? 5 : 9, dimension == 0 ? 36 : 68, 8);
    for (int dimension = 0; dimension < 4; ++dimension)
        for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) readEntity(dimension);
}

// A file of version 2 has the elements of a volume once for each of its physical groups.
void GmshReader::dropRepeated()
{
    const bool one = std::ranges::all_of(groups_, [&](int each) { return each == groups_.front(); });
    if (one) return;
    std::vector<std::pair<std::array<std::int64_t, 4>, std::size_t>> sorted;
    sorted.reserve(mesh_.elements.size());
    for (std::size_t i = 0; i < mesh_.elements.size(); ++i) {
        sorted.emplace_back(mesh_.elements[i].nodes, i);
        std::ranges::sort(sorted.back().first);
    }
    std::ranges::sort(sorted);
    std::vector<bool> repeated(sorted.size());
    for (std::size_t i = 1, first = 0; i < sorted.size(); ++i) {
        if (sorted[i].first != sorted[first].first) first = i;
        const int group = groups_[sorted[i].second];
        if (i == first || group == groups_[sorted[first].second]) continue; // given twice is an Error
        repeated[sorted[i].second] = true;
        further_.insert(group);
    }
    std::erase_if(mesh_.middles, [&](const RawTetMesh::Middle& each) { return repeated[each.element]; });
    std::size_t kept = 0;
    std::vector<std::size_t> now(repeated.size()); // the places of those that stay
    for (std::size_t i = 0; i < repeated.size(); ++i) {
        if (repeated[i]) continue;
        mesh_.elements[kept] = mesh_.elements[i], groups_[kept] = groups_[i], entities_[kept] = entities_[i];
        now[i] = kept++;
    }
    for (RawTetMesh::Middle& each : mesh_.middles) each.element = now[each.element];
    mesh_.elements.resize(kept), groups_.resize(kept), entities_.resize(kept);
}

void GmshReader::tellSeveral() const
{
    if (further_.empty()) return;
    std::string groups;
    for (const int group : further_) {
        const auto named = std::ranges::find(mesh_.labelNames, group, &MeshLabel::label);
        groups += groups.empty() ? "" : ", ";
        groups += named != mesh_.labelNames.end() ? text("'", named->name, "'") : text(group);
    }
    logWarning(name_,
               ": volumes are in several physical groups; their tetrahedra are labelled by the first one, and not by ",
               groups, ": give each volume one group");
}

// Tetrahedra are labelled by their physical groups; in a file without any, by their geometric entities, if these are
// more than one.
void GmshReader::label()
{
    const auto differ = [](const std::vector<int>& list) {
        return std::ranges::any_of(list, [&](int each) { return each != list.front(); });
    };
    const bool grouped = std::ranges::any_of(groups_, [](int group) { return group != 0; });
    mesh_.labelled = grouped || differ(entities_);
    if (!grouped) mesh_.labelNames.clear();
    for (std::size_t i = 0; i < mesh_.elements.size(); ++i)
        mesh_.elements[i].label = (grouped ? groups_ : entities_)[i];
}

Vec3 GmshReader::readPosition()
{
    const double x = in_.real("a node's x");
    const double y = in_.real("a node's y");
    return {x, y, in_.real("a node's z")};
}

// Version 2 writes counts as text even in a binary file.
std::size_t GmshReader::readTextCount(std::string_view what, std::size_t numbers, std::size_t rawBytes)
{
    const std::int64_t count = in_.integerIn(in_.word(), what);
    in_.boundCount(count, what, numbers, rawBytes);
    beginRaw();
    return static_cast<std::size_t>(count);
}

// An element that names a doubled number seems at fault itself: the numbers are checked before it is read.
void GmshReader::readNodes()
{
    version_ == 4 ? readNodes4() : readNodes2();
    checkNumbers(mesh_, in_);
}

void GmshReader::readNodes2()
{
    const std::size_t count = readTextCount("the number of nodes", 4, 28);
    mesh_.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t number = in_.integer("a node's number");
        const std::size_t place = in_.place();
        mesh_.nodes.push_back({number, place, readPosition()});
    }
}

void GmshReader::readNodes4()
{
    beginRaw();
    const std::size_t blocks = in_.count("the number of node blocks", 4, 20, 8);
    const std::size_t count = in_.count("the number of nodes", 4, 32, 8);
    in_.integer("the lowest node number", 8);
    in_.integer("the highest node number", 8);
    mesh_.nodes.reserve(count);
    for (std::size_t block = 0; block < blocks; ++block) {
        const std::int64_t dimension = in_.integer("a node block's dimension");
        if (dimension < 0 || dimension > 3) in_.failHere("a block's dimension must be in [0, 3], got ", dimension);
        in_.integer("a node block's entity");
        const std::int64_t parametric = in_.integer("a node block's parametric flag");
        if (parametric != 0 && parametric != 1) in_.failHere("the parametric flag must be 0 or 1, got ", parametric);
        const std::size_t here = in_.count("the number of nodes in a block", 4, 32, 8);
        // All numbers come first, then all positions, each followed by its parameters on the curve or surface.
        const std::size_t first = mesh_.nodes.size();
        for (std::size_t i = 0; i < here; ++i) {
            const std::int64_t number = in_.integer("a node's number", 8);
            mesh_.nodes.push_back({number, in_.place(), {}});
        }
        for (std::size_t i = 0; i < here; ++i) {
            mesh_.nodes[first + i].position = readPosition();
            for (std::int64_t k = 0; k < parametric * dimension; ++k) in_.real("a node's parameter");
        }
    }
    if (mesh_.nodes.size() != count)
        in_.failHere("$Nodes announces ", count, " nodes, its blocks hold ", mesh_.nodes.size());
}

// Dropping a solid element would leave a hole; points, lines and surfaces have no volume.
GmshType GmshReader::checkedType(std::int64_t type) const
{
    const std::optional<GmshType> known = gmshType(type);
    if (!known) in_.failHere("the element type must be one of Gmsh's 1 to 31, got ", type);
    if (known->dimension == 3 && !known->solid)
        in_.failHere(
            "a solid element must be a tetrahedron, hexahedron, prism or pyramid (type 4 to 7) or a second-order "
            "tetrahedron (type 11), got a ",
            known->name, " (type ", type, ")");
    return *known;
}

void GmshReader::readElement(const Tags& tags, const GmshType& type, int rawSize)
{
    std::array<std::int64_t, 56> nodes{}; // as many as any type has
    for (int i = 0; i < type.nodes; ++i) nodes[static_cast<std::size_t>(i)] = in_.integer("an element's node", rawSize);
    if (type.dimension < 3) return;
    addSolid(std::span(nodes).first(static_cast<std::size_t>(type.nodes)),
             {.number = tags.number, .place = tags.place, .partOf = *type.solid}, in_, mesh_);
    groups_.resize(mesh_.elements.size(), tags.group);
    entities_.resize(mesh_.elements.size(), tags.entity);
}

void GmshReader::readElements()
{
    if (version_ == 1) return readElements1();
    version_ == 4 ? readElements4() : readElements2();
}

// A line is: number, type, physical group, entity, number of nodes, nodes.
void GmshReader::readElements1()
{
    const std::size_t count = readTextCount("the number of elements", 6, 6);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t number = in_.integer("an element's number");
        Tags tags{.number = number, .place = in_.place()};
        const GmshType type = checkedType(in_.integer("an element's type"));
        const std::int64_t group = in_.integer("a physical group"), entity = in_.integer("an entity's number");
        if (type.dimension == 3) tags.group = labelIn(group, "a physical group");
        if (type.dimension == 3) tags.entity = labelIn(entity, "an entity's number");
        const std::int64_t nodes = in_.integer("an element's number of nodes");
        if (nodes != type.nodes) in_.failHere("a ", type.name, " must have ", type.nodes, " nodes, got ", nodes);
        readElement(tags, type, 4);
    }
}

void GmshReader::readElements2()
{
    const std::size_t count = readTextCount("the number of elements", 4, 12);
    for (std::size_t i = 0; i < count;) {
        // In text, every element states its type; binary elements come in runs that share the type and the number of
        // tags.
        std::int64_t number = in_.isBinary() ? 0 : in_.integer("an element's number");
        std::size_t place = in_.place();
        const GmshType type = checkedType(in_.integer("an element's type"));
        const std::int64_t run = in_.isBinary() ? in_.integer("the number of elements in a run") : 1;
        if (run < 1 || static_cast<std::size_t>(run) > count - i)
            in_.failHere("the number of elements in a run must be in [1, ", count - i, "], got ", run);
        const std::size_t tags = in_.count("the number of tags", 1, 4, 4);
        for (std::int64_t k = 0; k < run; ++k) {
            if (in_.isBinary()) number = in_.integer("an element's number"), place = in_.place();
            std::array<std::int64_t, 2> groupAndEntity{};
            for (std::size_t tag = 0; tag < tags; ++tag) {
                const std::int64_t value = in_.integer("an element's tag");
                if (tag < 2) groupAndEntity[tag] = value;
            }
            Tags each{.number = number, .place = place};
            if (type.dimension == 3) {
                each.group = labelIn(groupAndEntity[0], "a physical group");
                each.entity = labelIn(groupAndEntity[1], "an entity's number");
            }
            readElement(each, type, 4);
        }
        i += static_cast<std::size_t>(run);
    }
}

void GmshReader::readElements4()
{
    beginRaw();
    const std::size_t blocks = in_.count("the number of element blocks", 4, 20, 8);
    const std::size_t count = in_.count("the number of elements", 2, 16, 8);
    in_.integer("the lowest element number", 8);
    in_.integer("the highest element number", 8);
    std::size_t held = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
        in_.integer("an element block's dimension");
        const int entity = labelIn(in_.integer("an element block's entity"), "an entity's number");
        const auto group = groupOf_.find(entity);
        const GmshType type = checkedType(in_.integer("an element block's type"));
        const std::size_t here = in_.count("the number of elements in a block", 2, 16, 8);
        for (std::size_t i = 0; i < here; ++i) {
            const std::int64_t number = in_.integer("an element's number", 8);
            readElement({.number = number,
                         .place = in_.place(),
                         .group = group == groupOf_.end() ? 0 : group->second,
                         .entity = entity},
                        type, 8);
        }
        held += here;
    }
    if (held != count) in_.failHere("$Elements announces ", count, " elements, its blocks hold ", held);
}

} // namespace

TetMesh parseGmsh(std::string_view bytes, std::string_view name) { return GmshReader(bytes, name).read(); }

} // namespace filasofia::geometry

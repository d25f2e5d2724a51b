#include "filasofia/scene/scn_source.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/kuhn.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/math/quat.h"

#include <algorithm>
#include <numbers>

namespace filasofia::scene {
namespace {

constexpr double kMostNodes = 300'000; // in a grid

constexpr int kMostBack = 10'000; // components before one that names another so

bool isNode(const pugi::xml_node& node) { return std::string_view(node.name()) == "Node"; }

/// A link such as "@../topology.position" without its data: "../topology".
std::string_view componentPath(std::string_view words)
{
    words.remove_prefix(1);
    const std::size_t slash = words.rfind('/');
    const std::size_t dot = words.find('.', slash == std::string_view::npos ? 0 : slash + 1);
    if (dot == std::string_view::npos || words.substr(dot).starts_with("..") || words == ".") return words;
    return words.substr(0, dot);
}

} // namespace

Vec3 ScnSource::Placing::operator()(Vec3 point) const
{
    return transform(pose, Vec3{scale.x * point.x, scale.y * point.y, scale.z * point.z});
}

ScnSource::ScnSource(const std::filesystem::path& file, const ImportOptions& options)
    : reader(file, options, "the scene"), folder_(std::filesystem::absolute(file).parent_path()),
      packages_(options.packages)
{
    const XmlFile& read = reader.read(file, file.string());
    root_ = {read.document.document_element(), &read};
    if (root_.tag() != "Node") reader.refuse(root_, "must be a <Node>");
}

std::vector<Element> ScnSource::nodesIn(const Element& node) const
{
    std::vector<Element> out;
    for (const pugi::xml_node& each : node.node.children())
        if (each.type() == pugi::node_element && isNode(each)) out.push_back({each, node.file});
    return out;
}

std::vector<Element> ScnSource::componentsIn(const Element& node) const
{
    std::vector<Element> out;
    for (const pugi::xml_node& each : node.node.children())
        if (each.type() == pugi::node_element && !isNode(each)) out.push_back({each, node.file});
    return out;
}

Element ScnSource::component(const Element& node, const std::vector<std::string_view>& tags) const
{
    for (const Element& each : componentsIn(node))
        if (isOneOf(each.tag(), tags)) return each;
    return {};
}

Element ScnSource::inherited(const Element& node, const std::vector<std::string_view>& tags) const
{
    for (Element at = node; at && at.tag() == "Node"; at = {at.node.parent(), at.file})
        if (const Element found = component(at, tags)) return found;
    return {};
}

Element ScnSource::nodeOf(const Element& component) { return {component.node.parent(), component.file}; }

Element ScnSource::find(const Element& node, std::string_view path) const
{
    Element at = node;
    while (!path.empty()) {
        const std::size_t slash = std::min(path.find('/'), path.size());
        const std::string_view step = path.substr(0, slash);
        path.remove_prefix(std::min(slash + 1, path.size()));
        if (step.empty() || step == ".") continue;
        if (step == "..") {
            at = {at.node.parent(), at.file};
            if (!at || at.tag() != "Node") return {};
            continue;
        }
        Element next;
        for (const pugi::xml_node& each : at.node.children()) {
            const std::string_view name = each.attribute("name").value();
            if (name == step || (name.empty() && !isNode(each) && step == each.name())) {
                next = {each, at.file};
                break;
            }
        }
        if (!next) return {};
        at = next;
    }
    return at;
}

Element ScnSource::linked(const Attribute& attribute) const
{
    if (!attribute.words.starts_with('@')) return {};
    const std::string_view path = componentPath(attribute.words);
    if (path.starts_with('[')) { // a component before this one
        int back = 0;
        for (const char c : path)
            if (c >= '0' && c <= '9') back = std::min(10 * back + (c - '0'), kMostBack);
        Element at = attribute.at;
        for (; back > 0 && at; --back) do
                at.node = at.node.previous_sibling();
            while (at.node && (at.node.type() != pugi::node_element || isNode(at.node)));
        return at;
    }
    if (path.starts_with('/')) return find(root_, path.substr(1));
    for (Element at = nodeOf(attribute.at); at && at.tag() == "Node"; at = {at.node.parent(), at.file})
        if (const Element found = find(at, path)) return found;
    return {};
}

ScnSource::Placing ScnSource::placingOf(const Element& component) const
{
    const Attributes says(component);
    Placing out;
    out.scale = reader.vector(
        says, "scale3d", {reader.number(says, "sx", 1), reader.number(says, "sy", 1), reader.number(says, "sz", 1)});
    if (const auto given = says.find("scale")) { // one number, or three
        const std::vector<double> v = reader.numbers(*given, 1, 3);
        out.scale = v.size() == 3 ? Vec3{v[0], v[1], v[2]} : v[0] * out.scale;
    }
    const Vec3 turned =
        std::numbers::pi / 180.0 *
        reader.vector(says, "rotation",
                      {reader.number(says, "rx", 0), reader.number(says, "ry", 0), reader.number(says, "rz", 0)});
    out.pose.position =
        reader.vector(says, "translation",
                      {reader.number(says, "dx", 0), reader.number(says, "dy", 0), reader.number(says, "dz", 0)});
    out.pose.orientation = axisAngle({0, 0, 1}, turned.z) * axisAngle({0, 1, 0}, turned.y) *
                           axisAngle({1, 0, 0}, turned.x); // SOFA's order of Euler angles
    return out;
}

std::filesystem::path ScnSource::fileOf(const Element& component, const char* attribute)
{
    const auto found = Attributes(component).find(attribute);
    if (!found) reader.refuse(component, text("must say its ", attribute));
    const std::filesystem::path name(found->words);
    std::error_code problem;
    const auto isThere = [&](const std::filesystem::path& folder) {
        return std::filesystem::is_regular_file(folder / name, problem);
    };
    if (isThere(folder_)) return reader.fileNamed(*found, folder_);
    for (const std::filesystem::path& each : packages_)
        if (isThere(each)) return reader.fileNamed(*found, std::filesystem::absolute(each));
    for (std::filesystem::path up = folder_; up != up.parent_path(); up = up.parent_path())
        if (isThere(up / "share")) return reader.shared(*found, up / "share");
    reader.refuse(*found, "must be a file in the folder of the scene, or in SOFA's folder share",
                  " (--package names a folder)");
}

std::shared_ptr<const geometry::TetMesh> ScnSource::gridOf(const Element& grid)
{
    const Attributes says(grid);
    std::array<int, 3> n = {2, 2, 2};
    if (const auto given = says.find("n")) {
        const std::vector<int> counts = reader.wholes(*given, closed(1, 201));
        if (counts.size() != 3) reader.refuse(*given, "must be three whole numbers");
        std::ranges::copy(counts, n.begin());
    } else {
        n = {reader.whole(says, "nx", 2, closed(1, 201)), reader.whole(says, "ny", 2, closed(1, 201)),
             reader.whole(says, "nz", 2, closed(1, 201))};
    }
    if (std::ranges::min(n) < 2) {
        reader.tell(grid, "flat grid", "a <RegularGridTopology> without cells along an axis is not read");
        return {};
    }
    if (static_cast<double>(n[0]) * n[1] * n[2] > kMostNodes)
        reader.refuse(grid, text("must have at most ", kMostNodes, " nodes"));
    Vec3 low = reader.vector(
        says, "min", {reader.number(says, "xmin", 0), reader.number(says, "ymin", 0), reader.number(says, "zmin", 0)});
    Vec3 high = reader.vector(
        says, "max", {reader.number(says, "xmax", 1), reader.number(says, "ymax", 1), reader.number(says, "zmax", 1)});
    if (!(high.x > low.x && high.y > low.y && high.z > low.z))
        reader.refuse(grid, "must have a size along each axis: max must be above min");
    const Vec3 corner = reader.vector(says, "p0", low); // takes the place of the lower one, and leaves the size
    high = high + (corner - low);
    low = corner;
    geometry::TetMesh mesh;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x)
                mesh.nodes.push_back({low.x + (high.x - low.x) * x / (n[0] - 1),
                                      low.y + (high.y - low.y) * y / (n[1] - 1),
                                      low.z + (high.z - low.z) * z / (n[2] - 1)});
    const auto node = [&](const std::array<int, 3>& at) { return at[0] + n[0] * (at[1] + n[1] * at[2]); };
    for (int z = 0; z + 1 < n[2]; ++z)
        for (int y = 0; y + 1 < n[1]; ++y)
            for (int x = 0; x + 1 < n[0]; ++x) geometry::addKuhnCell(mesh, {x, y, z}, node);
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

ScnMesh ScnSource::surfaceFile(const Element& component, const char* attribute)
{
    const std::filesystem::path file = fileOf(component, attribute);
    try {
        return std::make_shared<const geometry::TriangleMesh>(geometry::loadTriangleMesh(file));
    } catch (const Error& problem) {
        reader.tell(component, text("surface ", file.string()), text("no surface is read: ", problem.what()));
        return {};
    }
}

ScnMesh ScnSource::loaded(const Element& loader, bool surface)
{
    const std::filesystem::path file = fileOf(loader, "filename");
    const std::string extension = file.extension().string();
    const Placing placing = placingOf(loader);
    const bool solid = extension == ".msh" || extension == ".vtk" || extension == ".vtu" || extension == ".node";
    if (solid) {
        try {
            geometry::TetMesh mesh = geometry::loadTetMesh(file);
            for (Vec3& each : mesh.nodes) each = placing(each);
            if (!surface) return std::make_shared<const geometry::TetMesh>(std::move(mesh));
            return std::make_shared<const geometry::TriangleMesh>(geometry::extractSurface(mesh).mesh);
        } catch (const Error& problem) { // it may be a file of triangles
            if (extension == ".msh" || extension == ".node") {
                reader.tell(loader, text("mesh ", file.string()), text("no mesh is read: ", problem.what()));
                return {};
            }
        }
    }
    ScnMesh mesh = surfaceFile(loader, "filename");
    if (const auto* found = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&mesh)) {
        geometry::TriangleMesh moved = **found;
        for (Vec3& each : moved.vertices) each = placing(each);
        return std::make_shared<const geometry::TriangleMesh>(std::move(moved));
    }
    return mesh;
}

ScnMesh ScnSource::meshOf(const Element& component, bool surface)
{
    const auto [known, fresh] = known_.try_emplace({component.node, surface});
    Seen seen;
    if (fresh) known->second = meshOf(component, surface, seen);
    return known->second;
}

ScnMesh ScnSource::meshOf(const Element& component, bool surface, Seen& seen)
{
    if (!seen.insert(component.node).second) return {};
    const std::string_view tag = component.tag();
    if (tag.ends_with("Loader") && tag != "SphereLoader") return loaded(component, surface);
    if (tag == "RegularGridTopology") {
        if (const auto mesh = gridOf(component); !mesh)
            return {};
        else if (!surface)
            return mesh;
        else
            return std::make_shared<const geometry::TriangleMesh>(geometry::extractSurface(*mesh).mesh);
    }
    const Attributes says(component);
    for (const char* name : {"src", "tetrahedra", "triangles", "position", "hexahedra", "input"})
        if (const auto link = says.find(name))
            if (const Element from = linked(*link); from && from.node != component.node && from.tag() != "Node")
                if (ScnMesh mesh = meshOf(from, surface, seen); mesh.index() != 0) return mesh;
    if (says.has("filename") && tag.ends_with("Topology")) return loaded(component, surface);
    // A container that a topological mapping of its node fills.
    for (const Element& each : componentsIn(nodeOf(component)))
        if (each.tag().ends_with("TopologicalMapping") && each.node != component.node)
            if (ScnMesh mesh = meshOf(each, surface, seen); mesh.index() != 0) return mesh;
    return {};
}

ScnMesh ScnSource::meshIn(const Element& node, bool surface)
{
    for (const Element& each : componentsIn(node)) {
        const std::string_view tag = each.tag();
        const bool holds = tag.ends_with("TopologyContainer") || tag.ends_with("Topology") || tag.ends_with("Loader");
        if (!holds || tag == "SphereLoader") continue;
        if (ScnMesh mesh = meshOf(each, surface); mesh.index() != 0) return mesh;
    }
    if (const Element state = component(node, {"MechanicalObject"})) return meshOf(state, surface);
    return {};
}

} // namespace filasofia::scene

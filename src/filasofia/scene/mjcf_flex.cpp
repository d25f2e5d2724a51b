#include "filasofia/scene/mjcf_flex.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace filasofia::scene {
namespace {

constexpr double kMostNodes = 300'000; // all flexible bodies of a model together

enum Type : std::size_t { Grid, BoxHull, CylinderHull, EllipsoidHull, Square, Disc, Circle, MeshFile, Gmsh, Direct };
const std::vector<std::string> kTypes = {"grid", "box",    "cylinder", "ellipsoid", "square",
                                         "disc", "circle", "mesh",     "gmsh",      "direct"};

/// What a soft body of this mesh has if all its nodes are equal.
double measureOf(const FlexMesh& mesh)
{
    double sum = 0.0;
    const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(mesh.elements[k])]; };
    for (std::size_t i = 0; i < mesh.elements.size(); i += static_cast<std::size_t>(mesh.corners))
        sum += mesh.corners == 4 ? std::abs(geometry::signedVolume(at(i), at(i + 1), at(i + 2), at(i + 3)))
                                 : 0.5 * length(cross(at(i + 1) - at(i), at(i + 2) - at(i)));
    return sum;
}

/// Gives the vertices of a mesh the numbers and the order that they have in the OBJ file which it was read from, where
/// MuJoCo leaves them. Returns false, and changes nothing, if they are not all found there.
bool numberAsObj(const std::filesystem::path& file, geometry::TriangleMesh& mesh)
{
    std::vector<Vec3> points;
    std::map<std::array<float, 3>, int> numbers; // the reader keeps floats
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string tag;
        Vec3 p;
        if (!(words >> tag) || tag != "v" || !(words >> p.x >> p.y >> p.z)) continue;
        numbers.emplace(std::array{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
                        static_cast<int>(points.size()));
        points.push_back(p);
    }
    const auto numberAt = [&](Vec3 at) {
        const auto found = numbers.find({static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)});
        if (found != numbers.end()) return found->second;
        // The reader may round a number otherwise, by its last bit.
        const auto isIt = [&](Vec3 p) { return length(p - at) <= 1e-6 * (length(p) + length(at)); };
        const auto near = std::ranges::find_if(points, isIt);
        return near == points.end() ? -1 : static_cast<int>(near - points.begin());
    };
    std::vector<int> numberOf;
    for (const Vec3& each : mesh.vertices)
        if (numberOf.push_back(numberAt(each)); numberOf.back() < 0) return false;
    for (geometry::Triangle& triangle : mesh.triangles)
        for (int& node : triangle) node = numberOf[static_cast<std::size_t>(node)];
    mesh.vertices = std::move(points);
    mesh.uv.clear(); // no flexible body has them
    return true;
}

} // namespace

void MjcfFlex::readParts(Flex& flex)
{
    const std::vector<Element> parts = source_.childrenOf(flex.says.element());
    reader_.refuseSecond(parts, {"edge", "elasticity", "contact"});
    for (const Element& each : parts) {
        if (each.tag() == "edge") {
            reader_.tellUnread(each, {"equality"});
            flex.edge = each;
        } else if (each.tag() == "elasticity") {
            reader_.tellUnread(each, {"young", "poisson", "damping", "thickness", "elastic2d"});
            flex.elasticity = each;
        } else if (each.tag() == "contact") {
            reader_.tellUnread(each, {"selfcollide", "internal", "contype", "conaffinity", "friction"});
            flex.contact = each;
        } else if (each.tag() == "pin") {
            reader_.tellUnread(each, {"id", "range", "grid", "gridrange"});
            flex.pins.push_back(each);
        } else {
            reader_.tellUnread(each);
        }
    }
}

void MjcfFlex::pin(const Flex& flex, const MjcfPlace& place, physics::SoftBodyDef& def) const
{
    physics::AttachmentDef pins;
    for (std::size_t i = 0; i < flex.pinned.size(); ++i)
        if (flex.pinned[i]) pins.nodes.push_back(static_cast<int>(i));
    if (bodies_.trees[place.tree].isMoved()) {
        pins.to = BodyId{static_cast<std::uint32_t>(place.tree + 1)};
        pins.element = place.link;
    }
    if (!pins.nodes.empty()) def.attachments.push_back(pins);
}

std::optional<SceneBody> MjcfFlex::read(const MjcfPending& pending)
{
    Flex flex{Attributes(pending.element)};
    reader_.tellUnread(pending.element,
                       {"name",  "dim",   "dof",    "type",   "count", "spacing",   "point",  "element",
                        "mass",  "file",  "rigid",  "pos",    "quat",  "axisangle", "xyaxes", "zaxis",
                        "euler", "scale", "origin", "radius", "rgba",  "material"});
    flex.dim = reader_.whole(flex.says, "dim", 2, closed(1, 3));
    flex.type = reader_.oneOf(flex.says, "type", Grid, kTypes);
    if (flex.type == Circle) flex.dim = 1;
    if (flex.type == Square || flex.type == Disc) flex.dim = 2;
    if (flex.dim == 1) {
        reader_.tell(pending.element, "flexcomp.dim1", "<flexcomp> of dimension 1 is not read: there are no rods");
        return {};
    }
    readParts(flex);
    readMesh(flex);
    readPins(flex);
    MjcfPlace place = pending.place;
    place.pose = place.pose * source_.poseOf(flex.says);
    const bool all = std::ranges::find(flex.pinned, false) == flex.pinned.end();
    if (reader_.flag(flex.says, "rigid", false) || all) {
        addRigid(flex, place);
        return {};
    }
    SceneBody body{.def = {}, .show = {{}}};
    physics::SoftBodyDef def = softBody(flex);
    def.pose = bodies_.worldPose(place);
    for (const Vec3& each : flex.mesh.nodes) bounds_ = merged(bounds_, transform(def.pose, each));
    pin(flex, place, def);
    const MjcfSource::Look look = source_.lookOf(flex.says);
    if (look.material) body.show[0].material = *look.material;
    if (look.hidden) body.show.clear();
    body.def = std::move(def);
    body.places.emplace("", pending.element.place());
    return body;
}

void MjcfFlex::checkCount(const Flex& flex, double nodes)
{
    nodes_ += nodes;
    if (nodes_ > kMostNodes)
        reader_.refuse(flex.says.element(),
                       text("must leave at most ", kMostNodes, " nodes in the model, got ", nodes_, " up to here"));
}

FlexMesh MjcfFlex::gridOf(const Flex& flex) const
{
    const Vec3 spacing = reader_.vector(flex.says, "spacing", {0.02, 0.02, 0.02}, closed(1e-6, kFarthestShape));
    const auto shape = flex.type == EllipsoidHull  ? FlexShape::Ellipsoid
                       : flex.type == CylinderHull ? FlexShape::Cylinder
                                                   : FlexShape::Box;
    if (flex.type == BoxHull || flex.type == CylinderHull || flex.type == EllipsoidHull)
        return flexHull(flex.count, spacing, shape, flex.dim == 3);
    return flex.dim == 3 ? flexGrid(flex.count, spacing) : flexSheet(flex.count, spacing, flex.type == Disc);
}

void MjcfFlex::readMesh(Flex& flex)
{
    const Element element = flex.says.element();
    if (flex.type == MeshFile || flex.type == Gmsh || flex.type == Direct) {
        flex.mesh = flex.type == Direct ? directMesh(flex) : fileMesh(flex);
        checkCount(flex, static_cast<double>(flex.mesh.nodes.size()));
        const Vec3 scale = reader_.vector(flex.says, "scale", {1, 1, 1}, closed(1e-9, 1e9));
        for (Vec3& each : flex.mesh.nodes) each = {scale.x * each.x, scale.y * each.y, scale.z * each.z};
        if (flex.mesh.elements.empty()) reader_.refuse(element, "must have an element");
        return;
    }
    const bool hull = flex.type == BoxHull || flex.type == CylinderHull || flex.type == EllipsoidHull;
    if (const auto found = flex.says.find("count")) {
        const std::vector<int> v = reader_.wholes(*found, closed(1, 1'000'000'000));
        if (v.size() != 3) reader_.refuse(*found, "must be 3 numbers");
        flex.count = {v[0], v[1], v[2]};
        const int axes = hull || flex.dim == 3 ? 3 : 2;
        if (*std::ranges::min_element(v.begin(), v.begin() + axes) < 2) reader_.refuse(*found, "must be >= 2");
    }
    if (!hull && flex.dim == 2) flex.count[2] = 1;
    checkCount(flex, nodesOfGrid(flex.count)); // also for a hull, whose numbers are found in its grid
    flex.mesh = gridOf(flex);
}

FlexMesh MjcfFlex::fileMesh(const Flex& flex)
{
    const auto file = flex.says.find("file");
    if (!file) reader_.refuse(flex.says.element(), "must say its file");
    const std::filesystem::path path = reader_.fileNamed(*file, reader_.folder() / source_.compiler.meshFolder);
    const Vec3 origin = reader_.vector(flex.says, "origin", {});
    try {
        if (flex.type == MeshFile) return surfaceMesh(flex, path, origin);
        const geometry::TetMesh read = geometry::loadTetMesh(path);
        FlexMesh mesh{.nodes = read.nodes};
        for (const geometry::Tetrahedron& each : read.tetrahedra)
            mesh.elements.insert(mesh.elements.end(), each.begin(), each.end());
        return mesh;
    } catch (const Error& error) {
        fail(flex.says.element().place(), ": ", flex.says.element().path(), ": ", error.what());
    }
}

FlexMesh MjcfFlex::surfaceMesh(const Flex& flex, const std::filesystem::path& file, Vec3 origin)
{
    geometry::TriangleMesh surface = geometry::loadTriangleMesh(file);
    const bool isObj = file.extension() == ".obj" || file.extension() == ".OBJ";
    if (isObj && !numberAsObj(file, surface) && !flex.pins.empty())
        reader_.note(flex.says.element(), "pin of a mesh",
                     "<pin> numbers the vertices of this file as its triangles first use them");
    if (flex.dim == 3) return flexFan(surface, origin);
    FlexMesh mesh{.nodes = surface.vertices, .corners = 3};
    for (const geometry::Triangle& each : surface.triangles)
        mesh.elements.insert(mesh.elements.end(), each.begin(), each.end());
    return mesh;
}

FlexMesh MjcfFlex::directMesh(const Flex& flex) const
{
    const auto points = flex.says.find("point"), elements = flex.says.find("element");
    if (!points || !elements) reader_.refuse(flex.says.element(), "must say its point and element");
    FlexMesh mesh{.corners = flex.dim + 1};
    constexpr auto most = static_cast<std::size_t>(3 * kMostNodes);
    const std::vector<double> v = reader_.numbers(*points, 3, most, closed(-kFarthestShape, kFarthestShape));
    if (v.size() % 3 != 0) reader_.refuse(*points, "must be 3 numbers for each point");
    for (std::size_t i = 0; i < v.size(); i += 3) mesh.nodes.push_back({v[i], v[i + 1], v[i + 2]});
    mesh.elements = reader_.wholes(*elements, closed(0, static_cast<double>(mesh.nodes.size() - 1)));
    if (mesh.elements.size() % static_cast<std::size_t>(mesh.corners) != 0)
        reader_.refuse(*elements, text("must be ", mesh.corners, " points for each element"));
    return mesh;
}

void MjcfFlex::pinGrid(Flex& flex, const Attribute& found, bool ranges) const
{
    if (flex.type != Grid) reader_.refuse(found, "needs a flexcomp of type grid");
    const std::vector<int> v = reader_.wholes(found, closed(0, 1'000'000'000));
    const auto dim = static_cast<std::size_t>(flex.dim), step = ranges ? 2 * dim : dim;
    if (v.size() % step != 0) reader_.refuse(found, text("must be ", step, " numbers for each pin"));
    for (std::size_t i = 0; i < v.size(); i += step) {
        std::array<int, 3> low{}, high{};
        for (std::size_t k = 0; k < dim; ++k) {
            low[k] = v[i + k];
            high[k] = v[i + k + (ranges ? dim : 0)];
            if (low[k] >= flex.count[k] || high[k] >= flex.count[k]) reader_.refuse(found, "must be in the grid");
            if (low[k] > high[k]) reader_.refuse(found, "must be ranges that ascend");
        }
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z)
                    flex.pinned[static_cast<std::size_t>((x * flex.count[1] + y) * flex.count[2] + z)] = true;
    }
}

void MjcfFlex::readPins(Flex& flex) const
{
    const std::size_t dof = reader_.oneOf(flex.says, "dof", 0, {"full", "radial", "trilinear", "quadratic", "2d"});
    if (dof != 0)
        reader_.note(flex.says.element(), "dof", "<flexcomp> dof is read as full: every node moves in all directions");
    flex.pinned.assign(flex.mesh.nodes.size(), false);
    if (dof == 1) flex.pinned[0] = true; // the middle, which the other nodes are drawn to
    const Range nodes = closed(0, static_cast<double>(flex.pinned.size() - 1));
    for (const Element& each : flex.pins) {
        const Attributes says(each);
        if (const auto found = says.find("id"))
            for (const int id : reader_.wholes(*found, nodes)) flex.pinned[static_cast<std::size_t>(id)] = true;
        if (const auto found = says.find("range")) {
            const std::vector<int> v = reader_.wholes(*found, nodes);
            if (v.size() % 2 != 0) reader_.refuse(*found, "must be 2 numbers for each range");
            for (std::size_t i = 0; i < v.size(); i += 2)
                if (v[i] > v[i + 1]) reader_.refuse(*found, "must be ranges that ascend");
            for (std::size_t i = 0; i < v.size(); i += 2)
                for (int k = v[i]; k <= v[i + 1]; ++k) flex.pinned[static_cast<std::size_t>(k)] = true;
        }
        if (const auto found = says.find("grid")) pinGrid(flex, *found, false);
        if (const auto found = says.find("gridrange")) pinGrid(flex, *found, true);
    }
    const std::vector<int> numbers = dropUnused(flex.mesh);
    std::vector<bool> kept(flex.mesh.nodes.size());
    for (std::size_t i = 0; i < numbers.size(); ++i)
        if (numbers[i] >= 0) kept[static_cast<std::size_t>(numbers[i])] = flex.pinned[i];
    flex.pinned = std::move(kept);
}

double MjcfFlex::standInYoung(const Flex& flex) const
{
    // As stiff that a wave crosses it in the time in which MuJoCo's constraints of its edges settle, 0.02 s by default.
    const geometry::Box box = geometry::boxAround(flex.mesh.nodes);
    const double size = length(box.high - box.low), thickness = flex.dim == 3 ? 1.0 : 0.01;
    const double mass = reader_.number(flex.says, "mass", 1.0, closed(1e-12, 1e9));
    const double density = mass / std::max(measureOf(flex.mesh) * thickness, 1e-12);
    return std::clamp(density * (size / 0.02) * (size / 0.02), 100.0, 1e9);
}

void MjcfFlex::readElasticity(Flex& flex, physics::SoftBodyDef& def)
{
    const Element at = flex.elasticity ? flex.elasticity : flex.says.element();
    const Attributes says(at);
    double young = 0.0, poisson = 0.0, thickness = -1.0;
    std::size_t kind = 0;
    if (flex.elasticity) {
        young = reader_.number(says, "young", 0.0, closed(0, 1e15));
        poisson = reader_.number(says, "poisson", 0.0, closedOpen(0, 0.5));
        def.rayleigh.stiffness = reader_.number(says, "damping", 0.0, closed(0, 1e9));
        thickness = reader_.number(says, "thickness", -1.0, closed(-1, 1e3));
        kind = reader_.oneOf(says, "elastic2d", 0, {"none", "bend", "stretch", "both"});
    }
    if (flex.edge && reader_.oneOf(Attributes(flex.edge), "equality", 0, {"false", "true", "vert", "strain"}) != 0)
        reader_.tell(flex.edge, "edge.equality", "<edge> equality is not read: edges stretch as the material does");
    if (young == 0.0 || (flex.dim == 2 && kind == 0)) {
        young = young > 0.0 ? young : standInYoung(flex);
        reader_.note(
            at, "no young",
            text("<flexcomp> has no elasticity of its own: a Young's modulus of ", young, " Pa is taken in its place"));
    }
    if (flex.dim == 3) {
        def.material =
            physics::FemMaterial{.youngModulus = young, .poissonRatio = poisson, .law = physics::StVenantKirchhoff{}};
        return;
    }
    if (!(thickness > 0.0)) {
        thickness = 0.01;
        if (kind != 0) reader_.refuse(at, "must have a thickness > 0");
        reader_.note(at, "no thickness", "<flexcomp> has no thickness: 0.01 m is taken");
    }
    if (kind == 1) reader_.note(at, "bend", "elastic2d=\"bend\": the sheet also stretches, by its Young's modulus");
    def.material = physics::ShellMaterial{.youngModulus = young,
                                          .poissonRatio = poisson,
                                          .thickness = thickness,
                                          .bendingScale = kind == 1 || kind == 3 ? 1.0 : 0.0};
}

void MjcfFlex::readContact(const Flex& flex, double radius, physics::SoftBodyDef& def)
{
    physics::CollisionDef model{.proximity = std::max(0.5e-3, radius), .self = true};
    def.friction = 1.0;
    if (flex.contact) {
        const Attributes says(flex.contact);
        model.self = reader_.oneOf(says, "selfcollide", 1, {"none", "auto", "narrow", "bvh", "sap"}) != 0;
        if (reader_.flag(says, "internal", false))
            reader_.tell(says.element(), "contact.internal",
                         "<contact> internal is not read: elements resist by their material");
        def.friction = frictionOf(reader_, says);
        const auto group = groupOf(reader_, says);
        if (!group) return;
        model.group = *group;
    }
    def.collision.push_back(model);
}

physics::SoftBodyDef MjcfFlex::softBody(Flex& flex)
{
    physics::SoftBodyDef def{.rayleigh = {0.0, 0.0}};
    const std::string name = reader_.word(flex.says, "name");
    def.name = name.empty() ? text("flex ", ++unnamed_) : name;
    def.mass = physics::TotalMass{reader_.number(flex.says, "mass", 1.0, closed(1e-12, 1e9))};
    readElasticity(flex, def);
    readContact(flex, reader_.number(flex.says, "radius", 0.005, closed(0, 1e3)), def);
    if (flex.dim == 3)
        def.mesh = std::make_shared<const geometry::TetMesh>(tetrahedraOf(flex.mesh));
    else
        def.mesh = std::make_shared<const geometry::TriangleMesh>(trianglesOf(flex.mesh));
    return def;
}

void MjcfFlex::addRigid(const Flex& flex, const MjcfPlace& place)
{
    if (flex.dim == 3) try {
            geometry::check(tetrahedraOf(flex.mesh), flex.says.element().path());
        } catch (const Error& error) {
            fail(flex.says.element().place(), ": ", error.what());
        }
    geometry::TriangleMesh surface =
        flex.dim == 3 ? geometry::extractSurface(tetrahedraOf(flex.mesh)).mesh : trianglesOf(flex.mesh);
    for (Vec3& each : surface.vertices) each = transform(place.pose, each);
    const auto mesh = std::make_shared<const geometry::TriangleMesh>(std::move(surface));
    physics::SoftBodyDef contact;
    readContact(flex, 0.0, contact);
    RigidTree& tree = bodies_.trees[place.tree];
    for (const physics::CollisionDef& each : contact.collision)
        tree.def.collision.push_back({.mesh = mesh, .element = place.link, .group = each.group});
    const MjcfSource::Look look = source_.lookOf(flex.says);
    if (!look.hidden) tree.show.push_back({.surface = mesh, .element = place.link, .material = look.material});
}

} // namespace filasofia::scene

#include "filasofia/scene/mjcf_source.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/math/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::scene {
namespace {

constexpr std::string_view kMain = "main";

const std::map<std::string_view, std::vector<std::string_view>> kCarried = {
    {"geom",
     {"name",   "class", "type",    "size",     "pos",  "quat",     "axisangle", "xyaxes",  "zaxis",       "euler",
      "fromto", "mass",  "density", "friction", "rgba", "material", "mesh",      "contype", "conaffinity", "group"}},
    {"joint",
     {"name", "class", "type", "pos", "axis", "range", "limited", "ref", "damping", "frictionloss", "armature",
      "stiffness", "springref"}},
    {"mesh", {"name", "class", "file", "scale", "vertex", "face"}},
    {"material", {"name", "class", "rgba"}},
    {"camera", {"name", "class", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fovy", "mode"}},
    {"site", // what it looks like is told once
     {"name", "class", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto", "type", "size", "rgba",
      "material", "group"}},
    {"light", {"name", "class", "pos", "dir", "directional", "type", "castshadow", "mode"}},
    {"motor", {"name", "class", "joint"}},
    {"position", {"name", "class", "joint", "kp", "kv", "gear", "forcerange", "forcelimited"}},
    {"general",
     {"name", "class", "joint", "gear", "gainprm", "biastype", "biasprm", "gaintype", "forcerange", "forcelimited"}},
};

std::vector<std::string_view> tagsWithDefaults()
{
    std::vector<std::string_view> tags;
    for (const auto& each : kCarried) tags.push_back(each.first);
    return tags;
}

Vec3 unit(Vec3 v, const XmlReader& reader, const Attribute& from)
{
    if (!(length(v) > 1e-9)) reader.refuse(from, "must have some length");
    return normalized(v);
}

} // namespace

Quat turnOfZ(Vec3 direction)
{
    const Vec3 axis = cross({0, 0, 1}, direction);
    if (!(length(axis) > 1e-12)) return direction.z > 0.0 ? Quat{} : Quat{0, 1, 0, 0};
    return axisAngle(axis, std::atan2(length(axis), direction.z));
}

const std::vector<std::string_view>* carriedAttributes(std::string_view tag)
{
    const auto found = kCarried.find(tag);
    return found == kCarried.end() ? nullptr : &found->second;
}

MjcfSource::MjcfSource(const std::filesystem::path& file, const ImportOptions& options)
    : reader(file, options, "the model")
{
    const XmlFile& source = reader.read(file, file.string());
    root_ = {source.document.document_element(), &source};
    if (root_.tag() != "mujoco")
        fail(root_.place(), ": a model of MuJoCo must begin with <mujoco>, got <", shortened(root_.tag()), ">");
    reader.tellUnread(root_, {"model"});
    included_.insert(std::filesystem::weakly_canonical(file));
    include(source);
    classes_.emplace(kMain, Class{});
    for (const Element& each : sections("compiler")) readCompiler(each);
    for (const Element& each : sections("default")) readClass(each, {}, 0);
    for (const Element& each : sections("asset")) readAssets(each);
}

void MjcfSource::include(const XmlFile& file)
{
    std::vector<Element> open{{file.document.document_element(), &file}};
    while (!open.empty()) {
        const Element at = open.back();
        open.pop_back();
        if (at.tag() != "include") {
            for (const pugi::xml_node inner : at.node.children())
                if (inner.type() == pugi::node_element) open.push_back({inner, &file});
            continue;
        }
        reader.tellUnread(at, {"file"});
        const auto name = Attributes(at).find("file");
        if (!name) reader.refuse(at, "must say its file");
        const std::filesystem::path path = reader.fileNamed(*name, reader.folder());
        if (!included_.insert(std::filesystem::weakly_canonical(path)).second)
            reader.refuse(*name, "must be a file that is not read yet: each is included once");
        const XmlFile& inner = reader.read(path, path.lexically_proximate(std::filesystem::current_path()).string());
        if (std::string_view(inner.document.document_element().name()) == "include")
            reader.refuse(*name, "must be a file whose first element is not <include>");
        includes_[at.node] = &inner;
        include(inner);
    }
}

std::vector<Element> MjcfSource::childrenOf(const Element& of) const
{
    std::vector<Element> all;
    for (const pugi::xml_node node : of.node.children()) {
        if (node.type() != pugi::node_element) continue;
        const auto found = includes_.find(node);
        if (found == includes_.end()) {
            all.push_back({node, of.file});
            continue;
        }
        const std::vector<Element> inner = childrenOf({found->second->document.document_element(), found->second});
        all.insert(all.end(), inner.begin(), inner.end());
    }
    return all;
}

std::vector<Element> MjcfSource::sections(std::string_view tag) const
{
    std::vector<Element> found = childrenOf(root_);
    std::erase_if(found, [&](const Element& each) { return each.tag() != tag; });
    return found;
}

void MjcfSource::readCompiler(const Element& element)
{
    const Attributes says(element);
    reader.tellUnread(element,
                      {"angle", "coordinate", "eulerseq", "meshdir", "assetdir", "autolimits", "inertiafromgeom"});
    if (says.has("angle")) compiler.degrees = reader.oneOf(says, "angle", 0, {"degree", "radian"}) == 0;
    if (const auto found = says.find("coordinate"); found && found->words != "local")
        reader.refuse(*found, "must be local");
    if (const auto found = says.find("eulerseq")) {
        const bool axes =
            found->words.size() == 3 && found->words.find_first_not_of("xyzXYZ") == std::string_view::npos;
        if (!axes) reader.refuse(*found, "must be three letters of xyz or XYZ");
        compiler.eulerOrder = found->words;
    }
    if (const auto found = says.find("assetdir")) compiler.meshFolder = found->words;
    if (const auto found = says.find("meshdir")) compiler.meshFolder = found->words;
    compiler.autoLimits = reader.flag(says, "autolimits", compiler.autoLimits);
    if (says.has("inertiafromgeom"))
        compiler.fromGeoms =
            static_cast<MjcfCompiler::FromGeoms>(reader.oneOf(says, "inertiafromgeom", 2, {"false", "true", "auto"}));
    for (const Element& inner : childrenOf(element)) reader.tellUnread(inner);
}

void MjcfSource::readClass(const Element& element, const std::string& parent, int depth)
{
    reader.tellUnread(element, {"class"});
    std::string name = reader.word(Attributes(element), "class");
    if (depth == 0 && name.empty()) name = kMain;
    if (name.empty()) reader.refuse(element, "must say its class");
    if (depth > 200) reader.refuse(element, "is nested more than 200 deep");
    if (depth > 0 && !classes_.emplace(name, Class{parent}).second)
        reader.refuse(element, "is a class that there is already");
    Class& own = classes_[name];
    const std::vector<Element> all = childrenOf(element);
    reader.refuseSecond(all, tagsWithDefaults());
    for (const Element& inner : all) {
        if (inner.tag() == "default")
            readClass(inner, name, depth + 1);
        else if (const auto* carried = carriedAttributes(inner.tag())) {
            reader.tellUnread(inner, *carried);
            own.elements[std::string(inner.tag())].push_back(inner);
        } else
            reader.tell(inner, text("default ", inner.tag()),
                        text("a default <", shortened(inner.tag()), "> is not read"));
    }
}

void MjcfSource::readAssets(const Element& assets)
{
    for (const Element& each : childrenOf(assets)) {
        const bool mesh = each.tag() == "mesh";
        if (!mesh && each.tag() != "material") {
            reader.tellUnread(each);
            continue;
        }
        std::string name = reader.word(Attributes(each), "name");
        if (mesh && name.empty()) name = std::filesystem::path(reader.word(Attributes(each), "file")).stem().string();
        if (name.empty()) reader.refuse(each, "must have a name");
        if (!(mesh ? meshAssets_ : materials_).emplace(name, each).second)
            reader.refuse(each, "has a name that another one has");
    }
}

const MjcfSource::Class& MjcfSource::classNamed(const Attribute& name) const
{
    return reader.named(name, classes_, "must be a class");
}

Attributes MjcfSource::attributesOf(const Element& element, const std::string& childClass)
{
    if (const auto* carried = carriedAttributes(element.tag())) reader.tellUnread(element, *carried);
    std::vector<Element> layers{element};
    const auto own = Attributes(element).find("class");
    const Class* from = own ? &classNamed(*own) : &classes_.find(childClass.empty() ? kMain : childClass)->second;
    for (;;) {
        if (const auto found = from->elements.find(element.tag()); found != from->elements.end())
            layers.insert(layers.end(), found->second.rbegin(), found->second.rend());
        if (from->parent.empty()) return Attributes(std::move(layers));
        from = &classes_.find(from->parent)->second;
    }
}

std::string MjcfSource::childClassOf(const Element& element, const std::string& outer) const
{
    const auto own = Attributes(element).find("childclass");
    if (!own) return outer;
    static_cast<void>(classNamed(*own));
    return std::string(own->words);
}

double MjcfSource::angle(double value) const { return compiler.degrees ? value * std::numbers::pi / 180.0 : value; }

Quat MjcfSource::eulerOf(const std::vector<double>& angles) const
{
    Quat turn;
    for (std::size_t k = 0; k < 3; ++k) {
        const char axis = compiler.eulerOrder[k];
        const bool fixed = axis < 'a'; // capitals mean axes that do not turn along
        const auto at = static_cast<std::size_t>((fixed ? axis - 'A' : axis - 'a') - ('x' - 'a'));
        const std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
        const Quat step = axisAngle(axes[at], angle(angles[k]));
        turn = fixed ? step * turn : turn * step;
    }
    return turn;
}

Quat MjcfSource::turnOf(const Attribute& found) const
{
    const std::size_t count = found.name == "quat" || found.name == "axisangle" ? 4 : found.name == "xyaxes" ? 6 : 3;
    const std::vector<double> v = reader.numbers(found, count, count);
    if (found.name == "quat") {
        const Quat q{v[0], v[1], v[2], v[3]};
        if (!(dot(q, q) > 1e-18)) reader.refuse(found, "must have some length");
        return q == Quat{} ? q : normalized(q);
    }
    if (found.name == "axisangle") return axisAngle(unit({v[0], v[1], v[2]}, reader, found), angle(v[3]));
    if (found.name == "euler") return eulerOf(v);
    if (found.name == "zaxis") return turnOfZ(unit({v[0], v[1], v[2]}, reader, found));
    const Vec3 x = unit({v[0], v[1], v[2]}, reader, found);
    const Vec3 given{v[3], v[4], v[5]}, y = unit(given - dot(given, x) * x, reader, found);
    return toQuat(Mat3::columns(x, y, cross(x, y)));
}

Quat MjcfSource::orientationOf(const Attributes& says) const
{
    const std::initializer_list<std::string_view> ways = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};
    const auto found = says.findAny(ways);
    if (!found) return {};
    reader.refuseSecond(found->at, ways);
    return normalized(turnOf(*found));
}

Pose MjcfSource::poseOf(const Attributes& says) const
{
    return {reader.vector(says, "pos", {}, closed(-kFarthestShape, kFarthestShape)), orientationOf(says)};
}

// A mesh without faces is the hull of its vertices.
geometry::TriangleMesh MjcfSource::givenMesh(const Attributes& says) const
{
    constexpr std::size_t kMost = 1'000'000, kMostWithoutFaces = 5000; // a hull takes the square of its points in time
    const auto vertex = says.find("vertex"), face = says.find("face");
    if (!vertex) reader.refuse(says.element(), "must say its file or its vertices: other meshes are not read");
    geometry::TriangleMesh mesh;
    const std::vector<double> v = reader.numbers(*vertex, 12, 3 * (face ? kMost : kMostWithoutFaces));
    if (v.size() % 3 != 0) reader.refuse(*vertex, "must be three numbers per vertex");
    for (std::size_t i = 0; i < v.size(); i += 3) mesh.vertices.push_back({v[i], v[i + 1], v[i + 2]});
    if (!face) {
        geometry::TriangleMesh hull;
        std::map<int, int> numbers; // those points that are corners of the hull
        for (const auto& each : convexHull(mesh.vertices)) {
            geometry::Triangle& triangle = hull.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [at, added] = numbers.emplace(each[k], static_cast<int>(numbers.size()));
                if (added) hull.vertices.push_back(mesh.vertices[static_cast<std::size_t>(each[k])]);
                triangle[k] = at->second;
            }
        }
        if (hull.triangles.empty()) reader.refuse(*vertex, "must not lie in a plane");
        return hull;
    }
    const std::vector<int> corners = reader.wholes(*face, closed(0, static_cast<double>(mesh.vertices.size()) - 1.0));
    if (corners.empty() || corners.size() % 3 != 0) reader.refuse(*face, "must be three vertices per face");
    for (std::size_t i = 0; i < corners.size(); i += 3)
        mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    geometry::check(mesh, text(face->at.place(), ": ", face->at.path()));
    return mesh;
}

std::shared_ptr<const geometry::TriangleMesh> MjcfSource::meshOf(const Attribute& name)
{
    if (const auto known = meshes_.find(name.words); known != meshes_.end()) return known->second;
    const Element& asset = reader.named(name, meshAssets_, "must be a mesh of the assets");
    const Attributes says = attributesOf(asset, {});
    const auto file = says.find("file");
    const Vec3 scale = reader.vector(says, "scale", {1, 1, 1}, closed(-1e6, 1e6));
    if (scale.x * scale.y * scale.z == 0.0) reader.refuse(*says.find("scale"), "must not be 0");
    if (!file) return meshes_[std::string(name.words)] = scaled(givenMesh(says), scale);
    reader.refuseSecond(file->at, {"file", "vertex"});
    const std::filesystem::path path = reader.fileNamed(*file, reader.folder() / compiler.meshFolder);
    try {
        return meshes_[std::string(name.words)] = scaled(geometry::loadTriangleMesh(path), scale);
    } catch (const Error& error) {
        fail(asset.place(), ": ", asset.path(), ": ", error.what());
    }
}

MjcfSource::Look MjcfSource::lookOf(const Attributes& says)
{
    auto rgba = says.find("rgba");
    Element at = says.element();
    if (const auto name = says.find("material"); name && !rgba) {
        at = reader.named(*name, materials_, "must be a material of the assets");
        rgba = attributesOf(at, {}).find("rgba");
    }
    if (!rgba) return {};
    const std::vector<double> c = reader.numbers(*rgba, 4, 4, closed(0, 1));
    if (c[3] > 0.0 && c[3] < 1.0) reader.note(at, "alpha", "a colour's alpha is not read: everything is opaque");
    return {plainMaterial({c[0], c[1], c[2]}), c[3] == 0.0};
}

} // namespace filasofia::scene

#include "filasofia/scene/urdf_shapes.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/scene/collada.h"

#include <algorithm>

namespace filasofia::scene {
namespace {

constexpr Range kUrdfSize = closed(1e-7, kFarthestShape);

} // namespace

Element childOf(const Element& of, const char* tag) { return {of.node.child(tag), of.file}; }

std::vector<Element> childrenOf(const Element& of)
{
    std::vector<Element> all;
    for (const pugi::xml_node node : of.node.children())
        if (node.type() == pugi::node_element) all.push_back({node, of.file});
    return all;
}

void UrdfShapes::defineMaterial(const Element& element)
{
    const std::string name = reader_.requiredWord(Attributes(element), "name");
    if (materials_.contains(name)) reader_.refuse(element, "has a name that another one has");
    static_cast<void>(readMaterial(element));
}

std::optional<visual::Material> UrdfShapes::readMaterial(const Element& element)
{
    reader_.tellUnread(element, {"name"});
    reader_.refuseSecond(childrenOf(element), {"color"});
    const std::string name = reader_.word(Attributes(element), "name");
    for (const Element& inner : childrenOf(element))
        if (inner.tag() != "color") reader_.tellUnread(inner);
    if (const Element color = childOf(element, "color")) {
        reader_.tellUnread(color, {"rgba"});
        const auto rgba = Attributes(color).find("rgba");
        if (!rgba) reader_.refuse(color, "must say its rgba");
        const std::vector<double> c = reader_.numbers(*rgba, 4, 4, closed(0, 1));
        if (c[3] < 1.0) reader_.note(color, "alpha", "a colour's alpha is not read: everything is opaque");
        const Vec3 rgb{c[0], c[1], c[2]};
        if (!name.empty() && materials_.emplace(name, rgb).first->second != rgb)
            reader_.note(color, "second colour", "a <material> has another colour than the first one of its name");
        return plainMaterial(rgb);
    }
    if (const auto known = materials_.find(name); known != materials_.end()) return plainMaterial(known->second);
    reader_.note(element, "no colour", "a <material> without a colour is grey");
    return {};
}

/// Whether it only marks a place: some robots have boxes of size 0.
bool UrdfShapes::isNothing(const Attributes& says) const
{
    for (const std::string_view name : {"size", "radius", "length"})
        if (const auto found = says.find(name))
            if (std::ranges::count(reader_.numbers(*found, 1, 3, finite()), 0.0) > 0) return true;
    return false;
}

std::optional<Solid> UrdfShapes::readSolid(const Element& geometry)
{
    const std::vector<Element> shapes = childrenOf(geometry);
    if (shapes.size() > 1) reader_.refuse(shapes[1], "is a second shape: a <geometry> has one");
    for (const Element& inner : shapes) {
        const Attributes says(inner);
        if (inner.tag() == "mesh") return readMesh(inner);
        if (isNothing(says)) {
            reader_.note(inner, "size 0", "a shape of size 0 is left out");
            return {};
        }
        if (inner.tag() == "box") {
            reader_.tellUnread(inner, {"size"});
            if (!says.has("size")) reader_.refuse(inner, "must say its size");
            return Solid{Solid::Kind::Box, 0.5 * reader_.vector(says, "size", {}, kUrdfSize)};
        }
        if (inner.tag() == "sphere" || inner.tag() == "cylinder" || inner.tag() == "capsule") return readRound(says);
        reader_.refuse(inner, "must be a box, cylinder, sphere, capsule or mesh");
    }
    reader_.refuse(geometry, "must have a shape");
}

Solid UrdfShapes::readRound(const Attributes& says) const
{
    const Element element = says.element();
    const auto size = [&](const char* name) {
        if (!says.has(name)) reader_.refuse(element, text("must say its ", name));
        return reader_.number(says, name, 0.0, kUrdfSize);
    };
    const double radius = size("radius");
    if (element.tag() == "sphere") {
        reader_.tellUnread(element, {"radius"});
        return {Solid::Kind::Sphere, {radius, radius, radius}};
    }
    reader_.tellUnread(element, {"radius", "length"});
    const auto kind = element.tag() == "capsule" ? Solid::Kind::Capsule : Solid::Kind::Cylinder;
    return {kind, {radius, radius, 0.5 * size("length")}};
}

Solid UrdfShapes::readMesh(const Element& element)
{
    reader_.tellUnread(element, {"filename", "scale"});
    const Attributes says(element);
    const auto name = says.find("filename");
    if (!name) reader_.refuse(element, "must say its filename");
    const Vec3 scale = reader_.vector(says, "scale", {1, 1, 1}, closed(-1e6, 1e6));
    if (scale.x * scale.y * scale.z == 0.0) reader_.refuse(*says.find("scale"), "must not be 0");
    const std::filesystem::path path = reader_.resourceNamed(*name);
    const bool collada = path.extension() == ".dae" || path.extension() == ".DAE";
    auto& mesh = meshes_[path];
    if (!mesh) try {
            mesh = std::make_shared<const geometry::TriangleMesh>(collada ? loadCollada(path)
                                                                          : geometry::loadTriangleMesh(path));
        } catch (const Error& error) {
            fail(element.place(), ": ", element.path(), ": ", error.what());
        }
    return {Solid::Kind::Mesh, {}, scaled(*mesh, scale)};
}

} // namespace filasofia::scene

#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/scene/xml_source.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <variant>

/// A scene of SOFA as nodes and components that name each other.
namespace filasofia::scene {

/// What a loader or a topology holds; nothing if it is none that is read.
using ScnMesh = std::variant<std::monostate, std::shared_ptr<const geometry::TetMesh>,
                             std::shared_ptr<const geometry::TriangleMesh>>;

inline bool isOneOf(std::string_view tag, const std::vector<std::string_view>& tags)
{
    return std::ranges::find(tags, tag) != tags.end();
}

class ScnSource {
public:
    ScnSource(const std::filesystem::path& file, const ImportOptions& options);

    [[nodiscard]] Element root() const { return root_; }
    /// The nodes in a node, and its components, in order.
    [[nodiscard]] std::vector<Element> nodesIn(const Element& node) const;
    [[nodiscard]] std::vector<Element> componentsIn(const Element& node) const;
    /// The first component of a node with one of these tags.
    [[nodiscard]] Element component(const Element& node, const std::vector<std::string_view>& tags) const;
    /// The same in the node or, if it has none, in the nodes around it.
    [[nodiscard]] Element inherited(const Element& node, const std::vector<std::string_view>& tags) const;
    [[nodiscard]] static Element nodeOf(const Element& component);

    /// The component that an attribute such as "@../loader.position" names; none if it is no link, or names none.
    [[nodiscard]] Element linked(const Attribute& attribute) const;
    /// The mesh of a loader, a grid, or a topology that is made of one. `surface`: triangles are wanted.
    [[nodiscard]] ScnMesh meshOf(const Element& component, bool surface);
    /// The mesh that a node's components give it.
    [[nodiscard]] ScnMesh meshIn(const Element& node, bool surface);
    /// The surface in a file that an attribute names; nothing if the file has no triangles.
    [[nodiscard]] ScnMesh surfaceFile(const Element& component, const char* attribute);
    /// The path of a file that a component names: in the folder of the scene, in a package, or in the folder `share` of
    /// a folder above the scene, as SOFA has it.
    [[nodiscard]] std::filesystem::path fileOf(const Element& component, const char* attribute);
    /// What translation, rotation and scale of a component do to a point.
    struct Placing {
        Vec3 scale = {1, 1, 1};
        Pose pose = {};
        [[nodiscard]] Vec3 operator()(Vec3 point) const;
    };
    [[nodiscard]] Placing placingOf(const Element& component) const;

    XmlReader reader;

private:
    [[nodiscard]] Element find(const Element& node, std::string_view path) const;
    [[nodiscard]] std::shared_ptr<const geometry::TetMesh> gridOf(const Element& grid);
    using Seen = std::set<pugi::xml_node>;
    /// The same by way of what `seen` does not hold: components may name each other in a circle.
    [[nodiscard]] ScnMesh meshOf(const Element& component, bool surface, Seen& seen);
    [[nodiscard]] ScnMesh loaded(const Element& loader, bool surface);

    Element root_;
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> packages_;
    std::map<std::pair<pugi::xml_node, bool>, ScnMesh> known_; ///< of components, as surfaces or not
};

} // namespace filasofia::scene

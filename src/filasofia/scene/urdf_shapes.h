#pragma once

#include "filasofia/scene/rigid_tree.h"

#include <map>

/// What a robot in URDF looks like.
namespace filasofia::scene {

/// The first element of this tag in another; false if there is none.
Element childOf(const Element& of, const char* tag);
/// All elements in another.
std::vector<Element> childrenOf(const Element& of);

/// Reads shapes and materials.
class UrdfShapes {
public:
    explicit UrdfShapes(XmlReader& reader) : reader_(reader) {}

    /// A material of the robot, which its links use by its name.
    void defineMaterial(const Element& element);
    /// The colour of a material, which is remembered by its name; one without a colour is meant by its name.
    std::optional<visual::Material> readMaterial(const Element& element);
    /// The shape in <geometry>; nothing if it is one of size 0.
    std::optional<Solid> readSolid(const Element& geometry);

private:
    [[nodiscard]] bool isNothing(const Attributes& says) const;
    [[nodiscard]] Solid readRound(const Attributes& says) const;
    Solid readMesh(const Element& element);

    XmlReader& reader_;
    std::map<std::string, Vec3> materials_; ///< colours
    std::map<std::filesystem::path, std::shared_ptr<const geometry::TriangleMesh>> meshes_;
};

} // namespace filasofia::scene

#pragma once

#include "filasofia/scene/flex_mesh.h"
#include "filasofia/scene/mjcf_bodies.h"

/// The flexible bodies of a model of MuJoCo.
namespace filasofia::scene {

/// Reads <flexcomp>.
class MjcfFlex {
public:
    MjcfFlex(MjcfSource& source, MjcfBodies& bodies) : source_(source), reader_(source.reader), bodies_(bodies) {}

    /// A soft body, or nothing if it is rigid: then its surface is one more shape of the tree that it is in. A soft
    /// body that is pinned to what moves names the tree as BodyId{tree + 1}.
    [[nodiscard]] std::optional<SceneBody> read(const MjcfPending& flex);
    /// [m], around all of them, in our world.
    [[nodiscard]] const geometry::Box& bounds() const { return bounds_; }

private:
    /// A flexcomp and its parts while they are read.
    struct Flex {
        Attributes says;
        int dim = 2;
        std::size_t type = 0;
        std::array<int, 3> count = {10, 10, 10};
        FlexMesh mesh = {};
        std::vector<bool> pinned = {};
        Element edge = {}, elasticity = {}, contact = {};
        std::vector<Element> pins = {};
    };
    void readParts(Flex& flex);
    void readMesh(Flex& flex);
    [[nodiscard]] FlexMesh gridOf(const Flex& flex) const;
    /// The mesh in the file that it names: a surface, or tetrahedra of Gmsh.
    [[nodiscard]] FlexMesh fileMesh(const Flex& flex);
    [[nodiscard]] FlexMesh surfaceMesh(const Flex& flex, const std::filesystem::path& file, Vec3 origin);
    [[nodiscard]] FlexMesh directMesh(const Flex& flex) const;
    void checkCount(const Flex& flex, double nodes);
    void readPins(Flex& flex) const;
    void pinGrid(Flex& flex, const Attribute& found, bool ranges) const;
    [[nodiscard]] physics::SoftBodyDef softBody(Flex& flex);
    void readElasticity(Flex& flex, physics::SoftBodyDef& def);
    [[nodiscard]] double standInYoung(const Flex& flex) const;
    void readContact(const Flex& flex, double radius, physics::SoftBodyDef& def);
    void pin(const Flex& flex, const MjcfPlace& place, physics::SoftBodyDef& def) const;
    void addRigid(const Flex& flex, const MjcfPlace& place);

    MjcfSource& source_;
    XmlReader& reader_;
    MjcfBodies& bodies_;
    geometry::Box bounds_;
    double nodes_ = 0.0; ///< all that were read, together
    int unnamed_ = 0;
};

} // namespace filasofia::scene

#pragma once

#include "filasofia/physics/defs.h"
#include "filasofia/scene/scn_source.h"

/// What a soft body of SOFA is made of, and what holds and loads it.
namespace filasofia::scene {

// The components that are read, by their tags.
extern const std::vector<std::string_view> kElastic;
extern const std::vector<std::string_view> kHyperelastic;
extern const std::vector<std::string_view> kSprings;
extern const std::vector<std::string_view> kMasses;
extern const std::vector<std::string_view> kImplicit;
extern const std::vector<std::string_view> kExplicit;
extern const std::vector<std::string_view> kFixed;

class ScnTissue {
public:
    /// `unit` [m] of the scene's lengths.
    ScnTissue(ScnSource& source, double unit) : source_(source), reader_(source.reader), unit_(unit) {}

    /// From the scene's axes to ours.
    void turn(const Pose& world) { world_ = world; }
    /// Whether a component deforms, holds or loads the body of its node, and is read there.
    [[nodiscard]] static bool actsOnTissue(std::string_view tag);
    /// The elasticity of a node, if it has one that is read.
    [[nodiscard]] Element lawOf(const Element& node) const;
    /// Reads all but mesh, place, contact and picture of the node's body; `mesh` is in the scene's coordinates.
    void read(const Element& node, const geometry::TetMesh& mesh, physics::SoftBodyDef& def);

private:
    /// Tells all components of a node with one of these tags but the first.
    void tellFurther(const Element& node, const std::vector<std::string_view>& tags, std::string_view what);
    void readMaterial(const Element& law, physics::SoftBodyDef& def);
    [[nodiscard]] physics::FemMaterial hyperelastic(const Element& law);
    [[nodiscard]] double bounded(const Element& law, double poissonRatio);
    [[nodiscard]] physics::FemMaterial mooneyRivlin(const Attributes& says);
    void readSprings(const Attributes& says, physics::SoftBodyDef& def);
    /// The first of these attributes that a component has; it tells the others.
    [[nodiscard]] std::string_view oneOf(const Attributes& says, std::initializer_list<std::string_view> names);
    void readMass(const Element& node, const geometry::TetMesh& mesh, physics::SoftBodyDef& def);
    void readSolver(const Element& node, physics::SoftBodyDef& def);
    void pin(const Element& node, const geometry::TetMesh& mesh, physics::SoftBodyDef& def);
    void readForces(const Element& node, const geometry::TetMesh& mesh, physics::SoftBodyDef& def);
    /// The nodes that the indices of a component name: numbers, or those in a BoxROI.
    [[nodiscard]] std::vector<int> nodesOf(const Attributes& says, std::initializer_list<std::string_view> names,
                                           const geometry::TetMesh& mesh);
    [[nodiscard]] std::vector<int> numbered(const Attribute& indices, std::size_t nodes) const;
    /// A number, or the first of a list of one per element.
    [[nodiscard]] double firstOf(const Attributes& from, std::string_view name, double standard, const Range& range);

    ScnSource& source_;
    XmlReader& reader_;
    Pose world_;
    double unit_;
};

} // namespace filasofia::scene

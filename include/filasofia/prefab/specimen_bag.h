#pragma once

#include "filasofia/prefab/articulated_instrument.h"

namespace filasofia::prefab {

/// What may differ between bags of thin film whose mouth two arms hold open. By default it is one of polyurethane for a
/// trocar of 10 mm.
struct SpecimenBagDef {
    std::string name = "specimen bag"; ///< what errors and reports call its film, a soft body
    double arms = 65e-3;               ///< [m], > 0, of each arm, from the pivot, that the mouth is fixed to
    double depth = 80e-3;              ///< [m], > 0, from its mouth to its bottom
    int cells = 8;                     ///< [-], in [3, 100], of its mesh, along each arm
    physics::ShellMaterial film = {.youngModulus = 10e6, .poissonRatio = 0.45, .thickness = 0.1e-3};
    double density = 1150.0;         ///< [kg/m^3], > 0, of the film
    physics::Rayleigh rayleigh = {}; ///< damping of the film
    double rimStiffness = 1000.0;    ///< [N/m], in (0, inf], with which each node of the mouth is held by its arm
    std::vector<int> groups = {0};   ///< collision groups of the film; empty: it touches nothing
    double proximity = 0.5e-3;       ///< [m], >= 0, distance at which contacts are found
    double friction = 0.2;           ///< [-], >= 0, coefficient of friction
    bool self = false;               ///< whether the film collides with itself
    visual::Material material =
        visual::GlassMaterial{.tint = {0.72, 0.86, 0.94}, .roughness = 0.1, .refractiveIndex = 1.05, .thickness = 1e-3};
};
constexpr auto fields(const SpecimenBagDef*)
{
    using T = SpecimenBagDef;
    return describe(
        "SpecimenBagDef", field("name", &T::name, "what errors and reports call its film"),
        field("arms", &T::arms, "m", positive(), "length of each arm that the mouth is fixed to"),
        field("depth", &T::depth, "m", positive(), "from its mouth to its bottom"),
        field("cells", &T::cells, "-", closed(3, 100), "of its mesh, along each arm"),
        field("film", &T::film, "what it is made of"),
        field("density", &T::density, "kg/m^3", positive(), "of the film"),
        field("rayleigh", &T::rayleigh, "damping of the film"),
        field("rimStiffness", &T::rimStiffness, "N/m", positiveOrInfinite(),
              "with which each node of the mouth is held by its arm"),
        field("groups", &T::groups, "collision groups of the film"),
        field("proximity", &T::proximity, "m", nonNegative(), "distance at which contacts are found"),
        field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction), "mu of Coulomb's law"),
        field("self", &T::self, "whether the film collides with itself"),
        field("material", &T::material, "what it looks like"));
}

/// Hangs a bag on an instrument, whose two jaws are the arms that spread its mouth (InstrumentKind::SpecimenBag). The
/// film hangs to the -X side of the pivot. Its mouth is a triangle: two sides are along the arms, and the third one,
/// the film's own edge, is between their tips. When the jaws close, the arms come together and the mouth is a slit.
/// What is in the bag is carried by contact alone, and its weight goes into the instrument. The film is the
/// simulation's: it stays in the scene if this object is destroyed.
///
/// Any thread may call.
class SpecimenBag {
public:
    /// Adds and shows the film. The instrument must be open at the start, and outlive the bag. Throws an Error if the
    /// Def is wrong. Construct it before a run.
    SpecimenBag(runtime::Simulation& simulation, ArticulatedInstrument& tool, const SpecimenBagDef& def = {});
    /// The same for a rigid body with two joints, which move its elements 1 and 2: arms along their -Z.
    SpecimenBag(runtime::Simulation& simulation, BodyId tool, const SpecimenBagDef& def = {});
    ~SpecimenBag();
    SpecimenBag(const SpecimenBag&) = delete;
    SpecimenBag& operator=(const SpecimenBag&) = delete;

    [[nodiscard]] BodyId body() const; ///< the film
    /// [-], in [0, 1], the share of a body's nodes, or of a rigid body's elements, that is in the bag now: between its
    /// film and its mouth. It looks at every node and every triangle.
    [[nodiscard]] double share(BodyId of) const;
    /// [N], on the arms now: at rest, the weight of the film and of what is in it. In motion their inertia is added,
    /// and what else touches the bag.
    [[nodiscard]] Vec3 load() const;
    [[nodiscard]] Vec3 mouth() const; ///< [m], the middle of the mouth, in the world

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::prefab

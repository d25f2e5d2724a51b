#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/physics/attachment_def.h"

#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Parts of a tetrahedral mesh, and tissue that differs there. Places are in the coordinates of the mesh, with the mesh
/// at rest; only the command SetTissue looks for them in the world.
namespace filasofia::physics {

/// The tetrahedra of a label of the mesh (geometry::TetMesh::labels).
struct Labelled {
    std::string name = {}; ///< the label's name in the mesh file; empty: the number counts
    int label = 0;         ///< [-] its number

    friend bool operator==(const Labelled&, const Labelled&) = default;
};
/// The tetrahedra whose centre is nearer to the surface of the mesh than this: a capsule.
struct NearSurface {
    double depth = 1e-3; ///< [m], > 0

    friend bool operator==(const NearSurface&, const NearSurface&) = default;
};
/// The tetrahedra of either label with a node in common with the other: a plane of dissection.
struct AtInterface {
    Labelled first = {};
    Labelled second = {};

    friend bool operator==(const AtInterface&, const AtInterface&) = default;
};
/// These tetrahedra of the mesh.
struct Listed {
    std::vector<int> tetrahedra = {}; ///< [-], each in [0, tetrahedra of the mesh)

    friend bool operator==(const Listed&, const Listed&) = default;
};

/// Which tetrahedra. A box or a ball has those whose centre lies in it.
using RegionShape = std::variant<Labelled, geometry::Box, Ball, NearSurface, AtInterface, Listed>;

/// Whether it is a place, where the tetrahedra are looked for when a command comes; otherwise they are always the same.
constexpr bool isPlace(const RegionShape& where)
{
    return std::holds_alternative<geometry::Box>(where) || std::holds_alternative<Ball>(where);
}

/// Tissue that differs in a part of the body. What is not given stays.
struct TissueRegion {
    RegionShape where = Listed{};                ///< must be given: an empty list has no tetrahedra
    std::optional<double> youngModulus = {};     ///< [Pa], > 0
    std::optional<double> poissonRatio = {};     ///< [-], in [0, 0.5)
    std::optional<double> tearingThreshold = {}; ///< [Pa], > 0 or infinite; needs dynamicTopology
    std::optional<double> density = {};          ///< [kg/m^3], >= kLeastDensity; needs a body whose mass is a Density
    /// [-], in [0.5, 2]: lengths at rest, relative to those of the mesh: less than 1 for tissue that heat has shrunk,
    /// more for tissue that is swollen. The mass stays.
    std::optional<double> restScale = {};
    std::optional<double> yieldStress = {}; ///< [Pa], > 0 or infinite: see FemMaterial

    friend bool operator==(const TissueRegion&, const TissueRegion&) = default;
};

/// Factors of what the body's material says of a tetrahedron, whatever that is: heat stiffens, weakens and shrinks.
struct TissueFactors {
    double youngModulus = 1.0;     ///< [-], in [0.001, 1000]
    double tearingThreshold = 1.0; ///< [-], in [0.001, 1000]; what cannot tear still cannot
    double restScale = 1.0;        ///< [-], in [0.5, 2]

    friend bool operator==(const TissueFactors&, const TissueFactors&) = default;
};

/// The tetrahedra of a region, ascending. Throws an Error that begins with `object` if there is none, or if the mesh
/// has no such label.
std::vector<int> tetrahedraOf(const RegionShape& where, const geometry::TetMesh& mesh, std::string_view object);

/// Replaces the names of labels by their numbers. Throws an Error that begins with `object` if the mesh has no such
/// label.
void resolveNames(const geometry::TetMesh& mesh, std::string_view object, RegionShape& where);

/// Fibres along one direction of the mesh.
struct Along {
    Vec3 direction = {0, 0, 1}; ///< any length > 1e-6

    friend bool operator==(const Along&, const Along&) = default;
};
/// Fibres that wind around an axis, as in the wall of a vessel or of the gut.
struct Around {
    Vec3 point = {};       ///< [m] of the axis
    Vec3 axis = {0, 0, 1}; ///< any length > 1e-6
    /// [rad], in [-pi/2, pi/2], from the circle around the axis towards the axis: 0 for rings, pi/2 for fibres along it
    double pitch = 0.0;

    friend bool operator==(const Around&, const Around&) = default;
};
/// Fibres with a direction per tetrahedron, for example from an image.
struct DirectionField {
    std::vector<Vec3> directions = {}; ///< one per tetrahedron of the mesh; zero: no fibre there

    friend bool operator==(const DirectionField&, const DirectionField&) = default;
};
/// Fibres along the gradient of the harmonic function that is 0 at the nodes of one region and 1 at those of another:
/// from the origin of a muscle to its insertion, from the inner to the outer wall.
struct HarmonicField {
    RegionShape from = Labelled{};
    RegionShape to = Labelled{};

    friend bool operator==(const HarmonicField&, const HarmonicField&) = default;
};
using FibreDirection = std::variant<Along, Around, DirectionField, HarmonicField>;

/// A family of fibres (Gasser, Ogden and Holzapfel 2006). With the structure tensor H = kappa 1 + (1 - 3 kappa) a (x) a
/// of the direction a, and E = H : C - 1, it adds the energy
///     W = k1 / (2 k2) (exp(k2 E^2) - 1) + T/2 E,   the first part only in tension, where E > 0
/// per volume at rest to that of the law. E is the square of the stretch along the fibres, less 1, if they are all
/// parallel. C is not split into shape and volume (Helfenstein et al. 2010).
struct FibreFamily {
    double stiffness = 10e3; ///< [Pa], >= 0: k1; four times it is added to Young's modulus along the fibres
    double exponent = 1.0;   ///< [-], in (0, 100]: k2
    double dispersion = 0.0; ///< [-], in [0, 1/3]: kappa; 0: all parallel, 1/3: in all directions alike
    /// [Pa], in [0, 1e9]: T, by which a muscle contracts, a second Piola-Kirchhoff stress along H
    double activeStress = 0.0;
    FibreDirection direction = Along{};
    std::optional<RegionShape> where = {}; ///< none: in the whole body

    friend bool operator==(const FibreFamily&, const FibreFamily&) = default;
};

/// A unit direction per tetrahedron of the mesh, zero where the family has no fibre. Throws an Error that begins with
/// `object`.
std::vector<Vec3> directionsOf(const FibreFamily& family, const geometry::TetMesh& mesh, std::string_view object);

constexpr auto fields(const Labelled*)
{
    return describe("Labelled", field("name", &Labelled::name, "name of the label in the mesh file"),
                    field("label", &Labelled::label, "-", finite(), "number of the label"));
}
constexpr auto fields(const NearSurface*)
{
    return describe("NearSurface", field("depth", &NearSurface::depth, "m", positive(), "depth below the surface"));
}
constexpr auto fields(const AtInterface*)
{
    return describe("AtInterface", field("first", &AtInterface::first, "label on one side"),
                    field("second", &AtInterface::second, "label on the other side"));
}
constexpr auto fields(const Listed*)
{
    return describe("Listed", field("tetrahedra", &Listed::tetrahedra, "-", nonNegative(), "tetrahedra of the mesh"));
}
constexpr auto fields(const TissueRegion*)
{
    using T = TissueRegion;
    return describe(
        "TissueRegion", field("where", &T::where, "which part of the body"),
        field("youngModulus", &T::youngModulus, "Pa", positive(), "Young's modulus there"),
        field("poissonRatio", &T::poissonRatio, "-", closedOpen(0, 0.5), "Poisson's ratio there"),
        field("tearingThreshold", &T::tearingThreshold, "Pa", positiveOrInfinite(),
              "largest principal stress beyond which it tears there"),
        field("density", &T::density, "kg/m^3", positive(), "mass per volume there"),
        field("restScale", &T::restScale, "-", closed(0.5, 2), "lengths at rest relative to those of the mesh"),
        field("yieldStress", &T::yieldStress, "Pa", positiveOrInfinite(),
              "von Mises stress beyond which it flows there"));
}
/// The last field is younger than the first recordings with regions.
constexpr std::size_t addedFields(const TissueRegion*) { return 1; }
constexpr auto fields(const TissueFactors*)
{
    using T = TissueFactors;
    return describe("TissueFactors",
                    field("youngModulus", &T::youngModulus, "-", closed(1e-3, 1e3), "of Young's modulus"),
                    field("tearingThreshold", &T::tearingThreshold, "-", closed(1e-3, 1e3), "of the stress that tears"),
                    field("restScale", &T::restScale, "-", closed(0.5, 2), "of the lengths at rest"));
}
constexpr auto fields(const Along*)
{
    return describe("Along", field("direction", &Along::direction, "-", finite(), "direction of the fibres"));
}
constexpr auto fields(const Around*)
{
    return describe("Around", field("point", &Around::point, "m", finite(), "a point of the axis"),
                    field("axis", &Around::axis, "-", finite(), "direction of the axis"),
                    field("pitch", &Around::pitch, "rad", closed(-0.5 * std::numbers::pi, 0.5 * std::numbers::pi),
                          "angle from the circle around the axis towards the axis"));
}
constexpr auto fields(const DirectionField*)
{
    return describe("DirectionField",
                    field("directions", &DirectionField::directions, "-", finite(), "one per tetrahedron"));
}
constexpr auto fields(const HarmonicField*)
{
    return describe("HarmonicField", field("from", &HarmonicField::from, "where the fibres begin"),
                    field("to", &HarmonicField::to, "where they end"));
}
constexpr auto fields(const FibreFamily*)
{
    using T = FibreFamily;
    return describe("FibreFamily",
                    field("stiffness", &T::stiffness, "Pa", nonNegative(), "stiffness of the fibres, k1"),
                    field("exponent", &T::exponent, "-", openClosed(0, 100), "how fast they stiffen, k2"),
                    field("dispersion", &T::dispersion, "-", closed(0, 1.0 / 3.0), "spread of their directions, kappa"),
                    field("activeStress", &T::activeStress, "Pa", closed(0, 1e9), "stress by which they contract"),
                    field("direction", &T::direction, "their direction"), field("where", &T::where, "where they are"));
}

} // namespace filasofia::physics

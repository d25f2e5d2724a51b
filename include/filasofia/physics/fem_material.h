#pragma once

#include "filasofia/physics/elastic_law.h"
#include "filasofia/physics/tissue_region.h"

#include <limits>

namespace filasofia::physics {

/// The largest numbers of families of fibres, and of terms that relax.
inline constexpr std::size_t kMostFamilies = 4, kMostPronyTerms = 4;

/// One term of a Prony series.
struct PronyTerm {
    double share = 0.5; ///< [-], in (0, 1), part of the stress that relaxes; those of all terms add up to less than 1
    double time = 1.0;  ///< [s], in [1e-4, 1e6], in which it falls to 1/e

    friend bool operator==(const PronyTerm&, const PronyTerm&) = default;
};

/// Elastic tissue: linear tetrahedra with an elastic law.
///
/// With `relaxation` it is quasi-linear viscoelastic (Fung 1993, chapter 7): the law gives the stress that a sudden
/// strain causes, and held still, it relaxes by G(t) = 1 - sum of share (1 - exp(-t / time)). In the frame that turns
/// with the element, T(t) = integral of G(t - s) dT_law(s), with Biot's stress T = R^T P. Fibres do not relax.
struct FemMaterial {
    double youngModulus = 10e3;    ///< [Pa], > 0, at small strain; of sudden strain if the tissue relaxes
    double poissonRatio = 0.45;    ///< [-], in [0, 0.5), at small strain
    ElasticLaw law = NeoHookean{}; ///< how it departs from Hooke's law at large strain
    /// [Pa], > 0 or infinite: elements separate if the largest principal Cauchy stress exceeds it. Needs
    /// dynamicTopology.
    double tearingThreshold = std::numeric_limits<double>::infinity();
    std::vector<TissueRegion> regions = {};  ///< parts that differ; where several overlap, the last one counts
    std::vector<FibreFamily> fibres = {};    ///< at most kMostFamilies
    std::vector<PronyTerm> relaxation = {};  ///< at most kMostPronyTerms; none: it does not relax
    std::vector<double> stiffnessField = {}; ///< [-], > 0, per tetrahedron of the mesh: factors of Young's modulus
    /// [-], > 0 or infinite: the strain up to which the constants were measured. If a principal stretch differs from 1
    /// by more, the step sets StepFlag::BeyondStrain.
    double validStrain = std::numeric_limits<double>::infinity();
    /// [Pa], > 0 or infinite: tissue that bears a larger von Mises stress flows, and keeps the new shape: crushed
    /// tissue, a clip that is closed. Ideal plasticity, without a change of volume. The directions of fibres do not
    /// flow.
    double yieldStress = std::numeric_limits<double>::infinity();
};

constexpr auto fields(const PronyTerm*)
{
    using T = PronyTerm;
    return describe("PronyTerm", field("share", &T::share, "-", open(0, 1), "part of the stress that relaxes"),
                    field("time", &T::time, "s", closed(1e-4, 1e6), "time in which it falls to 1/e"));
}
constexpr auto fields(const FemMaterial*)
{
    using T = FemMaterial;
    return describe(
        "FemMaterial", field("youngModulus", &T::youngModulus, "Pa", positive(), "Young's modulus of the tissue"),
        field("poissonRatio", &T::poissonRatio, "-", closedOpen(0, 0.5),
              "Poisson's ratio; 0.5 would be incompressible"),
        field("law", &T::law, "elastic law"),
        field("tearingThreshold", &T::tearingThreshold, "Pa", positiveOrInfinite(),
              "largest principal stress beyond which it tears"),
        field("regions", &T::regions, "parts of the body that differ"),
        field("fibres", &T::fibres, "families of fibres"),
        field("relaxation", &T::relaxation, "terms of a Prony series"),
        field("stiffnessField", &T::stiffnessField, "-", within(positive(), 1e9),
              "factors of Young's modulus, per tetrahedron"),
        field("validStrain", &T::validStrain, "-", positiveOrInfinite(),
              "strain up to which the constants were measured"),
        field("yieldStress", &T::yieldStress, "Pa", positiveOrInfinite(), "von Mises stress beyond which it flows"));
}
/// The last fields are younger than the first recordings.
constexpr std::size_t addedFields(const FemMaterial*) { return 6; }

/// Throws an Error that begins with `object` for what a range cannot express: the terms of a law, the sum of the Prony
/// series. Does not look into a mesh.
void check(const FemMaterial& material, const std::string& object);

/// Throws an Error that begins with `object` if the stiffness field does not have one entry per tetrahedron.
void checkStiffnessField(const FemMaterial& material, const geometry::TetMesh& mesh, const std::string& object);

/// Throws an Error that begins with `object` if the stiffness field, a region or a direction of fibres does not fit the
/// mesh.
void check(const FemMaterial& material, const geometry::TetMesh& mesh, const std::string& object);

/// Replaces the names of labels in regions and fibres by their numbers; errors as those of the function for a region.
void resolveNames(const geometry::TetMesh& mesh, const std::string& object, FemMaterial& material);

} // namespace filasofia::physics

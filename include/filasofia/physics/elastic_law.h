#pragma once

#include "filasofia/core/fields.h"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Elastic laws of tissue. All are isotropic, and all are Hooke's law at small strain: the material's Young's modulus E
/// and Poisson's ratio nu belong to that limit, whatever the law, and a law's own fields say how it departs from it.
///
/// F is the deformation gradient, s1, s2, s3 its singular values (the principal stretches), J = det F,
/// C = F^T F, I1 = tr C, I2 = (I1^2 - tr C^2) / 2. The shear modulus is mu = E / (2 (1 + nu)), Lame's second constant
/// lambda = E nu / ((1 + nu)(1 - 2 nu)), the bulk modulus K = lambda + 2/3 mu. An energy W is per volume at rest.
///
/// The laws that split the energy into a part of shape and K/2 (J - 1)^2 measure shape by the stretches at constant
/// volume, t = J^(-1/3) s, and their invariants i1 = J^(-2/3) I1 and i2 = J^(-4/3) I2. For an element squeezed below a
/// fifth of its volume, or inside out, J is replaced in these powers by a smooth function that stays positive
/// (engine/elastic/laws), so that every law has finite forces in every state.
namespace filasofia::physics {

/// The laws' own namespace, so that filasofia.h can take them all.
inline namespace elastic_laws {

/// W = mu/2 (I1 - 3) - mu ln J + lambda/2 (J - 1)^2 (Bonet and Wood 2008, section 6.4.3, with another term of lambda).
/// Stable in every deformation, also flat and inside out: the usual choice. Below J = 0.2 the logarithm goes on as its
/// parabola. Below I1 = 1, where tissue is crushed in all directions, I1 is replaced by (1 + I1^2) / 2, so that a point
/// is no minimum. Tissue of any Poisson's ratio presses back ever more, down to 15 % of its height.
struct NeoHookean {
    friend bool operator==(const NeoHookean&, const NeoHookean&) = default;
};

/// W = mu |F - R|^2 + lambda/2 (s1 + s2 + s3 - 3)^2 with the rotation R nearest to F (Mueller and Gross 2004): Hooke's
/// law under large rotation. Wrong beyond a strain of a tenth or two: an element that is squeezed flat resists little
/// and may stay inside out, and one that is pulled loses its volume.
struct Corotational {
    friend bool operator==(const Corotational&, const Corotational&) = default;
};

/// W = mu tr E^2 + lambda/2 (tr E)^2 with E = (C - 1)/2: what many engines compute. Stiffens in tension; in compression
/// it softens, and pushes back less and less below 58 % of its length.
struct StVenantKirchhoff {
    friend bool operator==(const StVenantKirchhoff&, const StVenantKirchhoff&) = default;
};

/// W = mu/2 ((1 - share) (i1 - 3) + share (i2 - 3)) + K/2 (J - 1)^2. With the constants of the literature,
/// mu = 2 (c10 + c01) and share = c01 / (c10 + c01).
struct MooneyRivlin {
    double share = 0.2; ///< [-], in [0, 1], part of i2 in the shear modulus

    friend bool operator==(const MooneyRivlin&, const MooneyRivlin&) = default;
};

/// One term of Ogden's law.
struct OgdenTerm {
    double exponent = 2.0; ///< [-] alpha, in [-60, 60], not 0
    double share = 1.0;    ///< [-], in (0, 1], part of the shear modulus; those of all terms add up to 1

    friend bool operator==(const OgdenTerm&, const OgdenTerm&) = default;
};
/// W = sum of 2 mu share / alpha^2 (t1^alpha + t2^alpha + t3^alpha - 3) over the terms, + K/2 (J - 1)^2 (Ogden 1972, in
/// the form of Abaqus and CalculiX, whose mu_i is mu share).
struct Ogden {
    std::vector<OgdenTerm> terms = {{}}; ///< 1 to 4

    friend bool operator==(const Ogden&, const Ogden&) = default;
};

/// W = mu ((exp(c (i1 - 3)) - 1) / c - (i2 - 3) / 2) + K/2 (J - 1)^2 (Veronda and Westmann 1970: skin). With the
/// constants of the literature, mu = c1 c2 and c = c2.
struct VerondaWestmann {
    double exponent = 1.0; ///< [-] c, in [0.2, 100]

    friend bool operator==(const VerondaWestmann&, const VerondaWestmann&) = default;
};

/// W = mu/2 (exp(b (i1 - 3)) - 1) / b + K/2 (J - 1)^2: Fung's exponential law, isotropic (Demiray 1972).
struct Fung {
    double exponent = 1.0; ///< [-] b, in (0, 100]

    friend bool operator==(const Fung&, const Fung&) = default;
};

/// W = -mu/2 Jm ln(1 - (i1 - 3) / Jm) + K/2 (J - 1)^2 (Gent 1996): chains, or fibres of collagen, become taut. Beyond
/// 98 % of the limit the logarithm goes on as a parabola, so that tissue which is crushed or torn has a finite stress,
/// and steps tell (StepFlag::BeyondStrain).
struct Gent {
    double limit = 2.0; ///< [-] Jm, in [0.1, 1000], which i1 - 3 does not reach

    friend bool operator==(const Gent&, const Gent&) = default;
};

} // namespace elastic_laws

using ElasticLaw =
    std::variant<NeoHookean, Corotational, StVenantKirchhoff, MooneyRivlin, Ogden, VerondaWestmann, Fung, Gent>;

/// [-] The part of Gent's limit up to which the law is that of its formula.
inline constexpr double kGentRange = 0.98;

constexpr auto fields(const NeoHookean*) { return describe("NeoHookean"); }
constexpr auto fields(const Corotational*) { return describe("Corotational"); }
constexpr auto fields(const StVenantKirchhoff*) { return describe("StVenantKirchhoff"); }
constexpr auto fields(const MooneyRivlin*)
{
    return describe("MooneyRivlin", field("share", &MooneyRivlin::share, "-", closed(0, 1),
                                          "part of the second invariant in the shear modulus"));
}
constexpr auto fields(const OgdenTerm*)
{
    return describe("OgdenTerm", field("exponent", &OgdenTerm::exponent, "-", closed(-60, 60), "exponent, not 0"),
                    field("share", &OgdenTerm::share, "-", openClosed(0, 1), "part of the shear modulus"));
}
constexpr auto fields(const Ogden*)
{
    return describe("Ogden", field("terms", &Ogden::terms, "its 1 to 4 terms; their shares add up to 1"));
}
constexpr auto fields(const VerondaWestmann*)
{
    return describe("VerondaWestmann",
                    field("exponent", &VerondaWestmann::exponent, "-", openClosed(0, 100), "how fast it stiffens"));
}
constexpr auto fields(const Fung*)
{
    return describe("Fung", field("exponent", &Fung::exponent, "-", openClosed(0, 100), "how fast it stiffens"));
}
constexpr auto fields(const Gent*)
{
    return describe("Gent", field("limit", &Gent::limit, "-", closed(0.1, 1000), "Jm, which i1 - 3 does not reach"));
}

/// Every law with its defaults, in the order of the variant.
const std::vector<ElasticLaw>& elasticLaws();

/// [-] The i1 - 3 up to which a law holds, infinite if it has no such limit. Tissue beyond it is told:
/// StepFlag::BeyondStrain.
double rangeOf(const ElasticLaw& law);

/// The name of a law in files, errors and tables: that of its type.
std::string_view nameOf(const ElasticLaw& law);

/// Throws an Error that begins with `object` for what a range cannot express: the terms of Ogden's law.
void check(const ElasticLaw& law, const std::string& object);

} // namespace filasofia::physics

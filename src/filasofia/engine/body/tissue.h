#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/elastic/fibre.h"
#include "filasofia/engine/elastic/law.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/physics/commands.h"

/// What the elements of a FEM body are made of: the response of law, fibres and relaxation together, in double, and the
/// changes of tissue that commands make.
namespace filasofia::engine {

/// The relaxation within a step of `dt` [s] of a body whose terms are up to date, as they are after assembly.
RelaxationStep relaxationWithin(const SoftModel& model, double dt);

/// The same for the assembly of a step, which also updates the terms: those of the last step are up to date then.
RelaxationStep nextRelaxation(const SoftModel& model, double dt, SoftState& state);

/// First Piola-Kirchhoff stress of an element [Pa], `at` the end of a step whose start the state is.
Mat3 tissueStress(const SoftModel& model, const SoftState& state, const RelaxationStep& relaxation, std::size_t element,
                  const Deformation& at);
/// The same at the start of a step, for its right-hand side. Updates the relaxation of the element.
Mat3 startStress(const SoftModel& model, const RelaxationStep& relaxation, std::size_t element, const Deformation& at,
                 SoftState& state);

/// Cauchy stress of an element [Pa] with this deformation gradient at the end of a step, whose state it is.
Mat3 endStress(const SoftModel& model, const SoftState& state, std::size_t element, const Mat3& f);

/// The derivative of the stress within a step as its matrix uses it.
struct TissueTangent {
    double share = 1.0; ///< [-] weight of the law's tangent relative to that of the fibres
    ElementTangent law;
    std::array<FibreTangent, physics::kMostFamilies> fibres{};
    std::size_t families = 0;
};
/// The tangent that Rayleigh damping uses: without the geometric stiffness, and as if nothing relaxed.
TissueTangent dampingTangent(const SoftModel& model, std::size_t element, const Deformation& at);
/// The tangent that the matrix uses, to be multiplied by `weights.stiffness`.
TissueTangent stepTangent(const SoftModel& model, std::size_t element, const Deformation& at,
                          const ImplicitWeights& weights);
Mat3 stiffnessBlock(const TissueTangent& tangent, Vec3 gi, Vec3 gj);
Corners stiffnessTimes(const TissueTangent& tangent, const FemElement& element, const Corners& x);

/// An element's part of the step's matrix at rest, between nodes with shape gradients gi and gj, per volume.
Mat3 blockAtRest(const SoftModel& model, std::size_t element, const ImplicitWeights& weights, Vec3 gi, Vec3 gj);

/// Carries out a command in a body's present state. Returns the elements of its region, ascending.
std::vector<int> changeTissue(const physics::SetTissue& set, const SoftState& state, SoftModel& model);

} // namespace filasofia::engine

#include "filasofia/engine/body/tissue.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/body/tissue_map.h"
#include "filasofia/engine/elastic/element_blocks.h"
#include "filasofia/math/polar.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

Mat3 fibreStresses(const SoftModel& model, std::size_t element, const Mat3& f)
{
    Mat3 sum;
    for (std::size_t k = 0; k < model.fibres.size(); ++k)
        sum += fibreStress(model.material.fibres[k], model.fibres[k][element], f);
    return sum;
}

/// Stress of law and fibres. If the tissue relaxes, `relax` takes and returns the law's part as Biot's stress relative
/// to mu.
template <class Relax> Mat3 stressOf(const SoftModel& model, const RelaxationStep& relaxation, std::size_t element,
                                     const Deformation& at, const Relax& relax)
{
    const Lame material = lameOf(model.elements[element]);
    Mat3 stress = stressAt(model.material.law, material, at);
    if (relaxation.terms > 0)
        stress = material.mu * (at.rotation * relax(1.0 / material.mu * transposeTimes(at.rotation, stress)));
    return model.fibres.empty() ? stress : stress + fibreStresses(model, element, at.f);
}

/// The elements of a region, ascending: by their present place for boxes and balls, otherwise by the tetrahedra of the
/// Def's mesh from which they come.
std::vector<int> elementsIn(const physics::RegionShape& where, const SoftState& state, const SoftModel& model)
{
    const bool moves = physics::isPlace(where);
    std::vector<int> tetrahedra;
    if (!moves) tetrahedra = physics::tetrahedraOf(where, *model.mesh, "soft body '" + model.name + "': region");
    const auto isIn = [&](const FemElement& element) {
        if (!moves) return std::ranges::binary_search(tetrahedra, element.tetrahedron);
        const Corners x = cornersOf(element.nodes, state.x);
        const Vec3 centre = 0.25 * (x[0] + x[1] + x[2] + x[3]);
        const auto* box = std::get_if<geometry::Box>(&where);
        if (box) return geometry::squaredDistance(*box, centre) == 0.0;
        const auto& ball = std::get<physics::Ball>(where);
        return distance(centre, ball.centre) <= ball.radius;
    };
    std::vector<int> out;
    for (std::size_t e = 0; e < model.elements.size(); ++e)
        if (isIn(model.elements[e])) out.push_back(static_cast<int>(e));
    return out;
}

} // namespace

RelaxationStep relaxationWithin(const SoftModel& model, double dt)
{
    const bool implicit = std::holds_alternative<physics::ImplicitEuler>(model.integrator);
    return relaxationStep(model.material.relaxation, 0.0, implicit ? dt : 0.0);
}

RelaxationStep nextRelaxation(const SoftModel& model, double dt, SoftState& state)
{
    RelaxationStep step = relaxationWithin(model, dt);
    step.past = pronyFactors(model.material.relaxation, std::exchange(state.unrelaxed, 0.0));
    return step;
}

Mat3 tissueStress(const SoftModel& model, const SoftState& state, const RelaxationStep& relaxation, std::size_t element,
                  const Deformation& at)
{
    return stressOf(model, relaxation, element, at, [&](const Mat3& t) {
        return relaxedStress(relaxation, t, element % kBlock, state.relaxation[element / kBlock]);
    });
}

Mat3 startStress(const SoftModel& model, const RelaxationStep& relaxation, std::size_t element, const Deformation& at,
                 SoftState& state)
{
    return stressOf(model, relaxation, element, at, [&](const Mat3& t) {
        return updateRelaxation(relaxation, t, element % kBlock, state.relaxation[element / kBlock]);
    });
}

Mat3 endStress(const SoftModel& model, const SoftState& state, std::size_t element, const Mat3& f)
{
    const Mat3 rotation = toMat3(polarRotation(f, rotationOf(state.rotations, element)));
    const RelaxationStep relaxation = relaxationWithin(model, state.unrelaxed);
    return cauchyStress(tissueStress(model, state, relaxation, element, {f, rotation}), f);
}

TissueTangent dampingTangent(const SoftModel& model, std::size_t element, const Deformation& at)
{
    return stepTangent(model, element, at, {.stiffness = 1.0, .law = 1.0});
}

TissueTangent stepTangent(const SoftModel& model, std::size_t element, const Deformation& at,
                          const ImplicitWeights& weights)
{
    const Lame material = lameOf(model.elements[element]);
    TissueTangent tangent{.share = weights.law / weights.stiffness,
                          .law = tangentAt(model.material.law, material, at, weights.lawTurning),
                          .families = model.fibres.size()};
    for (std::size_t k = 0; k < tangent.families; ++k)
        tangent.fibres[k] = fibreTangent(model.material.fibres[k], model.fibres[k][element], at.f, weights.turning);
    return tangent;
}

Mat3 stiffnessBlock(const TissueTangent& tangent, Vec3 gi, Vec3 gj)
{
    Mat3 sum = tangent.share * stiffnessBlock(tangent.law, gi, gj);
    for (std::size_t k = 0; k < tangent.families; ++k) sum += stiffnessBlock(tangent.fibres[k], gi, gj);
    return sum;
}

Corners stiffnessTimes(const TissueTangent& tangent, const FemElement& element, const Corners& x)
{
    const Mat3 df = gradient(element, x);
    Mat3 sum = tangent.share * stressChange(tangent.law, df);
    for (std::size_t k = 0; k < tangent.families; ++k) sum += stressChange(tangent.fibres[k], df);
    return internalForces(element, sum);
}

Mat3 blockAtRest(const SoftModel& model, std::size_t element, const ImplicitWeights& weights, Vec3 gi, Vec3 gj)
{
    Mat3 sum = weights.law * hookeBlock(lameOf(model.elements[element]), gi, gj);
    for (std::size_t k = 0; k < model.fibres.size(); ++k) {
        const physics::FibreFamily& family = model.material.fibres[k];
        const Vec3 direction = model.fibres[k][element];
        sum += weights.stiffness *
               stiffnessBlock(fibreTangent(family, direction, Mat3::identity(), weights.turning), gi, gj);
    }
    return sum;
}

std::vector<int> changeTissue(const physics::SetTissue& set, const SoftState& state, SoftModel& model)
{
    const std::vector<int> elements = elementsIn(set.region.where, state, model);
    for (int e : elements) {
        FemElement& element = model.elements[static_cast<std::size_t>(e)];
        if (set.factors) apply(*set.factors, model.tissue->of[static_cast<std::size_t>(element.tetrahedron)], element);
        apply(set.region, element);
        element.restScale =
            std::clamp(element.restScale, 0.5, 2.0); // a region's times a factor may be beyond its range
        model.tearingThreshold = std::min(model.tearingThreshold, element.tearingThreshold);
        model.yieldStress = std::min(model.yieldStress, element.yieldStress);
        shapeElement(model.rest, element);
    }
    model.patched = model.patched || !elements.empty();
    model.nodalVolumes = hasNodalVolumes(model.elements);
    return elements;
}

} // namespace filasofia::engine

#pragma once

#include "filasofia/math/mat3.h"
#include "filasofia/sofa/sofa_vec.h"

#include <sofa/core/behavior/Mass.h>

#include <vector>

namespace filasofia::sofaengine {

/// The masses of rigid elements, whose inertia turns with them. SOFA's own keeps it along the axes of the world.
///
/// A step turns an element with the velocity that its angular momentum has at the middle of the step, as the native
/// engine does (Krysl 2005): J w = L with the inertia J there. SOFA solves J (w - w') = dt torque; what the momentum at
/// the start, J' w', lacks is a torque, (J' - J) w' / dt.
class ElementMass final : public ::sofa::core::behavior::Mass<RigidTypes> {
public:
    SOFA_CLASS(ElementMass, SOFA_TEMPLATE(::sofa::core::behavior::Mass, RigidTypes));

    double mass = 0.0; ///< [kg] an element's
    Mat3 inertia = {}; ///< [kg m^2] about its centre, in its axes

    /// At the start of a step of dt [s].
    void begin(double dt);
    /// At its end: what the elements turned with becomes what they turn with now.
    void finish();
    /// [kg m^2] in the world, at the middle of the step.
    [[nodiscard]] const Mat3& inertiaOf(std::size_t element) const { return middle_[element]; }

    [[nodiscard]] bool isDiagonal() const override { return false; }
    void addMDx(const ::sofa::core::MechanicalParams* params, DataVecDeriv& f, const DataVecDeriv& dx,
                SReal factor) override;
    void accFromF(const ::sofa::core::MechanicalParams* params, DataVecDeriv& a, const DataVecDeriv& f) override;
    void addForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    using Mass::accFromF;
    using Mass::addForce;
    using Mass::addMDx;

private:
    std::vector<Mat3> middle_;
    std::vector<Vec3> moments_; ///< [N m] in this step
};

} // namespace filasofia::sofaengine

#pragma once

#include "filasofia/sofa/sofa_vec.h"

#include "filasofia/engine/articulation/link_motion.h"
#include "filasofia/physics/defs.h"
#include "filasofia/physics/haptic_target.h"

#include <sofa/core/behavior/ForceField.h>

#include <optional>
#include <vector>

namespace filasofia::sofaengine {

/// The wrenches and hands that commands put on the elements of a dynamic body, and the opposite of gravity if it has
/// none.
class RigidLoads final : public ::sofa::core::behavior::ForceField<RigidTypes> {
public:
    SOFA_CLASS(RigidLoads, SOFA_TEMPLATE(::sofa::core::behavior::ForceField, RigidTypes));

    /// A hand on an element, as the next solve sees it: where its force or torque would exceed the limit, spring and
    /// damper are both weaker, as in the native engine.
    struct Hand {
        MotionState target = {}; ///< the hand's, at the element's centre of mass
        VirtualCoupling coupling = {};
        double linear = 1.0;  ///< [-] factor of the force
        double angular = 1.0; ///< [-] factor of the torque
    };
    std::vector<engine::Wrench> wrenches = {};   ///< one per element
    std::vector<std::optional<Hand>> hands = {}; ///< one per element
    double weightless = 0.0;                     ///< [kg] per element, if gravity does not act on the body; else 0

    /// Limits the forces of all hands at the start of a step of dt [s].
    void limitHands(double dt);
    /// What a hand adds in the equation of a step of dt [s].
    struct HandInertia {
        double mass = 0.0;    ///< [kg]
        double inertia = 0.0; ///< [kg m^2] about every axis
    };
    [[nodiscard]] HandInertia handInertia(std::size_t element, double dt) const;

    void addForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& df, const DataVecDeriv& dx) override;
    void buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* /*matrix*/) override {} // no solver assembles
    void buildDampingMatrix(::sofa::core::behavior::DampingMatrix* /*matrix*/) override {}
    SReal getPotentialEnergy(const ::sofa::core::MechanicalParams* /*params*/, const DataVecCoord& /*x*/) const override
    {
        return 0.0; // nobody asks
    }
    using ForceField::addDForce;
    using ForceField::addForce;
    using ForceField::getPotentialEnergy;
};

} // namespace filasofia::sofaengine

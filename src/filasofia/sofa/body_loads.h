#pragma once

#include "filasofia/sofa/sofa_vec.h"
#include "filasofia/sofa/soft_plan.h"

#include <sofa/core/behavior/ForceField.h>

namespace filasofia::sofaengine {

/// What a Def and commands put on the nodes of a soft body: forces, pressure, springs to places in space, and the
/// opposite of gravity for a body that has none. SOFA's own components for these read their data once.
class BodyLoads final : public ::sofa::core::behavior::ForceField<Vec3Types> {
public:
    SOFA_CLASS(BodyLoads, SOFA_TEMPLATE(::sofa::core::behavior::ForceField, Vec3Types));

    /// A spring from a node to a place.
    struct Spring {
        std::size_t node = 0;
        ::sofa::type::Vec3 place = {}; ///< [m]
        double stiffness = 0.0;        ///< [N/m]
    };
    std::vector<physics::NodalForce> forces = {};
    std::vector<Spring> springs = {};
    std::vector<std::array<int, 3>> surface = {};
    double pressure = 0.0; ///< [Pa]
    /// [kg] per node of a body without gravity; empty if it has it
    std::vector<double> weightless = {};

    void addForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& df, const DataVecDeriv& dx) override;
    void buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* matrix) override;
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

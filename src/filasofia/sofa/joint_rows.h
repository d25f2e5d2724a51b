#pragma once

#include "filasofia/sofa/articulation.h"

#include <sofa/core/behavior/PairInteractionConstraint.h>

namespace filasofia::sofaengine {

/// The limits and the friction of the free joints of a body, as constraints of SOFA on its links.
class JointRows final : public ::sofa::core::behavior::PairInteractionConstraint<RigidTypes> {
public:
    SOFA_CLASS(JointRows, SOFA_TEMPLATE(::sofa::core::behavior::PairInteractionConstraint, RigidTypes));
    using States = ::sofa::core::behavior::MechanicalState<RigidTypes>;
    JointRows(States* links, const Articulation& joints) : PairInteractionConstraint(links, links), joints_(joints) {}

    /// After a step: the impulses of its rows, of those by all constraints [N s].
    [[nodiscard]] std::span<const double> impulsesOf(std::span<const double> all) const;

    void buildConstraintMatrix(const ::sofa::core::ConstraintParams* params, DataMatrixDeriv& first,
                               DataMatrixDeriv& second, unsigned int& row, const DataVecCoord& x1,
                               const DataVecCoord& x2) override;
    void getConstraintViolation(const ::sofa::core::ConstraintParams* params, ::sofa::linearalgebra::BaseVector* out,
                                const DataVecCoord& x1, const DataVecCoord& x2, const DataVecDeriv& v1,
                                const DataVecDeriv& v2) override;
    void getConstraintResolution(const ::sofa::core::ConstraintParams* params,
                                 std::vector<::sofa::core::behavior::ConstraintResolution*>& all,
                                 unsigned int& offset) override;
    ::sofa::type::vector<std::string> getPairInteractionIdentifiers() override { return {"Joints"}; }
    using PairInteractionConstraint::buildConstraintMatrix;
    using PairInteractionConstraint::getConstraintViolation;

private:
    const Articulation& joints_;
    unsigned first_ = 0; ///< its first row
};

} // namespace filasofia::sofaengine

#pragma once

#include "filasofia/sofa/sofa_vec.h"

#include <sofa/component/solidmechanics/fem/elastic/FastTetrahedralCorotationalForceField.h>

namespace filasofia::sofaengine {

/// SOFA's component with the matrix that its products have. In SOFA 25.12 the matrix for direct solvers has the same
/// block above and below the diagonal of a pair of nodes, where one must be the transpose of the other
/// (FastTetrahedralCorotationalForceField.inl, buildStiffnessMatrix).
class CorotationalForces final
    : public ::sofa::component::solidmechanics::fem::elastic::FastTetrahedralCorotationalForceField<Vec3Types> {
public:
    using Parent = ::sofa::component::solidmechanics::fem::elastic::FastTetrahedralCorotationalForceField<Vec3Types>;
    SOFA_CLASS(CorotationalForces, Parent);

    void buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* matrix) override;
};

} // namespace filasofia::sofaengine

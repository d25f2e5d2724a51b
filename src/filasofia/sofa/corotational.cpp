#include "filasofia/sofa/corotational.h"

#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>

namespace filasofia::sofaengine {

void CorotationalForces::buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* matrix)
{
    Parent::buildStiffnessMatrix(matrix);
    auto dfdx = matrix->getForceDerivativeIn(this->mstate).withRespectToPositionsIn(this->mstate);
    const auto& blocks = this->d_edgeInfo.getValue();
    const auto& edges = this->l_topology->getEdges();
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const Mat3x3 wrong = blocks[i] - blocks[i].transposed(); // the product has the transpose in this place
        dfdx(3 * edges[i][0], 3 * edges[i][1]) += wrong;
    }
}

} // namespace filasofia::sofaengine

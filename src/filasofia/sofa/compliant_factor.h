#pragma once

#include <sofa/component/linearsolver/direct/SparseLDLSolver.h>

namespace filasofia::sofaengine {

using Blocks = ::sofa::linearalgebra::CompressedRowSparseMatrix<::sofa::type::Mat<3, 3, SReal>>;
using Assembled = ::sofa::linearalgebra::FullVector<SReal>;

/// SOFA's factorisation with another way to J A^-1 J^T, how far the forces of constraints move each other's points.
/// SOFA solves for each row of J by itself, through all of the factor. Here numbers that rows share are solved for
/// once, eight at a time, and only where they reach. The result differs by rounding.
class CompliantFactor final : public ::sofa::component::linearsolver::direct::SparseLDLSolver<Blocks, Assembled> {
public:
    using Factor = ::sofa::component::linearsolver::direct::SparseLDLSolver<Blocks, Assembled>;
    SOFA_CLASS(CompliantFactor, Factor);

    bool addJMInvJtLocal(Blocks* matrix, ResMatrixType* result, const JMatrixType* jacobian, SReal factor) override;
};

} // namespace filasofia::sofaengine

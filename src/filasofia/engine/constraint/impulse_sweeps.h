#pragma once

#include "filasofia/engine/constraint/constraint_columns.h"

#include <array>
#include <span>
#include <vector>

namespace filasofia::engine {

/// Gauss-Seidel over constraints whose bodies have a D that is A: constraint after constraint gets the impulse that its
/// law has while all others keep theirs (Jourdan, Alart and Jean 1998).
class ImpulseSweeps {
public:
    /// Nothing has changed yet. The columns must outlive the sweeps. Returns false if D is not positive definite to
    /// rounding; nothing else must be called then.
    [[nodiscard]] bool begin(const ConstraintColumns& columns);
    /// [m/s] the change of a row's velocity by all impulses added so far, in its frame
    [[nodiscard]] Vec3 velocityOf(std::size_t row) const;
    /// [N s] The row's impulse by its law. `u` [m/s] is the row's velocity with the impulse that it has now;
    /// `stiffness` [kg] is Sigma, without zeros.
    [[nodiscard]] Vec3 relax(std::size_t row, const ConstraintLaw& law, Vec3 stiffness, Vec3 u, Vec3 impulse);
    void add(std::size_t row, Vec3 impulse); ///< [N s] in its frame; only after relax() of this row

private:
    /// What A^-1 makes of a row's impulses at one block of unknowns: a column of A^-1 (F J)^T.
    struct Response {
        int unknown = 0;
        Mat3 change;
    };
    struct Row {
        std::size_t first = 0, count = 0; ///< among responses_
        Mat3 compliance;                  ///< [1/kg] F J A^-1 J^T F^T; zero if it is not known yet
    };
    const Mat3& complianceOf(std::size_t row);
    void respondCoupled(std::span<const ConstraintColumns::Column> columns);

    const ConstraintColumns* columns_ = nullptr;
    std::vector<bool> coupled_; ///< per unknown: D couples it with others
    std::vector<Mat3> inverse_; ///< per unknown, unless it is coupled
    linalg::BlockCholesky factor_;
    std::vector<Vec3> changes_; ///< [m/s] per unknown
    std::vector<Row> rows_;
    std::vector<Response> responses_;
    std::array<std::vector<Vec3>, 3> solved_; ///< scratch: per axis of a row, per unknown
};

} // namespace filasofia::engine

#pragma once

#include "filasofia/engine/constraint/dense_operator.h"
#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <vector>

namespace filasofia::engine {

/// What a body brings into a coupled solve that computes in double. All of it outlives the solve.
struct PlainShareInput {
    std::span<const Mat3> diagonal = {};               ///< [kg] D, a block per unknown vector
    const linalg::BlockSparseMatrix* matrix = nullptr; ///< A; nothing: D is all there is
    linalg::LinearSolver* solver = nullptr;            ///< B = A^-1 by it; nothing: no B
    std::span<const Vec3> rightHandSide = {};          ///< [N s]
    std::span<const Vec3> guess = {};                  ///< [m/s] empty: none
    double mass = 0.0;                                 ///< [kg] of what moves
    bool turning = false; ///< unknowns are pairs: an element's velocity and angular velocity
};

/// The share of a body whose matrix is written out, or is just its masses: explicit bodies, rigid ones, and those
/// with a solver of their own choice.
class PlainShare final : public DenseShare<Vec3> {
public:
    explicit PlainShare(const PlainShareInput& in);

    void begin(std::span<const Grip> grips) override;
    [[nodiscard]] Mat3 compliance(int grip) const override;
    [[nodiscard]] double mass() const override { return in_.mass; }
    double multiply() override;
    void smooth() override;
    double spread(std::span<const double> shares) override;
    void readDirection(std::span<Vec3> p) const override { read(p_, p); }
    void readSmoothed(std::span<Vec3> w) const override { read(w_, w); }
    void readSpread(std::span<Vec3> z) const override { read(z_, z); }
    void addToResidual(std::span<const Vec3> impulses) override { add(impulses, r_); }
    void addToSpread(std::span<const Vec3> impulses) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    void read(const Vector& from, std::span<Vec3> out) const;
    void add(std::span<const Vec3> impulses, Vector& to) const;
    [[nodiscard]] std::size_t unknownOf(const Grip& grip) const
    {
        return static_cast<std::size_t>(in_.turning ? 2 * grip.node : grip.node);
    }

    PlainShareInput in_;
    std::vector<Mat3> inverse_; ///< D^-1
    std::vector<Grip> grips_;
    Vector s_;
};

} // namespace filasofia::engine

#pragma once

#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/constraint/dense_operator.h"

namespace filasofia::engine {

/// What an articulated body brings into a coupled solve: the velocities of its free joints, with A^-1 known, so that
/// it gives way at its grips by J A^-1 J^T.
class ArticulatedShare final : public DenseShare<double> {
public:
    /// Tree and plan outlive the solve. `origins` [m]: of the links.
    ArticulatedShare(const LinkTree& tree, const ArticulationPlan& plan, std::vector<Vec3> origins);

    void begin(std::span<const Grip> grips) override;
    [[nodiscard]] Mat3 compliance(int grip) const override;
    [[nodiscard]] double mass() const override;
    double multiply() override;
    void smooth() override;
    double spread(std::span<const double> shares) override;
    void readDirection(std::span<Vec3> p) const override { read(p_, p); }
    void readSmoothed(std::span<Vec3> w) const override { read(w_, w); }
    void readSpread(std::span<Vec3> z) const override { read(z_, z); }
    void addToResidual(std::span<const Vec3> impulses) override { add(impulses, r_); }
    void addToSpread(std::span<const Vec3>) override {} // A^-1 is D^-1 here: nothing is left for B
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    [[nodiscard]] std::span<const Vec3> columnsOf(std::size_t grip) const
    {
        return std::span(columns_).subspan(grip * x_.size(), x_.size());
    }
    void read(const Vector& from, std::span<Vec3> out) const;
    void add(std::span<const Vec3> impulses, Vector& to) const;

    const LinkTree& tree_;
    const ArticulationPlan& plan_;
    std::vector<Vec3> origins_; ///< [m] per link
    std::size_t grips_ = 0;
    std::vector<Vec3> columns_; ///< J: per grip, per free joint
    Vector rightHandSide_;
};

} // namespace filasofia::engine

#pragma once

#include "filasofia/engine/articulation_step.h"
#include "filasofia/engine/contact/coupled_body.h"

namespace filasofia::engine {

/// What an articulated body brings into a coupled solve: the velocities of its free joints, with A^-1 known, so that
/// it gives way at its grips by J A^-1 J^T.
class ArticulatedShare final : public CoupledBody {
public:
    /// Tree and plan outlive the solve. `origins` [m]: of the links.
    ArticulatedShare(const LinkTree& tree, const ArticulationPlan& plan, std::vector<Vec3> origins);

    [[nodiscard]] std::span<const double> answer() const { return x_; }

    void begin(std::span<const Grip> grips) override;
    [[nodiscard]] Mat3 compliance(int grip) const override;
    [[nodiscard]] double mass() const override;
    double multiply() override;
    double slope() override;
    void descend(double alpha) override;
    void turn(double beta) override;
    void smooth() override;
    double spread() override;
    void save() override;
    std::array<double, 2> rise() override;
    void goBack(double t) override;
    void readDirection(std::span<Vec3> p) const override { read(p_, p); }
    void readSmoothed(std::span<Vec3> w) const override { read(w_, w); }
    void readSpread(std::span<Vec3> z) const override { read(z_, z); }
    void addToProduct(std::span<const Vec3> impulses) override { add(impulses, q_); }
    void addToResidual(std::span<const Vec3> impulses) override { add(impulses, r_); }
    void addToSpread(std::span<const Vec3>) override {} // A^-1 is D^-1 here: nothing is left for B
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    using Vector = std::vector<double>;
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
    Vector rightHandSide_, x_, r_, p_, q_, w_, z_, xSaved_, rSaved_;
};

} // namespace filasofia::engine

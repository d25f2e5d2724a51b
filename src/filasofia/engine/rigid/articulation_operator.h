#pragma once

#include "filasofia/engine/constraint/dense_operator.h"
#include "filasofia/engine/rigid/articulation_step.h"

namespace filasofia::engine {

/// The body operator of an articulated body, for coupled solves. Its unknowns are the velocities of its free joints.
/// A^-1 is known, so its compliance at a contact point is J A^-1 J^T.
class ArticulationOperator final : public DenseOperator<double> {
public:
    /// Tree and plan must outlive the solve. `origins` [m]: the origin of each link.
    ArticulationOperator(const LinkTree& tree, const ArticulationPlan& plan, std::vector<Vec3> origins);

    double begin(std::span<const ContactPoint> points) override;
    void read(SolveVector from, std::span<Vec3> out) const override;
    void add(std::span<const Vec3> impulses, SolveVector to) override;
    double multiply() override;

    [[nodiscard]] Mat3 compliance(int point) const override { return between(point, point); }
    [[nodiscard]] Mat3 between(int one, int two) const override;
    void addColumns(int point, std::vector<BlockColumns>& out) const override;
    [[nodiscard]] Mat3 block(int row, int column) const override;
    void addPlaces(std::vector<BlockPlace>& out) const override;
    [[nodiscard]] bool isExact() const override { return true; }

    void smooth() override;
    double applyCoarse(std::span<const double> shares) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    [[nodiscard]] std::span<const Vec3> columnsOf(std::size_t point) const
    {
        return std::span(columns_).subspan(point * x_.size(), x_.size());
    }
    void addTo(Vector& to, std::span<const Vec3> impulses) const;

    const LinkTree& tree_;
    const ArticulationPlan& plan_;
    std::vector<Vec3> origins_; ///< [m] per link: its origin
    std::size_t points_ = 0;
    std::vector<Vec3> columns_; ///< J: per contact point and free joint
    Vector rightHandSide_;
};

} // namespace filasofia::engine

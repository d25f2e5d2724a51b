#pragma once

#include "filasofia/engine/constraint/dense_operator.h"
#include "filasofia/engine/soft/rod_system.h"

namespace filasofia::engine {

/// The body operator of a rod, for coupled solves. D is the whole matrix. Its blocks are those of the nodes, then those
/// of the angles of three edges each.
class RodOperator final : public DenseOperator<double> {
public:
    /// The system must outlive the solve. `guess` [m/s]: the first guess per node. `mass` [kg]: that of the free nodes.
    RodOperator(const RodSystem& system, std::span<const Vec3> guess, double mass);

    double begin(std::span<const ContactPoint> points) override;
    void read(SolveVector from, std::span<Vec3> out) const override;
    void add(std::span<const Vec3> impulses, SolveVector to) override;
    double multiply() override;

    [[nodiscard]] Mat3 compliance(int point) const override;
    void addColumns(int point, std::vector<BlockColumns>& out) const override;
    [[nodiscard]] Mat3 block(int row, int column) const override;
    void addPlaces(std::vector<BlockPlace>& out) const override;
    [[nodiscard]] bool isExact() const override { return true; }
    [[nodiscard]] bool couplesNodes() const override { return true; }

    void smooth() override;
    double applyCoarse(std::span<const double> shares) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    void addTo(Vector& to, std::span<const Vec3> impulses) const;
    [[nodiscard]] std::size_t nodes() const { return x_.size() / 4; }
    /// The unknown of a row of a block; none for what fills up the last block.
    [[nodiscard]] std::size_t unknownOf(std::size_t block, std::size_t row) const;

    const RodSystem& system_;
    std::span<const Vec3> guess_;
    double mass_;
    linalg::BandMatrix inverse_; ///< A^-1, within the band
    /// Per contact point: the first unknown of its node; or that of an edge's spin, and the velocity per spin [m].
    struct Place {
        std::size_t first = 0;
        std::optional<Vec3> perSpin = {};
    };
    std::vector<Place> places_;
};

} // namespace filasofia::engine

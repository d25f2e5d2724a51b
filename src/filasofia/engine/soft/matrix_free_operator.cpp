#include "filasofia/engine/soft/matrix_free_operator.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"

#include <numeric>

namespace filasofia::engine {

using linalg::Blocks;
using linalg::NodeArray;

namespace {

/// Three numbers per node.
void copyNodes(std::span<const float> from, std::span<const int> nodes, std::span<float> out)
{
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) out[3 * i + k] = from[3 * static_cast<std::size_t>(nodes[i]) + k];
}

} // namespace

MatrixFreeOperator::MatrixFreeOperator(MatrixFreeSystem& system)
    : system_(system), z_(system.dv_.blocks()), p_(system.dv_.blocks(), system.dv_.pinnedBlocks()),
      q_(system.dv_.blocks())
{
}

void MatrixFreeOperator::prepare(std::span<const Vec3> dv, WorkerPool& pool)
{
    pool_ = &pool;
    // Summed anew, as edits change the nodes: an operator made later, as that of a restored state, must agree to the
    // bit.
    mass_ =
        std::accumulate(system_.masses_.begin(), system_.masses_.begin() + system_.freeNodes_, 0.0) / system_.scale_;
    system_.load(dv, {}, p_, pool);
}

double MatrixFreeOperator::begin(std::span<const ContactPoint> points)
{
    slots_.clear();
    inverse_.clear();
    for (const ContactPoint& point : points) {
        slots_.push_back(system_.slotOf_[static_cast<std::size_t>(point.node)]);
        inverse_.push_back(system_.preconditioner_.inverseDiagonal(slots_.back()));
    }
    system_.dv_.setZero();
    return mass_;
}

Mat3 MatrixFreeOperator::compliance(int point) const
{
    return system_.scale_ * inverse_[static_cast<std::size_t>(point)];
}

void MatrixFreeOperator::addColumns(int point, std::vector<BlockColumns>& out) const
{
    out.push_back({slots_[static_cast<std::size_t>(point)], Mat3::identity()});
}

Mat3 MatrixFreeOperator::block(int row, int) const
{
    return inverse(system_.scale_ * system_.preconditioner_.inverseDiagonal(row));
}

void MatrixFreeOperator::readFrom(const NodeArray& vector, std::span<Vec3> out) const
{
    for (std::size_t k = 0; k < slots_.size(); ++k) {
        const float* at = vector[slots_[k]];
        out[k] = {at[0], at[1], at[2]};
    }
}

void MatrixFreeOperator::read(SolveVector from, std::span<Vec3> out) const
{
    if (from == SolveVector::Direction) return readFrom(p_, out);
    if (from == SolveVector::Preconditioned) return readFrom(z_, out);
    readFrom(system_.residual_, out); // w = D^-1 r is stored nowhere
    for (std::size_t k = 0; k < slots_.size(); ++k) out[k] = inverse_[k] * out[k];
}

void MatrixFreeOperator::add(std::span<const Vec3> impulses, SolveVector to)
{
    for (std::size_t k = 0; k < slots_.size(); ++k) {
        if (to == SolveVector::CoarseResidual)
            system_.preconditioner_.addToCoarseResidual(slots_[k], system_.scale_ * impulses[k]);
        else
            for (int i = 0; i < 3; ++i)
                system_.residual_[slots_[k]][i] += static_cast<float>(system_.scale_ * impulses[k][i]);
    }
}

double MatrixFreeOperator::product(const NodeArray& a, const NodeArray& b)
{
    return linalg::sumOfParts(*pool_, linalg::nodeParts(a.blocks()), system_.sums_,
                              [&](Blocks blocks) { return linalg::dot(a, b, blocks); }) /
           system_.scale_;
}

double MatrixFreeOperator::multiply() { return system_.multiply(p_, q_, *pool_) / system_.scale_; }

double MatrixFreeOperator::dot(SolveVector a, SolveVector)
{
    return a == SolveVector::Direction ? product(p_, system_.residual_) : product(z_, q_);
}

void MatrixFreeOperator::step(double alpha)
{
    const linalg::Parts parts = linalg::nodeParts(p_.blocks());
    pool_->run(parts.count(), [&](int part) {
        linalg::stepAlong(static_cast<float>(alpha), p_, q_, system_.dv_, system_.residual_, parts[part]);
    });
}

void MatrixFreeOperator::updateDirection(double beta)
{
    const linalg::Parts parts = linalg::nodeParts(p_.blocks());
    pool_->run(parts.count(),
               [&](int part) { linalg::updateDirection(z_, static_cast<float>(beta), p_, parts[part]); });
}

void MatrixFreeOperator::smooth() { system_.preconditioner_.smooth(system_.residual_, *pool_); }

double MatrixFreeOperator::applyCoarse(std::span<const double> shares)
{
    return system_.preconditioner_.applyCoarse(system_.residual_, z_, *pool_, shares) / system_.scale_;
}

void MatrixFreeOperator::subtractSmoothed(std::span<const Vec3> impulses)
{
    for (std::size_t k = 0; k < slots_.size(); ++k) {
        const Vec3 change = system_.scale_ * (inverse_[k] * impulses[k]);
        for (int i = 0; i < 3; ++i) z_[slots_[k]][i] -= static_cast<float>(change[i]);
    }
}

void MatrixFreeOperator::addCoarseColumns(int point, std::vector<BlockColumns>& out) const
{
    const int slot = slots_[static_cast<std::size_t>(point)];
    const linalg::Interpolation how = system_.preconditioner_.interpolation(slot);
    const Mat3 rotation = system_.preconditioner_.coarseRotation(slot);
    for (std::size_t k = 0; k < how.corners.size(); ++k)
        if (how.weights[k] != 0.0f) out.push_back({how.corners[k], static_cast<double>(how.weights[k]) * rotation});
}

bool MatrixFreeOperator::blendRotations() { return system_.preconditioner_.blendRotations(); }

void MatrixFreeOperator::addColumn(std::span<const Vec3> impulses)
{
    column_.clear();
    for (std::size_t k = 0; k < slots_.size(); ++k)
        if (impulses[k] != Vec3{}) column_.push_back({slots_[k], system_.scale_ * impulses[k]});
    system_.preconditioner_.addColumn(column_);
}

void MatrixFreeOperator::products(int column, std::span<double> out)
{
    system_.preconditioner_.products(column, out);
    for (double& each : out) each /= system_.scale_;
}

void MatrixFreeOperator::project(std::span<double> out)
{
    system_.preconditioner_.project(out, *pool_);
    for (double& each : out) each /= system_.scale_;
}

void MatrixFreeOperator::readColumn(int column, std::span<const int> coarseNodes, std::span<float> out) const
{
    copyNodes(system_.preconditioner_.columnAnswer(column), coarseNodes, out);
}

void MatrixFreeOperator::readAnswer(std::span<const int> coarseNodes, std::span<float> out)
{
    copyNodes(system_.preconditioner_.coarseAnswer(*pool_), coarseNodes, out);
}

void MatrixFreeOperator::subtract(std::span<const int> coarseNodes, std::span<const float> impulses)
{
    system_.preconditioner_.subtractFromCoarse(coarseNodes, impulses, static_cast<float>(system_.scale_));
}

} // namespace filasofia::engine

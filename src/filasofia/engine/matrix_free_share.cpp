#include "filasofia/engine/matrix_free_share.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"

#include <numeric>

namespace filasofia::engine {

using linalg::Blocks;
using linalg::NodeArray;

MatrixFreeShare::MatrixFreeShare(MatrixFreeSystem& system)
    : system_(system),
      mass_(std::accumulate(system.masses_.begin(), system.masses_.begin() + system.freeNodes_, 0.0) / system.scale_),
      z_(system.dv_.blocks()), p_(system.dv_.blocks(), system.dv_.pinnedBlocks()), q_(system.dv_.blocks())
{
}

void MatrixFreeShare::prepare(std::span<const Vec3> dv, WorkerPool& pool)
{
    pool_ = &pool;
    system_.load(dv, {}, p_, pool);
}

void MatrixFreeShare::begin(std::span<const Grip> grips)
{
    slots_.clear();
    inverse_.clear();
    for (const Grip& grip : grips) {
        slots_.push_back(system_.slotOf_[static_cast<std::size_t>(grip.node)]);
        inverse_.push_back(system_.preconditioner_.inverseDiagonal(slots_.back()));
    }
    system_.dv_.setZero();
}

Mat3 MatrixFreeShare::compliance(int grip) const { return system_.scale_ * inverse_[static_cast<std::size_t>(grip)]; }

double MatrixFreeShare::product(const NodeArray& a, const NodeArray& b)
{
    return linalg::sumOfParts(*pool_, linalg::nodeParts(a.blocks()), system_.sums_,
                              [&](Blocks blocks) { return linalg::dot(a, b, blocks); }) /
           system_.scale_;
}

double MatrixFreeShare::multiply() { return system_.multiply(p_, q_, *pool_) / system_.scale_; }
double MatrixFreeShare::slope() { return product(p_, system_.residual_); }

void MatrixFreeShare::descend(double alpha)
{
    const linalg::Parts parts = linalg::nodeParts(p_.blocks());
    pool_->run(parts.count(), [&](int part) {
        linalg::stepAlong(static_cast<float>(alpha), p_, q_, system_.dv_, system_.residual_, parts[part]);
    });
}

void MatrixFreeShare::turn(double beta)
{
    const linalg::Parts parts = linalg::nodeParts(p_.blocks());
    pool_->run(parts.count(),
               [&](int part) { linalg::updateDirection(z_, static_cast<float>(beta), p_, parts[part]); });
}

void MatrixFreeShare::smooth() { system_.preconditioner_.smooth(system_.residual_, *pool_); }
double MatrixFreeShare::spread(std::span<const double> shares)
{
    return system_.preconditioner_.applyCoarse(system_.residual_, z_, *pool_, shares) / system_.scale_;
}

void MatrixFreeShare::addPull(std::span<const Vec3> impulses)
{
    pull_.clear();
    for (std::size_t g = 0; g < slots_.size(); ++g)
        if (impulses[g] != Vec3{}) pull_.push_back({slots_[g], system_.scale_ * impulses[g]});
    system_.preconditioner_.addColumn(pull_);
}

void MatrixFreeShare::answers(int pull, std::span<double> out) const
{
    system_.preconditioner_.products(pull, out);
    for (double& each : out) each /= system_.scale_;
}

void MatrixFreeShare::weigh(std::span<double> sums)
{
    system_.preconditioner_.project(sums, *pool_);
    for (double& each : sums) each /= system_.scale_;
}

void MatrixFreeShare::read(const NodeArray& from, std::span<Vec3> out) const
{
    for (std::size_t g = 0; g < slots_.size(); ++g) {
        const float* at = from[slots_[g]];
        out[g] = {at[0], at[1], at[2]};
    }
}

void MatrixFreeShare::add(std::span<const Vec3> impulses, NodeArray& to) const
{
    for (std::size_t g = 0; g < slots_.size(); ++g)
        for (int k = 0; k < 3; ++k) to[slots_[g]][k] += static_cast<float>(system_.scale_ * impulses[g][k]);
}

void MatrixFreeShare::readSmoothed(std::span<Vec3> w) const
{
    read(system_.residual_, w);
    for (std::size_t g = 0; g < slots_.size(); ++g) w[g] = inverse_[g] * w[g];
}

void MatrixFreeShare::addToSpread(std::span<const Vec3> impulses)
{
    for (std::size_t g = 0; g < slots_.size(); ++g)
        system_.preconditioner_.addToCoarseResidual(slots_[g], system_.scale_ * impulses[g]);
}

void MatrixFreeShare::subtractSmoothed(std::span<const Vec3> impulses)
{
    for (std::size_t g = 0; g < slots_.size(); ++g) {
        const Vec3 change = system_.scale_ * (inverse_[g] * impulses[g]);
        for (int k = 0; k < 3; ++k) z_[slots_[g]][k] -= static_cast<float>(change[k]);
    }
}

} // namespace filasofia::engine

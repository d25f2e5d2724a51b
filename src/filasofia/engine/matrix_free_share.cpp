#include "filasofia/engine/matrix_free_share.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"

#include <numeric>

namespace filasofia::engine {

using linalg::Blocks;
using linalg::NodeArray;

namespace {

/// out = from + t (to - from), over the unknowns.
void mix(const NodeArray& from, const NodeArray& to, double t, NodeArray& out)
{
    const auto share = static_cast<float>(t);
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t{4} * linalg::kBlock * from.blocks(); ++i)
        out.data()[i] = from.data()[i] + share * (to.data()[i] - from.data()[i]);
}

} // namespace

MatrixFreeShare::MatrixFreeShare(MatrixFreeSystem& system)
    : system_(system),
      mass_(std::accumulate(system.masses_.begin(), system.masses_.begin() + system.freeNodes_, 0.0) / system.scale_),
      z_(system.dv_.blocks()), p_(system.dv_.blocks(), system.dv_.heldBlocks()), q_(system.dv_.blocks()),
      xSaved_(system.dv_.blocks()), rSaved_(system.dv_.blocks())
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
    for (const Grip& grip : grips) slots_.push_back(system_.slotOf_[static_cast<std::size_t>(grip.node)]);
    system_.dv_.setZero();
}

Mat3 MatrixFreeShare::compliance(int grip) const
{
    return system_.scale_ * system_.preconditioner_.inverseDiagonal(slots_[static_cast<std::size_t>(grip)]);
}

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
        linalg::descend(static_cast<float>(alpha), p_, q_, system_.dv_, system_.residual_, parts[part]);
    });
}

void MatrixFreeShare::turn(double beta)
{
    const linalg::Parts parts = linalg::nodeParts(p_.blocks());
    pool_->run(parts.count(), [&](int part) { linalg::turn(z_, static_cast<float>(beta), p_, parts[part]); });
}

void MatrixFreeShare::smooth() { system_.preconditioner_.smooth(system_.residual_, *pool_); }
double MatrixFreeShare::spread()
{
    return system_.preconditioner_.spread(system_.residual_, z_, *pool_) / system_.scale_;
}

void MatrixFreeShare::save()
{
    mix(system_.dv_, system_.dv_, 0.0, xSaved_);
    mix(system_.residual_, system_.residual_, 0.0, rSaved_);
}

std::array<double, 2> MatrixFreeShare::rise()
{
    const NodeArray& x = system_.dv_; // q is free: the difference goes there
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t{4} * linalg::kBlock * x.blocks(); ++i)
        q_.data()[i] = x.data()[i] - xSaved_.data()[i];
    return {product(q_, rSaved_), product(q_, system_.residual_)};
}

void MatrixFreeShare::goBack(double t)
{
    mix(xSaved_, system_.dv_, t, system_.dv_);
    mix(rSaved_, system_.residual_, t, system_.residual_);
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
    for (std::size_t g = 0; g < slots_.size(); ++g) w[g] = system_.preconditioner_.smoothedAt(slots_[g]);
}

void MatrixFreeShare::addToSpread(std::span<const Vec3> impulses)
{
    for (std::size_t g = 0; g < slots_.size(); ++g)
        system_.preconditioner_.addToSpread(slots_[g], system_.scale_ * impulses[g]);
}

void MatrixFreeShare::subtractSmoothed(std::span<const Vec3> impulses)
{
    for (std::size_t g = 0; g < slots_.size(); ++g) {
        const Vec3 change = compliance(static_cast<int>(g)) * impulses[g];
        for (int k = 0; k < 3; ++k) z_[slots_[g]][k] -= static_cast<float>(change[k]);
    }
}

} // namespace filasofia::engine

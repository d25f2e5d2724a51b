#pragma once

#include "filasofia/engine/constraint/body_operator.h"

#include <Eigen/Dense>

#include <vector>

namespace filasofia::engine {

/// A body given by any symmetric positive definite matrix over its nodes: nodes are grips. D is its diagonal in blocks
/// of three, B nothing or a part of the true inverse.
class DenseBody final : public CoupledBody {
public:
    DenseBody(Eigen::MatrixXd matrix, Eigen::VectorXd right, bool coarse)
        : a(std::move(matrix)), b(std::move(right)), inverse_(a.inverse()), coarse_(coarse)
    {
        guess = Eigen::VectorXd::Zero(b.size());
    }

    void begin(std::span<const Grip> grips) override
    {
        grips_.assign(grips.begin(), grips.end());
        pulls_.clear();
        x = Eigen::VectorXd::Zero(b.size());
        r_ = b;
        p_ = guess;
    }
    [[nodiscard]] Mat3 compliance(int grip) const override
    {
        const Eigen::Matrix3d m = block(grips_[static_cast<std::size_t>(grip)].node).inverse();
        return {{{m(0, 0), m(0, 1), m(0, 2)}, {m(1, 0), m(1, 1), m(1, 2)}, {m(2, 0), m(2, 1), m(2, 2)}}};
    }
    [[nodiscard]] double mass() const override { return a.trace() / 3.0; }
    double multiply() override { return p_.dot(q_ = a * p_); }
    double slope() override { return p_.dot(r_); }
    void descend(double alpha) override
    {
        x += alpha * p_;
        r_ -= alpha * q_;
    }
    void turn(double beta) override { p_ = z_ + beta * p_; }
    void smooth() override
    {
        w_ = smoothed(r_);
        s_ = r_;
    }
    double spread(std::span<const double> shares) override
    {
        z_ = w_;
        if (coarse_) z_ += 0.5 * (inverse_ * s_);
        for (std::size_t i = 0; i < shares.size(); ++i) z_ -= shares[i] * 0.5 * (inverse_ * pulls_[i]);
        return r_.dot(z_);
    }
    [[nodiscard]] bool correctable() const override { return coarse_; }
    void clearPulls() override { pulls_.clear(); }
    void addPull(std::span<const Vec3> impulses) override { pulls_.push_back(scattered(impulses)); }
    void answers(int pull, std::span<double> out) const override
    {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = i < pulls_.size() ? pulls_[i].dot(0.5 * (inverse_ * pulls_[static_cast<std::size_t>(pull)])) : 0.0;
    }
    void weigh(std::span<double> sums) override
    {
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = pulls_[i].dot(0.5 * (inverse_ * s_));
    }
    double bent() override { return z_.dot(q_); }
    void readDirection(std::span<Vec3> p) const override { read(p_, p); }
    void readSmoothed(std::span<Vec3> w) const override { read(w_, w); }
    void readSpread(std::span<Vec3> z) const override { read(z_, z); }
    void addToResidual(std::span<const Vec3> impulses) override { r_ += scattered(impulses); }
    void addToSpread(std::span<const Vec3> impulses) override { s_ += scattered(impulses); }
    void subtractSmoothed(std::span<const Vec3> impulses) override { z_ -= smoothed(scattered(impulses)); }

    void setResidual(const Eigen::VectorXd& r) { r_ = r; }

    Eigen::MatrixXd a;
    Eigen::VectorXd b, x, guess;

private:
    [[nodiscard]] Eigen::Matrix3d block(int node) const { return a.block<3, 3>(3 * node, 3 * node); }
    [[nodiscard]] Eigen::VectorXd smoothed(const Eigen::VectorXd& r) const
    {
        Eigen::VectorXd w(r.size());
        for (int i = 0; 3 * i < r.size(); ++i) w.segment<3>(3 * i) = block(i).inverse() * r.segment<3>(3 * i);
        return w;
    }
    void read(const Eigen::VectorXd& from, std::span<Vec3> out) const
    {
        for (std::size_t g = 0; g < grips_.size(); ++g) {
            const Eigen::Vector3d v = from.segment<3>(3 * grips_[g].node);
            out[g] = {v.x(), v.y(), v.z()};
        }
    }
    [[nodiscard]] Eigen::VectorXd scattered(std::span<const Vec3> impulses) const
    {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(b.size());
        for (std::size_t g = 0; g < grips_.size(); ++g)
            sum.segment<3>(3 * grips_[g].node) += Eigen::Vector3d(impulses[g].x, impulses[g].y, impulses[g].z);
        return sum;
    }

    std::vector<Grip> grips_;
    std::vector<Eigen::VectorXd> pulls_;
    Eigen::MatrixXd inverse_;
    Eigen::VectorXd r_, p_, q_, w_, s_, z_;
    bool coarse_;
};

} // namespace filasofia::engine

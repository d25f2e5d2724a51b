#pragma once

#include "filasofia/engine/constraint/body_operator.h"

#include <Eigen/Dense>

#include <vector>

namespace filasofia::engine {

/// A body given by any symmetric positive definite matrix over its nodes; contact points are nodes. D is its diagonal
/// in blocks of three, B is zero or half of the true inverse.
class DenseBody final : public BodyOperator, public BodySmoother, public BodyPreconditioner, private DeflationOperator {
public:
    DenseBody(Eigen::MatrixXd matrix, Eigen::VectorXd right, bool coarse)
        : a(std::move(matrix)), b(std::move(right)), inverse_(a.inverse()), coarse_(coarse)
    {
        guess = Eigen::VectorXd::Zero(b.size());
    }

    double begin(std::span<const ContactPoint> points) override
    {
        points_.assign(points.begin(), points.end());
        columns_.clear();
        x = Eigen::VectorXd::Zero(b.size());
        r_ = b;
        p_ = guess;
        return a.trace() / 3.0;
    }
    [[nodiscard]] Mat3 compliance(int point) const override
    {
        const int node = points_[static_cast<std::size_t>(point)].node;
        return inverse(block(node, node));
    }
    void addColumns(int point, std::vector<BlockColumns>& out) const override
    {
        out.push_back({points_[static_cast<std::size_t>(point)].node, Mat3::identity()});
    }
    [[nodiscard]] Mat3 block(int row, int) const override
    {
        const Eigen::Matrix3d m = blockOf(row);
        return {{{m(0, 0), m(0, 1), m(0, 2)}, {m(1, 0), m(1, 1), m(1, 2)}, {m(2, 0), m(2, 1), m(2, 2)}}};
    }
    double multiply() override { return p_.dot(q_ = a * p_); }
    double dot(SolveVector first, SolveVector) override
    {
        return first == SolveVector::Direction ? p_.dot(r_) : z_.dot(q_);
    }
    void step(double alpha) override
    {
        x += alpha * p_;
        r_ -= alpha * q_;
    }
    void updateDirection(double beta) override { p_ = z_ + beta * p_; }
    void smooth() override
    {
        w_ = smoothed(r_);
        s_ = r_;
    }
    double applyCoarse(std::span<const double> shares) override
    {
        z_ = w_;
        if (coarse_) z_ += 0.5 * (inverse_ * s_);
        for (std::size_t i = 0; i < shares.size(); ++i) z_ -= shares[i] * 0.5 * (inverse_ * columns_[i]);
        return r_.dot(z_);
    }
    void subtractSmoothed(std::span<const Vec3> impulses) override { z_ -= smoothed(scattered(impulses)); }
    [[nodiscard]] DeflationOperator* deflation() override { return coarse_ ? this : nullptr; }
    void read(SolveVector from, std::span<Vec3> out) const override
    {
        const Eigen::VectorXd& vector = from == SolveVector::Direction ? p_ : from == SolveVector::Smoothed ? w_ : z_;
        for (std::size_t k = 0; k < points_.size(); ++k) {
            const Eigen::Vector3d v = vector.segment<3>(3 * points_[k].node);
            out[k] = {v.x(), v.y(), v.z()};
        }
    }
    void add(std::span<const Vec3> impulses, SolveVector to) override
    {
        (to == SolveVector::Residual ? r_ : s_) += scattered(impulses);
    }

    void setResidual(const Eigen::VectorXd& r) { r_ = r; }

    Eigen::MatrixXd a;
    Eigen::VectorXd b, x, guess;

private:
    void addCoarseColumns(int point, std::vector<BlockColumns>& out) const override { addColumns(point, out); }
    void clear() override { columns_.clear(); }
    void addColumn(std::span<const Vec3> impulses) override { columns_.push_back(scattered(impulses)); }
    void finish() override { finished_ = columns_.size(); }
    void products(int column, std::span<double> out) override
    {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] =
                i < finished_ ? columns_[i].dot(0.5 * (inverse_ * columns_[static_cast<std::size_t>(column)])) : 0.0;
    }
    void project(std::span<double> out) override
    {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = columns_[i].dot(0.5 * (inverse_ * s_));
    }

    void readColumn(int column, std::span<const int> coarseNodes, std::span<float> out) const override
    {
        copyNodes(0.5 * (inverse_ * columns_[static_cast<std::size_t>(column)]), coarseNodes, out);
    }
    void readAnswer(std::span<const int> coarseNodes, std::span<float> out) override
    {
        copyNodes(0.5 * (inverse_ * s_), coarseNodes, out);
    }
    void subtract(std::span<const int> coarseNodes, std::span<const float> impulses) override
    {
        for (std::size_t i = 0; i < coarseNodes.size(); ++i)
            for (int k = 0; k < 3; ++k)
                s_[3 * coarseNodes[i] + k] -= static_cast<double>(impulses[3 * i + static_cast<std::size_t>(k)]);
    }
    static void copyNodes(const Eigen::VectorXd& from, std::span<const int> nodes, std::span<float> out)
    {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (int k = 0; k < 3; ++k)
                out[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(from[3 * nodes[i] + k]);
    }

    [[nodiscard]] Eigen::Matrix3d blockOf(int node) const { return a.block<3, 3>(3 * node, 3 * node); }
    [[nodiscard]] Eigen::VectorXd smoothed(const Eigen::VectorXd& r) const
    {
        Eigen::VectorXd w(r.size());
        for (int i = 0; 3 * i < r.size(); ++i) w.segment<3>(3 * i) = blockOf(i).inverse() * r.segment<3>(3 * i);
        return w;
    }
    [[nodiscard]] Eigen::VectorXd scattered(std::span<const Vec3> impulses) const
    {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(b.size());
        for (std::size_t k = 0; k < points_.size(); ++k)
            sum.segment<3>(3 * points_[k].node) += Eigen::Vector3d(impulses[k].x, impulses[k].y, impulses[k].z);
        return sum;
    }

    std::vector<ContactPoint> points_;
    std::vector<Eigen::VectorXd> columns_;
    std::size_t finished_ = 0; ///< number of finished columns
    Eigen::MatrixXd inverse_;
    Eigen::VectorXd r_, p_, q_, w_, s_, z_;
    bool coarse_;
};

} // namespace filasofia::engine

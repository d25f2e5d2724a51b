#pragma once

#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/rotation_kernels.h"
#include "filasofia/math/quat.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace filasofia::linalg {

inline std::vector<Vec3> randomVector(std::mt19937& random, int n)
{
    std::normal_distribution<double> number;
    std::vector<Vec3> x(n);
    for (Vec3& v : x) v = {number(random), number(random), number(random)};
    return x;
}

/// A random sparse symmetric matrix: positive definite, because it is a sum of spring stiffnesses and a positive
/// diagonal.
inline BlockSparseMatrix randomSpd(std::mt19937& random, int n)
{
    std::uniform_int_distribution<int> index(0, n - 1);
    std::vector<std::array<int, 2>> pairs;
    std::vector<std::vector<int>> columns(n);
    for (int i = 0; i < n; ++i) columns[i].push_back(i);
    for (int k = 0; k < 3 * n; ++k) {
        const int i = index(random), j = index(random);
        if (i == j) continue;
        pairs.push_back({i, j});
        columns[i].push_back(j);
        columns[j].push_back(i);
    }
    for (auto& row : columns) {
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
    }
    BlockSparseMatrix a(columns);
    for (int i = 0; i < n; ++i) a.block(a.find(i, i)) = 0.1 * Mat3::identity();
    for (const auto& [i, j] : pairs) {
        const Vec3 u = randomVector(random, 1)[0]; // the stiffness u u^T of a spring between i and j
        const Mat3 k = outer(u, u);
        a.block(a.find(i, i)) += k;
        a.block(a.find(j, j)) += k;
        a.block(a.find(i, j)) -= k;
        a.block(a.find(j, i)) -= k;
    }
    return a;
}

inline float randomFloat(std::mt19937& random)
{
    return static_cast<float>(std::normal_distribution<double>()(random));
}

/// The first `count` nodes are random, x y z 0, and the rest of the array zero.
inline NodeArray randomNodes(std::mt19937& random, int count, int pinnedBlocks = 0)
{
    NodeArray nodes(blocksFor(count), pinnedBlocks);
    for (int node = 0; node < count; ++node)
        for (int i = 0; i < 3; ++i) nodes[node][i] = randomFloat(random);
    return nodes;
}

inline Quat randomQuat(std::mt19937& random)
{
    std::normal_distribution<double> number;
    return normalized(Quat{number(random), number(random), number(random), number(random)});
}

inline void setRotation(std::vector<RotationBlock>& rotations, int node, Quat q)
{
    storeRotation(rotations, node, toMat3(q));
}

inline Mat3 rotationOf(const std::vector<RotationBlock>& rotations, int node)
{
    Mat3 r;
    for (int k = 0; k < 9; ++k)
        r[k / 3][k % 3] = static_cast<double>(rotations[static_cast<std::size_t>(node / kBlock)].m[k][node % kBlock]);
    return r;
}

inline std::vector<RotationBlock> randomRotations(std::mt19937& random, int blocks)
{
    std::vector<RotationBlock> rotations(static_cast<std::size_t>(blocks));
    for (int node = 0; node < kBlock * blocks; ++node) setRotation(rotations, node, randomQuat(random));
    return rotations;
}

inline Vec3 vectorOf(const float* node) { return {node[0], node[1], node[2]}; }

/// Half the distance of floats around 1: the largest error of one operation, relative to its result.
constexpr double kRounding = 0x1p-24;

/// The largest error of all values compared, in roundings of the terms that were summed.
class WorstError {
public:
    /// `size`: the sum of the absolute values of the terms of the exact value.
    void compare(double value, double exact, double size)
    {
        const double error = std::abs(value - exact) / (kRounding * size);
        if (value == exact) return;
        if (!(error <= roundings_)) roundings_ = std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
    }
    [[nodiscard]] double roundings() const { return roundings_; }

private:
    double roundings_ = 0.0;
};

/// Whether an instruction set multiplies and adds with one rounding. All of those give the same bits.
inline bool isFused(const std::string& target)
{
    return target.rfind("SSE", 0) != 0 && target != "EMU128" && target != "SCALAR";
}

/// Calls test(name) on every instruction set of this machine. The best one is restored afterwards, even if a check
/// throws.
template <class Test> void onEveryTarget(const Test& test)
{
    struct BestAgain {
        ~BestAgain() { useSimdTarget({}); }
    } const bestAgain;
    for (const std::string& target : simdTargets()) {
        INFO("instruction set " << target);
        useSimdTarget(target);
        REQUIRE(simdTarget() == target);
        test(target);
    }
}

/// `results()` returns the bits of many results by name; all instruction sets that fuse must agree on them.
template <class Results> void checkSameBitsWhereFused(const Results& results)
{
    decltype(results()) first;
    onEveryTarget([&](const std::string& target) {
        if (!isFused(target)) return;
        const auto found = results();
        if (first.empty()) first = found;
        CHECK(found == first);
    });
}

} // namespace filasofia::linalg

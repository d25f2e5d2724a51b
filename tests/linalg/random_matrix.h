#pragma once

#include "filasofia/linalg/block_sparse_matrix.h"

#include <algorithm>
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

/// A random sparse symmetric matrix made positive definite by adding, per random pair, a block that is.
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

} // namespace filasofia::linalg

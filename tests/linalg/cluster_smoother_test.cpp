#include "filasofia/linalg/cluster_smoother.h"

#include "filasofia/core/worker_pool.h"

#include "linalg/preconditioner_problem.h"

namespace cluster_smoother_test {

using namespace filasofia;
using namespace filasofia::linalg;
using Problem = PreconditionerProblem;

namespace {

/// The unknowns of a problem in clusters of these sizes, in their order; the rest is in none.
struct Clusters {
    std::vector<int> nodes;
    std::vector<double> matrices;

    Clusters(const Problem& problem, std::initializer_list<int> sizes)
    {
        const Eigen::MatrixXd a = denseMatrix(problem);
        int first = 0;
        for (const int size : sizes) {
            Eigen::MatrixXd block = Eigen::MatrixXd::Zero(kPieceUnknowns, kPieceUnknowns);
            block.topLeftCorner(3 * size, 3 * size) = a.block(3 * first, 3 * first, 3 * size, 3 * size);
            for (int i = 0; i < kPieceNodes; ++i) nodes.push_back(i < size ? first + i : -1);
            for (Eigen::Index r = 0; r < kPieceUnknowns; ++r)
                for (Eigen::Index c = 0; c < kPieceUnknowns; ++c) matrices.push_back(c > r ? 1e9 : block(r, c));
            first += size;
        }
    }
};

/// What the clusters add up to at rest; `sizes` as above. The diagonal of each is enlarged as that of small pieces is.
Eigen::MatrixXd denseClusters(const Problem& problem, std::initializer_list<int> sizes)
{
    Eigen::MatrixXd a = denseMatrix(problem);
    a.diagonal() *= 1.0 + 1e-5;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(a.rows(), a.cols());
    Eigen::Index first = 0;
    for (const int size : sizes) {
        const Eigen::Index n = 3 * static_cast<Eigen::Index>(size);
        out.block(first, first, n, n) = a.block(first, first, n, n).inverse();
        first += n;
    }
    return out;
}

} // namespace

TEST_CASE("clusters are solved exactly, and other nodes stay as they are")
{
    std::mt19937 random(11);
    const int unknowns = 70, clustered = 16 + 9 + 16 + 2;
    const Problem problem(random, unknowns, unknowns, 0);
    const Clusters clusters(problem, {16, 9, 16, 2});
    const ClusterSmoother smoother(clusters.nodes, clusters.matrices);
    const NodeArray s = randomNodes(random, unknowns), before = randomNodes(random, unknowns);
    const Eigen::VectorXd exact = denseClusters(problem, {16, 9, 16, 2}) * dense(s, unknowns);
    for (const int threads : {1, 2}) {
        WorkerPool pool(threads);
        NodeArray set = before;
        smoother.apply(s, set, pool);
        CHECK((dense(set, unknowns) - exact).head(3 * clustered).norm() <= 1e-5 * exact.norm());
        for (int node = clustered; node < unknowns; ++node) {
            CHECK(vectorOf(set[node]) == vectorOf(before[node]));
        }
    }
}

TEST_CASE("a cluster whose matrix is not positive definite is left out")
{
    std::mt19937 random(12);
    WorkerPool pool(1);
    const Problem problem(random, 32, 32, 0);
    Clusters clusters(problem, {16, 16});
    clusters.matrices[0] = -1.0;
    const ClusterSmoother smoother(clusters.nodes, clusters.matrices);
    const NodeArray s = randomNodes(random, 32), before = randomNodes(random, 32);
    NodeArray w = before;
    smoother.apply(s, w, pool);
    for (int node = 0; node < 16; ++node) CHECK(vectorOf(w[node]) == vectorOf(before[node]));
    for (int node = 16; node < 32; ++node) CHECK(vectorOf(w[node]) != vectorOf(before[node]));
}

TEST_CASE("in the preconditioner, clusters take the place of single nodes, but not in its two halves")
{
    std::mt19937 random(13);
    WorkerPool pool(2);
    const int unknowns = 60;
    const Problem problem(random, unknowns, unknowns, 7);
    const Clusters clusters(problem, {16, 16, 10});
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
    CHECK_FALSE(m.hasClusters());
    m.setClusters({clusters.nodes, clusters.matrices});
    CHECK(m.hasClusters());
    Eigen::MatrixXd r = Eigen::MatrixXd::Zero(3 * unknowns, 3 * unknowns);
    for (int i = 0; i < unknowns; ++i) r.block<3, 3>(3 * i, 3 * i) = dense(rotationOf(m.rotations(), i));
    const Eigen::MatrixXd plain = densePreconditioner(problem, m.rotations());
    Eigen::MatrixXd replaced = plain + r * denseClusters(problem, {16, 16, 10}) * r.transpose();
    for (Eigen::Index i = 0; i < Eigen::Index(3) * (16 + 16 + 10); i += 3)
        replaced.block<3, 3>(i, i) -=
            r.block<3, 3>(i, i) * denseMatrix(problem).block<3, 3>(i, i).inverse() * r.block<3, 3>(i, i).transpose();
    const NodeArray residual = randomNodes(random, unknowns);
    NodeArray z(residual.blocks());
    const auto check = [&](double rz, const Eigen::MatrixXd& matrix) {
        const Eigen::VectorXd exact = matrix * dense(residual, unknowns);
        CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
        CHECK(std::abs(rz - exact.dot(dense(residual, unknowns))) <=
              1e-5 * exact.norm() * dense(residual, unknowns).norm());
    };
    check(m.apply(residual, z, pool), replaced);
    m.smooth(residual, pool);
    check(m.applyCoarse(residual, z, pool), plain);
}

} // namespace cluster_smoother_test

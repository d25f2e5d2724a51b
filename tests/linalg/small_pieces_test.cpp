#include "filasofia/linalg/small_pieces.h"

#include "filasofia/core/worker_pool.h"

#include "linalg/preconditioner_problem.h"

namespace small_pieces_test {

using namespace filasofia;
using namespace filasofia::linalg;
using Problem = PreconditionerProblem;

TEST_CASE("small pieces are solved for exactly, beside the coarse nodes of the others or alone")
{
    std::mt19937 random(7);
    WorkerPool pool(2);
    const int unknowns = 50;
    for (const int coarseNodes : {0, 5, 16, 21})
        for (const int pieces : {1, 3}) {
            INFO(coarseNodes << " coarse nodes, " << pieces << " pieces");
            const Problem problem(random, 60, unknowns, coarseNodes, pieces);
            TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
            CHECK(m.coarseNodes() == problem.allCoarseNodes());
            const NodeArray r = randomNodes(random, unknowns);
            NodeArray z(r.blocks());
            const double rz = m.apply(r, z, pool);
            const Eigen::VectorXd exact = densePreconditioner(problem, m.rotations()) * dense(r, unknowns);
            CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
            CHECK(std::abs(rz - exact.dot(dense(r, unknowns))) <= 1e-5 * exact.norm() * dense(r, unknowns).norm());
        }
}

TEST_CASE("a small piece that nothing holds moves rigidly in the coarse level")
{
    std::mt19937 random(9);
    WorkerPool pool(1);
    const int unknowns = 60, pieces = 2;
    const double massWeight = 1.25;
    Problem problem(random, 60, unknowns, 5, pieces);
    problem.freePieces[1] = 0; // keeps its matrix at rest
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
    const Eigen::MatrixXd before = densePreconditioner(problem, m.rotations());
    const Eigen::MatrixXd smoother = densePreconditioner(problem.withoutCoarseLevel(), m.rotations());
    const NodeArray x = randomNodes(random, unknowns), r = randomNodes(random, unknowns);
    std::vector<float> masses(static_cast<std::size_t>(unknowns));
    for (float& mass : masses) mass = 0.5f + std::abs(randomFloat(random));
    std::vector<int> nodes; // the nodes of the free piece
    for (int i = 0; i < unknowns; ++i)
        if (problem.rows[static_cast<std::size_t>(i)] < Problem::kPieceRows) nodes.push_back(i);
    REQUIRE(nodes.size() == Problem::kPieceRows);

    double mass = 0.0;
    Vec3 centre, force, torque;
    const auto massOf = [&](int node) { return static_cast<double>(masses[static_cast<std::size_t>(node)]); };
    for (int node : nodes) {
        mass += massOf(node);
        centre += massOf(node) * vectorOf(x[node]);
        force += vectorOf(r[node]);
    }
    centre = 1.0 / mass * centre;
    Mat3 inertia;
    for (int node : nodes) {
        const Vec3 arm = vectorOf(x[node]) - centre;
        torque += cross(arm, vectorOf(r[node]));
        inertia += massOf(node) * (lengthSquared(arm) * Mat3::identity() - outer(arm, arm));
    }
    Eigen::VectorXd exact = before * dense(r, unknowns);
    const Eigen::VectorXd smooth = smoother * dense(r, unknowns);
    for (int node : nodes) {
        const Vec3 rotated = cross(inverse(inertia) * torque, vectorOf(x[node]) - centre);
        const Vec3 moved = 1.0 / massWeight * (1.0 / mass * force + rotated);
        exact.segment<3>(3 * node) = smooth.segment<3>(3 * node) + Eigen::Vector3d(moved.x, moved.y, moved.z);
    }
    m.followPieces(x, masses, massWeight);
    NodeArray z(r.blocks());
    m.apply(r, z, pool);
    CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
}

} // namespace small_pieces_test

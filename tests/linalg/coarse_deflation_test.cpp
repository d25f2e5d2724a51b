#include "filasofia/linalg/coarse_deflation.h"

#include "filasofia/core/worker_pool.h"

#include "linalg/preconditioner_problem.h"

namespace coarse_deflation_test {

using namespace filasofia;
using namespace filasofia::linalg;
using Problem = PreconditionerProblem;

TEST_CASE("deflation columns have the products and projections of the coarse level, and are taken from its correction")
{
    std::mt19937 random(6);
    WorkerPool pool(2);
    const int unknowns = 45, columns = 19; // more than lie side by side
    const Problem problem(random, 60, unknowns, 7, 2);
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
    const Eigen::MatrixXd whole = densePreconditioner(problem, m.rotations());
    const Eigen::MatrixXd coarse = whole - densePreconditioner(problem.withoutCoarseLevel(), m.rotations());
    for (int round = 0; round < 2; ++round) { // the second one after other columns were cleared
        Eigen::MatrixXd f = Eigen::MatrixXd::Zero(3 * unknowns, columns);
        m.clearColumns();
        for (int c = 0; c < columns; ++c) {
            std::vector<ColumnEntry> column;
            for (int k = 0; k < 4; ++k) {
                int node = static_cast<int>(random() % unknowns);
                while ((c == 7 || c == 8 || c == columns - 1) &&
                       problem.rows[static_cast<std::size_t>(node)] >= Problem::kPieceRows)
                    node = static_cast<int>(random() % unknowns); // these columns reach a small piece and nothing else
                const Vec3 value{randomFloat(random), randomFloat(random), randomFloat(random)};
                column.push_back({node, value});
                f.block<3, 1>(3 * node, c) += Eigen::Vector3d(value.x, value.y, value.z);
            }
            m.addColumn(column);
        }
        m.finishColumns();
        const Eigen::MatrixXd products = f.transpose() * coarse * f;
        std::vector<double> found(columns), coefficients(columns);
        for (int c = 0; c < columns; ++c) {
            m.products(c, found);
            for (int d = 0; d < columns; ++d)
                CHECK(std::abs(found[static_cast<std::size_t>(d)] - products(c, d)) <= 1e-5 * products.norm());
        }
        const NodeArray r = randomNodes(random, unknowns);
        NodeArray z(r.blocks());
        m.smooth(r, pool);
        m.project(found, pool);
        const Eigen::VectorXd projections = f.transpose() * coarse * dense(r, unknowns);
        for (int c = 0; c < columns; ++c)
            CHECK(std::abs(found[static_cast<std::size_t>(c)] - projections[c]) <= 1e-5 * projections.norm());
        for (double& each : coefficients) each = randomFloat(random);
        m.applyCoarse(r, z, pool, coefficients);
        const Eigen::VectorXd exact =
            whole * dense(r, unknowns) - coarse * f * Eigen::Map<Eigen::VectorXd>(coefficients.data(), columns);
        CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
    }
}

} // namespace coarse_deflation_test

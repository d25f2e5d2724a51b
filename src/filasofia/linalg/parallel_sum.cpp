#include "filasofia/linalg/parallel_sum.h"

#include "filasofia/linalg/eigen_blocking.h"
#include "filasofia/linalg/write_panels.h"

#include <Eigen/Cholesky>

namespace filasofia::linalg {

std::optional<std::vector<PanelRow>> parallelSum(std::span<const double> b, std::span<const double> h, int n)
{
    // The products are in float: an H that is much larger than B^-1 would leave a difference without digits.
    constexpr double kMoreCompliant = 1e-5;
    fixBlocking();
    Eigen::MatrixXd compliance = Eigen::Map<const Eigen::MatrixXd>(b.data(), n, n);
    compliance.diagonal() *= 1.0 + kMoreCompliant;
    const Eigen::LLT<Eigen::MatrixXd> ofB(compliance);
    if (ofB.info() != Eigen::Success) return std::nullopt;
    const Eigen::MatrixXd stiffness = ofB.solve(Eigen::MatrixXd::Identity(n, n)); // S = B^-1
    const Eigen::LLT<Eigen::MatrixXd> sum(stiffness + Eigen::Map<const Eigen::MatrixXd>(h.data(), n, n));
    if (sum.info() != Eigen::Success) return std::nullopt;
    const Eigen::MatrixXd half = sum.matrixL().solve(stiffness); // W = S - S (S + H)^-1 S
    const Eigen::MatrixXd w = stiffness - half.transpose() * half;
    if (!w.allFinite()) return std::nullopt;

    const int rows = (n + 3) / 4 * 4;
    std::vector<PanelRow> panels(static_cast<std::size_t>(blocksFor(n)) * static_cast<std::size_t>(rows));
    writePanels(w, rows, panels.data());
    return panels;
}

} // namespace filasofia::linalg

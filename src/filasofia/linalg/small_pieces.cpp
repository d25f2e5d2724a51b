// What the coarse level of a TwoLevelPreconditioner has of small pieces.
#include "filasofia/linalg/two_level_preconditioner.h"

#include <algorithm>

namespace filasofia::linalg {
namespace {

void writeBlock(PanelRow* panels, int row, int column, const Mat3& block)
{
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            const int at = 3 * column + c;
            panels[at / kBlock * kPieceUnknowns + 3 * row + r].values[at % kBlock] = static_cast<float>(block[r][c]);
        }
}

} // namespace

int TwoLevelPreconditioner::nodeOfPiece(std::size_t piece, int place) const
{
    const auto coarse = static_cast<std::size_t>(firstPieceNode(latticeNodes_) + place) + piece * kPieceNodes;
    return restriction_.size(coarse) == 0 ? -1 : restriction_.begin(coarse)->node;
}

void TwoLevelPreconditioner::followPieces(const NodeArray& x, std::span<const float> masses, double massWeight)
{
    struct Point {
        int at;    ///< its place in the piece
        Vec3 arm;  ///< [m] from the centre
        Mat3 turn; ///< R^T
        double mass;
    };
    std::vector<Point> points;
    for (std::size_t p = 0; p < freePieces_.size(); ++p) {
        if (freePieces_[p] == 0) continue;
        points.clear();
        double mass = 0.0;
        Vec3 centre;
        for (int i = 0; i < kPieceNodes; ++i) {
            const int node = nodeOfPiece(p, i);
            if (node < 0) continue;
            const float* at = x[node];
            points.push_back(
                {i, {at[0], at[1], at[2]}, transpose(rotation(node)), masses[static_cast<std::size_t>(node)]});
            mass += points.back().mass;
            centre += points.back().mass * points.back().arm;
        }
        if (!(mass > 0.0)) continue;
        centre = 1.0 / mass * centre;
        Mat3 inertia;
        for (Point& each : points) {
            each.arm -= centre;
            inertia += each.mass * (lengthSquared(each.arm) * Mat3::identity() - outer(each.arm, each.arm));
        }
        const double size = trace(inertia) / 3.0;
        const bool solid = determinant(inertia) > 1e-6 * size * size * size; // else in a point or on a line
        const Mat3 spin = solid ? inverse(inertia) : Mat3{};
        // An impulse at one point moves another by I/m + [d_i]^T J^-1 [d_j], both as the pieces were at rest.
        PanelRow* panels = pieceInverses_.data() + p * kPieceRows;
        for (const Point& a : points)
            for (const Point& b : points) {
                const Mat3 moved =
                    1.0 / massWeight *
                    (1.0 / mass * Mat3::identity() + transpose(crossMatrix(a.arm)) * spin * crossMatrix(b.arm));
                writeBlock(panels, a.at, b.at, a.turn * moved * transpose(b.turn));
            }
    }
}

/// Those that feel something.
void TwoLevelPreconditioner::answerPieces(std::span<const float> felt, std::span<float> answered) const
{
    const std::size_t first = 3 * static_cast<std::size_t>(firstPieceNode(latticeNodes_));
    for (std::size_t at = 0; at < pieceInverses_.size(); at += kPieceRows) {
        const std::size_t from = first + at / kPieceRows * kPieceUnknowns;
        const auto x = felt.subspan(from, kPieceUnknowns);
        const auto y = answered.subspan(from, kPieceUnknowns);
        if (std::ranges::all_of(x, [](float each) { return each == 0.0f; }))
            std::ranges::fill(y, 0.0f);
        else
            multiplyPanels(std::span(pieceInverses_).subspan(at, kPieceRows), x, y, 0, kPiecePanels);
    }
}

} // namespace filasofia::linalg

#include "filasofia/linalg/small_pieces.h"

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

SmallPieces::SmallPieces(std::vector<PanelRow> inverses, std::span<const char> freePieces, int latticeNodes)
    : inverses_(std::move(inverses)), freePieces_(freePieces.begin(), freePieces.end()),
      firstNode_(firstPieceNode(latticeNodes))
{
}

void SmallPieces::followRigidMotions(const CoarseInterpolation& interpolation, const PieceMotion& motion)
{
    struct Point {
        int at;      ///< its place in the piece
        Vec3 arm;    ///< [m] from the centre of mass
        Mat3 toRest; ///< R^T
        double mass;
    };
    std::vector<Point> points;
    for (std::size_t p = 0; p < freePieces_.size(); ++p) {
        if (freePieces_[p] == 0) continue;
        points.clear();
        double mass = 0.0;
        Vec3 centre;
        for (int i = 0; i < kPieceNodes; ++i) {
            const int node = interpolation.firstNode(static_cast<std::size_t>(firstNode_ + i) + p * kPieceNodes);
            if (node < 0) continue;
            const float* at = motion.x[node];
            points.push_back({i,
                              {at[0], at[1], at[2]},
                              transpose(rotationAt(motion.rotations, node)),
                              motion.masses[static_cast<std::size_t>(node)]});
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
        const bool solid = determinant(inertia) > 1e-6 * size * size * size; // else all in a point or on a line
        const Mat3 inverseInertia = solid ? inverse(inertia) : Mat3{};
        PanelRow* panels = inverses_.data() + p * kPieceRows;
        for (const Point& a : points)
            for (const Point& b : points) {
                const Mat3 moved = 1.0 / motion.massWeight *
                                   (1.0 / mass * Mat3::identity() +
                                    transpose(crossMatrix(a.arm)) * inverseInertia * crossMatrix(b.arm));
                writeBlock(panels, a.at, b.at, a.toRest * moved * transpose(b.toRest));
            }
    }
}

void SmallPieces::solve(std::span<const float> x, std::span<float> y) const
{
    const std::size_t first = 3 * static_cast<std::size_t>(firstNode_);
    for (std::size_t at = 0; at < inverses_.size(); at += kPieceRows) {
        const std::size_t from = first + at / kPieceRows * kPieceUnknowns;
        const auto in = x.subspan(from, kPieceUnknowns);
        const auto out = y.subspan(from, kPieceUnknowns);
        if (std::ranges::all_of(in, [](float each) { return each == 0.0f; }))
            std::ranges::fill(out, 0.0f);
        else
            multiplyPanels(std::span(inverses_).subspan(at, kPieceRows), in, out, 0, kPiecePanels);
    }
}

} // namespace filasofia::linalg

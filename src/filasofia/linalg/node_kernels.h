#pragma once

#include "filasofia/linalg/lists.h"
#include "filasofia/linalg/node_array.h"

#include <span>
#include <string>
#include <vector>

/// The inner loops over nodes. They are vectorised (Highway), for the best instruction set of the machine, which is
/// chosen at run time; every instruction set with fused multiply-add gives the same bits. Sums are computed per part of
/// a loop, lane by lane, and then over the sixteen lanes in double.
namespace filasofia::linalg {

/// a . b
double dot(const NodeArray& a, const NodeArray& b, Blocks blocks);

/// p = z + beta p
void updateDirection(const NodeArray& z, float beta, NodeArray& p, Blocks blocks);

/// x += alpha p, r -= alpha q; returns r . r
double stepAlong(float alpha, const NodeArray& p, const NodeArray& q, NodeArray& x, NodeArray& r, Blocks blocks);

/// A node and its weight in the sum of a coarse node.
struct RestrictionEntry {
    int node = 0;
    float weight = 0.0f;
    friend bool operator==(const RestrictionEntry&, const RestrictionEntry&) = default;
};
/// The transpose of an interpolation: a list of nodes per coarse node.
using Restriction = Lists<RestrictionEntry>;

/// coarse = P^T s for the coarse nodes [begin, end), packed x y z.
void restrictTo(const Restriction& restriction, const NodeArray& s, std::span<float> coarse, int begin, int end);

/// One row of a panel. A dense symmetric matrix is stored in panels of sixteen columns: panel k holds columns 16 k to
/// 16 k + 15 of every row.
struct alignas(64) PanelRow {
    float values[kBlock];
};
/// y = A x for the panels [begin, end). The size of x is the number of rows, a multiple of four.
void multiplyPanels(std::span<const PanelRow> panels, std::span<const float> x, std::span<float> y, int begin, int end);

constexpr int kVectorsPerPass = 6; ///< vectors that are multiplied in one pass over a dense matrix
/// How several vectors lie in memory, the inputs X and the results Y.
struct VectorBatch {
    int count = 0;        ///< vectors
    int rows = 0;         ///< rows of the matrix: it reads so many numbers of each input
    int stride = 0;       ///< from one input to the next
    int resultStride = 0; ///< from one result to the next
};
/// Y = A X for several vectors.
void multiplyPanels(std::span<const PanelRow> panels, std::span<const float> x, std::span<float> y,
                    const VectorBatch& vectors, int panelCount);

/// Per node: where the vectors of the element corners around it lie, in floats.
using Gather = Lists<int>;

/// What is added up at each node: the vectors of the corners around it, and a diagonal matrix.
///
///     c = sum of the node's corners,   d = massWeight * masses + extra
struct NodeTerms {
    const Gather& gather;
    std::span<const float> corners;
    float massWeight = 0.0f;
    std::span<const float> masses; ///< per node
    std::span<const float> extra;  ///< per node
};

/// y = c + d p; returns p . y
double gatherAndAdd(const NodeTerms& terms, const NodeArray& p, NodeArray& y, Blocks blocks);

/// y = y + c - d p; returns y . y
double gatherForces(const NodeTerms& terms, const NodeArray& p, NodeArray& y, Blocks blocks);

/// Sums over the nodes by which the end of a step is judged.
///
///     w = v + dv  new velocities     r      residual of the system
///     M           lumped masses      carry  the impulse that was carried into its right-hand side
struct StepWork {
    double work = 0.0;   ///< (r - carry) . w
    double change = 0.0; ///< dv . M dv
    double motion = 0.0; ///< w . M w
};
StepWork stepWork(std::span<const float> masses, const NodeArray& v, const NodeArray& dv, const NodeArray& r,
                  const NodeArray& carry, Blocks blocks);

/// The names of the instruction sets that this machine can run, the best first. While useSimdTarget() has chosen one,
/// only that one.
std::vector<std::string> simdTargets();
std::string simdTarget(); ///< the one in use
/// Uses one of them by its name; an empty name restores the best. An unknown name is an Error. For tests and
/// measurements; must not be called during a step.
void useSimdTarget(const std::string& name);

} // namespace filasofia::linalg

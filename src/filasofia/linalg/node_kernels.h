#pragma once

#include "filasofia/linalg/lists.h"
#include "filasofia/linalg/node_array.h"

#include <span>
#include <string>
#include <vector>

/// The inner loops over nodes. Vectorised (Highway), chosen when the program runs; the same bits on every instruction
/// set with fused multiply-add. Sums are made per part, lane by lane and then over the sixteen lanes in double.
namespace filasofia::linalg {

/// a . b
double dot(const NodeArray& a, const NodeArray& b, Blocks blocks);

/// p = z + beta p
void turn(const NodeArray& z, float beta, NodeArray& p, Blocks blocks);

/// x += alpha p, r -= alpha q; returns r . r
double descend(float alpha, const NodeArray& p, const NodeArray& q, NodeArray& x, NodeArray& r, Blocks blocks);

/// What a node gives to a coarse one.
struct RestrictionEntry {
    int node = 0;
    float weight = 0.0f;
    friend bool operator==(const RestrictionEntry&, const RestrictionEntry&) = default;
};
/// The transpose of an interpolation, by coarse nodes.
using Restriction = Lists<RestrictionEntry>;

/// Sums s into coarse nodes [begin, end), packed.
void restrictTo(const Restriction& restriction, const NodeArray& s, std::span<float> coarse, int begin, int end);

/// A dense symmetric matrix in panels of sixteen columns: panel k holds columns 16 k ... 16 k + 15 of every row.
struct alignas(64) PanelRow {
    float values[kBlock];
};
/// y = A x for the panels [begin, end).
void multiplyPanels(std::span<const PanelRow> panels, std::span<const float> x, std::span<float> y, int begin, int end);

constexpr int kTogether = 6; ///< vectors for which a dense matrix passes by once
/// How vectors follow each other, and how much of each a matrix takes and gives.
struct VectorRows {
    int count = 0;        ///< of vectors
    int rows = 0;         ///< numbers of each in X that the matrix has rows for
    int stride = 0;       ///< from one vector to the next, in X
    int answerStride = 0; ///< in Y
};
/// Y = A X for several vectors.
void multiplyPanels(std::span<const PanelRow> panels, std::span<const float> x, std::span<float> y,
                    const VectorRows& vectors, int panelCount);

/// What a node gathers: the places of its corners' vectors, in floats.
using Gather = Lists<int>;

/// y = sum of the node's corners + (scale * masses + extra) p; returns p . y. `masses` and `extra` per node.
double gatherAndAdd(const Gather& gather, std::span<const float> corners, float scale, std::span<const float> masses,
                    std::span<const float> extra, const NodeArray& p, NodeArray& y, Blocks blocks);

/// y = y + sum of the node's corners - (scale * masses + extra) p; returns y . y
double gatherForces(const Gather& gather, std::span<const float> corners, float scale, std::span<const float> masses,
                    std::span<const float> extra, const NodeArray& p, NodeArray& y, Blocks blocks);

/// What the end of a step is judged by: new velocities v + dv, and a residual r of a system that was given an extra
/// push.
struct StepWork {
    double work = 0.0;   ///< (r - push) . w, w = v + dv
    double change = 0.0; ///< dv . M dv
    double motion = 0.0; ///< w . M w
};
StepWork stepWork(std::span<const float> masses, const NodeArray& v, const NodeArray& dv, const NodeArray& r,
                  const NodeArray& push, Blocks blocks);

/// The names of the instruction sets that this machine can run, the best first (only the one chosen by useSimdTarget,
/// while it is), and the one in use.
std::vector<std::string> simdTargets();
std::string simdTarget();
/// Uses another one of them; an empty name: the best again; an Error for an unknown one. For tests and measurements;
/// not while a step is made.
void useSimdTarget(const std::string& name);

} // namespace filasofia::linalg

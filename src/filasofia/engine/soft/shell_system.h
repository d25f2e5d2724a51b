#pragma once

#include "filasofia/engine/body/shell.h"
#include "filasofia/engine/elastic/shell_blocks.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/linalg/node_kernels.h"

#include <functional>

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// A number in the solver's precision.
constexpr float asFloat(double value) { return static_cast<float>(value); }

/// The triangles of a shell in the form of the default solver: the part of MatrixFreeSystem that shells alone have.
class ShellSystem {
public:
    ShellSystem() = default;
    /// `rest` [m] and `slotOf`: per node of the model, its place at rest and its slot. `scale` [1/kg]: factor on all
    /// stiffnesses. `grows`: keeps room for the triangles of cuts.
    ShellSystem(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf, double scale, bool grows);

    [[nodiscard]] bool empty() const { return membranes_.empty(); }
    /// Number of groups of sixteen corners that the triangles write: those of membranes with their room, then those of
    /// bends.
    [[nodiscard]] std::size_t groups() const { return 3 * membranes_.size() + 6 * bends_.size(); }
    [[nodiscard]] std::size_t membraneGroups() const { return 3 * membranes_.size(); }
    /// Number of groups of sixteen rotations.
    [[nodiscard]] std::size_t rotationGroups() const { return membranes_.size(); }

    /// Calls add(node, group, lane) for each corner of each triangle, and turn(node, group, lane) for the rotations
    /// around each node.
    using Add = std::function<void(int node, std::size_t group, int lane)>;
    void forEachCorner(const Shell& shell, const Add& add, const Add& turn) const;

    /// What a node gathers: its corners of triangles, and the rotations of some of them.
    struct Around {
        linalg::Gather& corners;
        linalg::Gather& turns;
        std::size_t mostTurns; ///< per node
        int freeNodes;         ///< slots below have lists
    };
    /// True if the triangles of a shell that was cut fit into the room.
    [[nodiscard]] bool hasRoomFor(const Shell& shell) const;
    /// Writes these triangles again after an edit, ascending; new ones are appended.
    void edit(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf,
              std::span<const int> triangles, const Around& around);
    /// The sum of the triangles' blocks of a node in the step's matrix, at rest. `corners`: what the node gathers.
    [[nodiscard]] Mat3 diagonalAtRest(const Shell& shell, std::span<const Vec3> rest, ImplicitWeights weights,
                                      std::span<const int> corners) const;

    /// Adds to `blocks`, one per free slot, those of each triangle on the diagonal of the step's matrix, as update()
    /// left it.
    void addDiagonal(std::span<Mat3> blocks) const;

    /// As updateElements() and multiplyElements(), for all triangles. `corners`: those of groups().
    void update(const BlockInput& input, std::span<float> corners, std::span<float> quaternions, WorkerPool& pool);
    void multiply(const linalg::NodeArray& p, std::span<float> corners, WorkerPool& pool) const;

    /// True if float can represent all numbers of a shell. `perStiffness`: the weight of stiffness in the scaled
    /// matrix.
    static bool fits(const Shell& shell, double perStiffness);

private:
    void writeMembrane(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf, std::size_t lane);
    void writeBend(const Shell& shell, std::span<const int> slotOf, std::size_t lane);
    void moveCorner(int before, int after, std::size_t group, std::size_t lane, const Around& around) const;
    void moveTurn(int before, int after, std::size_t lane, const Around& around) const;

    double scale_ = 1.0;    ///< [1/kg]
    std::size_t used_ = 0;  ///< blocks of membranes that have triangles; the others are room
    std::size_t count_ = 0; ///< triangles
    std::vector<MembraneBlock> membranes_;
    std::vector<MembraneTangentBlock> membraneTangents_;
    std::vector<BendingBlock> bends_;
    std::vector<BendingTangentBlock> bendingTangents_;
};

} // namespace filasofia::engine

#pragma once

#include "filasofia/engine/body/shell.h"
#include "filasofia/engine/elastic/shell_blocks.h"

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
    /// stiffnesses.
    ShellSystem(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf, double scale);

    [[nodiscard]] bool empty() const { return membranes_.empty(); }
    /// Number of groups of sixteen corners that the triangles write.
    [[nodiscard]] std::size_t groups() const { return 3 * membranes_.size() + 6 * bends_.size(); }
    /// Number of groups of sixteen rotations.
    [[nodiscard]] std::size_t rotationGroups() const { return membranes_.size(); }

    /// Calls add(node, group, lane) for each corner of each triangle, and turn(node, group, lane) for the rotations
    /// around each node.
    using Add = std::function<void(int node, std::size_t group, int lane)>;
    static void forEachCorner(const Shell& shell, const Add& add, const Add& turn);

    /// As updateElements() and multiplyElements(), for all triangles. `corners`: those of groups().
    void update(const BlockInput& input, std::span<float> corners, std::span<float> quaternions, WorkerPool& pool);
    void multiply(const linalg::NodeArray& p, std::span<float> corners, WorkerPool& pool) const;

    /// True if float can represent all numbers of a shell. `perStiffness`: the weight of stiffness in the scaled
    /// matrix.
    static bool fits(const Shell& shell, double perStiffness);

private:
    std::vector<MembraneBlock> membranes_;
    std::vector<MembraneTangentBlock> membraneTangents_;
    std::vector<BendingBlock> bends_;
    std::vector<BendingTangentBlock> bendingTangents_;
};

} // namespace filasofia::engine

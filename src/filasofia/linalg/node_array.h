#pragma once

#include <cstddef>
#include <vector>

/// The memory layout of vectors over nodes in fast loops: x y z 0 of each node in floats, sixteen nodes to a block.
namespace filasofia::linalg {

constexpr int kBlock = 16; ///< nodes or elements side by side, however many lanes the machine has

struct alignas(64) NodeBlock {
    float values[kBlock][4] = {};
};

/// A vector over nodes, zero at first.
class NodeArray {
public:
    NodeArray() = default;
    /// `unknown` blocks of nodes that are solved for; behind them `pinned` ones, which elements read as well.
    explicit NodeArray(int unknown, int pinned = 0)
        : unknown_(unknown), blocks_(static_cast<std::size_t>(unknown) + static_cast<std::size_t>(pinned))
    {
    }

    [[nodiscard]] int blocks() const { return unknown_; } ///< without the pinned ones
    [[nodiscard]] int pinnedBlocks() const { return static_cast<int>(blocks_.size()) - unknown_; }
    [[nodiscard]] float* data() { return blocks_.empty() ? nullptr : blocks_.data()->values[0]; }
    [[nodiscard]] const float* data() const { return blocks_.empty() ? nullptr : blocks_.data()->values[0]; }
    [[nodiscard]] float* operator[](int node) { return data() + 4 * static_cast<std::ptrdiff_t>(node); }
    [[nodiscard]] const float* operator[](int node) const { return data() + 4 * static_cast<std::ptrdiff_t>(node); }

    void setZero() { blocks_.assign(blocks_.size(), {}); }

private:
    int unknown_ = 0;
    std::vector<NodeBlock> blocks_;
};

constexpr int blocksFor(int count) { return (count + kBlock - 1) / kBlock; }

/// Where lane l of a group of sixteen vectors of four floats lies: in the order in which a transposition in registers
/// leaves them.
constexpr int laneOffset(int lane) { return (lane % 4) * kBlock + (lane / 4) * 4; }

/// The range of blocks [begin, end).
struct Blocks {
    int begin = 0;
    int end = 0;
};
/// How a loop over blocks is divided. The parts are the same for every number of threads.
struct Parts {
    int total = 0; ///< blocks
    int size = 1;  ///< blocks per part
    [[nodiscard]] int count() const { return (total + size - 1) / size; }
    [[nodiscard]] Blocks operator[](int part) const
    {
        return {part * size, (part + 1) * size < total ? (part + 1) * size : total};
    }
};

} // namespace filasofia::linalg

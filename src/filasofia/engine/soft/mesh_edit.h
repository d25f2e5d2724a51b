#pragma once

#include <vector>

namespace filasofia::engine {

/// The changes that an edit made to a body's nodes and elements; the model is up to date already.
struct MeshEdit {
    /// A new node, interpolated from its parents: (1 - share) of the first and share of the second. A copy has the same
    /// parent twice.
    struct Node {
        int first = 0, second = 0; ///< nodes that existed before this one
        double share = 0.0;        ///< [-], in [0, 1]
    };
    std::vector<Node> nodes;   ///< appended to the existing nodes, in this order
    std::vector<int> elements; ///< changed or appended, ascending, each once
    std::vector<int> reached;  ///< the nodes of these elements before and after the edit, ascending
};

} // namespace filasofia::engine

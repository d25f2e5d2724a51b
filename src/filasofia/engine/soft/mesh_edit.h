#pragma once

#include <vector>

namespace filasofia::engine {

/// What an edit did to a body's nodes and elements, once the model has it already.
struct MeshEdit {
    /// A node that came: what it has of its parents is (1 - share) of the first and share of the second. A copy has one
    /// parent twice.
    struct Node {
        int first = 0, second = 0; ///< nodes that were there before this one
        double share = 0.0;        ///< [-], in [0, 1]
    };
    std::vector<Node> nodes;   ///< appended to those that were there, in this order
    std::vector<int> elements; ///< changed or appended, ascending, each once
    std::vector<int> reached;  ///< the nodes of these before and after, ascending
};

} // namespace filasofia::engine

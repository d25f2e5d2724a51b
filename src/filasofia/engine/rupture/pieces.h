#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <vector>

namespace filasofia::engine {

/// A piece that an edit set free.
struct DetachedPiece {
    int id = 0;                  ///< 1, 2, ... in the order in which they came free; never used again
    int from = 0;                ///< the piece that it was part of
    std::vector<int> tetrahedra; ///< ascending
};

/// The pieces that a body has fallen into. Each keeps its id: where one falls apart, the largest part by volume at rest
/// keeps the id (of equals the one with the lowest element), and the others get new ones. The whole begins as 0, and
/// what is in several pieces from the start counts from there by its lowest elements.
class Pieces {
public:
    explicit Pieces(const MeshTopology& mesh);

    /// After every edit. Elements that came are of their parents' piece. Where faces were opened, a search from all of
    /// them that ends when they have met: only what comes loose costs a walk over all elements.
    std::vector<DetachedPiece> update(const MeshTopology& mesh, const frame::TopologyEdit& edit);
    /// The same by a walk over all elements.
    std::vector<DetachedPiece> walk(const MeshTopology& mesh, const frame::TopologyEdit& edit);

    [[nodiscard]] const std::vector<int>& ofTetrahedron() const { return ids_; }
    [[nodiscard]] int count() const { return count_; } ///< at present

private:
    void follow(const frame::TopologyEdit& edit);
    bool fallsApart(const MeshTopology& mesh, const frame::TopologyEdit& edit);
    std::vector<DetachedPiece> divide(const MeshTopology& mesh);

    std::vector<int> ids_;
    int next_ = 0, count_ = 0;
    std::vector<int> search_, reached_; ///< scratch: per element, the search that came by, -1 between them
};

/// Per tetrahedron, which of the parts that hang together by faces it is in, numbered by their lowest element.
std::vector<int> connectedParts(const MeshTopology& mesh, int& count);

} // namespace filasofia::engine

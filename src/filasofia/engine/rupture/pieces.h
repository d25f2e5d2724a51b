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

    /// After an edit. Costs a walk over all elements: to be asked when faces were opened.
    std::vector<DetachedPiece> update(const MeshTopology& mesh);

    [[nodiscard]] const std::vector<int>& ofTetrahedron() const { return ids_; }
    [[nodiscard]] int count() const { return count_; } ///< at present

private:
    std::vector<int> ids_;
    int next_ = 0, count_ = 0;
};

/// Per tetrahedron, which of the parts that hang together by faces it is in, numbered by their lowest element.
std::vector<int> connectedParts(const MeshTopology& mesh, int& count);

} // namespace filasofia::engine

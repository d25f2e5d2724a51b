#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// A piece that an edit detached.
struct DetachedPiece {
    int id = 0;                  ///< 1, 2, ... in the order of detachment; never reused
    int from = 0;                ///< the piece that it was part of
    std::vector<int> tetrahedra; ///< ascending
};

/// The connected pieces of a body. Each keeps its id. If a piece falls apart, the part with the largest volume at rest
/// keeps the id (among equals the one with the lowest element), and the others get new ones. A connected body starts as
/// piece 0. If a body starts as several pieces, they are numbered by their lowest elements.
class Pieces {
public:
    explicit Pieces(const MeshTopology& mesh);

    /// Call this after every edit. New elements belong to their parents' piece. If faces were opened, a search runs
    /// from all of them and ends when the searches have merged: only a piece that comes loose costs a pass over all
    /// elements.
    std::vector<DetachedPiece> update(const MeshTopology& mesh, const frame::TopologyEdit& edit);
    /// Gives the same result by a pass over all elements.
    std::vector<DetachedPiece> walk(const MeshTopology& mesh, const frame::TopologyEdit& edit);

    [[nodiscard]] const std::vector<int>& ofTetrahedron() const { return ids_; }
    [[nodiscard]] int count() const { return count_; } ///< current number

private:
    void follow(const frame::TopologyEdit& edit);
    bool fallsApart(const MeshTopology& mesh, const frame::TopologyEdit& edit);
    std::vector<DetachedPiece> divide(const MeshTopology& mesh);

    std::vector<int> ids_;
    int next_ = 0, count_ = 0;
    std::vector<int> search_, reached_; ///< scratch: per element, the search that reached it, -1 outside a call
};

/// A piece of a body, and where it is.
struct PiecePlace {
    int number = 0;
    std::size_t nodes = 0; ///< how many it has
    Vec3 now, rest;        ///< [m] where its first node is, and where it is at rest
};
/// Numbers of the pieces that are farther than `far` [m] from their places at rest: those with the fewest nodes first,
/// and number 0, the body itself, last. Something of a body stays: if all are that far, the last is not among them.
std::vector<int> piecesBeyond(double far, std::span<const PiecePlace> pieces);

/// Numbers the parts connected through faces by their lowest element, and returns each tetrahedron's part.
std::vector<int> connectedParts(const MeshTopology& mesh, int& count);

} // namespace filasofia::engine

#pragma once

#include "filasofia/engine/collision/edge_edge.h"
#include "filasofia/engine/collision/point_feature.h"
#include "filasofia/engine/collision/surface_pair.h"

namespace filasofia::engine {

/// What the points of two elements of a surface find on each other.
inline std::vector<PointMinimum> pointMinima(const SurfacePair& meeting, std::array<int, 2> pair)
{
    std::vector<PointMinimum> found;
    for (const int side : {0, 1})
        for (const int v : meeting.sides[0]->shape->elements[pair[side]].ownVertices)
            if (v >= 0) collidePoint(meeting, 0, v, pair[1 - side], found);
    return found;
}

/// The same of their edges.
inline std::vector<Proximity> edgesThatMeet(const SurfacePair& meeting, std::array<int, 2> pair)
{
    std::vector<Proximity> found;
    for (const int a : meeting.sides[0]->shape->elements[pair[0]].ownEdges)
        for (const int b : meeting.sides[0]->shape->elements[pair[1]].ownEdges)
            if (a >= 0 && b >= 0) collideEdges(meeting, a, b, found);
    return found;
}

} // namespace filasofia::engine

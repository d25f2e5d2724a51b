#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <string>
#include <vector>

namespace filasofia::engine {

enum class TopologyFault {
    BadIndex,        ///< a node or neighbour that there is not, or a list of the wrong length
    NotFinite,       ///< a position
    NotPositive,     ///< an element without volume at rest
    BadQuality,      ///< an element below the bound
    Volume,          ///< of the whole, at rest
    SharedFace,      ///< a face of more than two elements
    Overlap,         ///< two elements on the same side of a face
    Adjacency,       ///< neighbours that are none, or not both ways
    Masks,           ///< a face that is flagged, deferred or opened on one side or in the wrong place
    BoundaryEdge,    ///< an edge without exactly two boundary faces
    Orphan,          ///< a node without elements
    NodeList,        ///< a node's list of elements
    NodeFan,         ///< a node whose elements do not hang together by faces
    BoundaryVertex,  ///< a node with several loops of boundary
    MirrorElements,  ///< a mirror has other elements
    MirrorBoundary,  ///< a mirror has another boundary
    MirrorPositions, ///< a mirror has other positions
    count_
};
const char* name(TopologyFault fault);

struct TopologyViolation {
    TopologyFault fault;
    std::string where; ///< in words
};

struct TopologyBounds {
    double quality = 0.0;          ///< [-]
    double volume = 0.0;           ///< [m^3] what it should be
    double volumeTolerance = 1e-3; ///< [-]
    std::size_t maxViolations = 8; ///< then it stops
};

/// Everything rebuilt from the elements' nodes and the rest positions alone and held against what the mesh has.
std::vector<TopologyViolation> checkTopology(const MeshTopology& mesh, const TopologyBounds& bounds);

/// The mirror, and positions that followed its edits, against the mesh.
std::vector<TopologyViolation> checkMirror(const MeshTopology& mesh, const frame::TopologyMirror& mirror,
                                           const std::vector<Vec3>& positions);

/// All numbers of the mesh.
std::uint64_t hashOf(const MeshTopology& mesh);

} // namespace filasofia::engine

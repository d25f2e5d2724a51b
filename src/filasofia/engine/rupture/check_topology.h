#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <string>
#include <vector>

namespace filasofia::engine {

enum class TopologyFault {
    BadIndex,        ///< a node or neighbour that does not exist, or a list of the wrong length
    NotFinite,       ///< a position that is not finite
    NotPositive,     ///< an element whose volume at rest is not positive
    BadQuality,      ///< an element below the bound of quality
    Volume,          ///< the volume of the whole mesh at rest differs
    SharedFace,      ///< a face shared by more than two elements
    Overlap,         ///< two elements on the same side of a face
    Adjacency,       ///< listed neighbours share no face, or are listed on one side only
    Masks,           ///< a face is flagged, deferred or opened on one side only or in the wrong place
    BoundaryEdge,    ///< an edge of the boundary without exactly two boundary faces
    Orphan,          ///< a node without elements
    NodeList,        ///< a node's list of elements is wrong
    NodeFan,         ///< a node whose elements are not connected through faces
    BoundaryVertex,  ///< a node with several loops of boundary faces
    MirrorElements,  ///< a mirror has other elements
    MirrorBoundary,  ///< a mirror has another boundary
    MirrorPositions, ///< a mirror has other positions
    count_
};
const char* name(TopologyFault fault);

struct TopologyViolation {
    TopologyFault fault;
    std::string where; ///< the place in words
};

struct TopologyBounds {
    double quality = 0.0;          ///< [-]
    double volume = 0.0;           ///< [m^3] expected volume at rest
    double volumeTolerance = 1e-3; ///< [-] relative
    std::size_t maxViolations = 8; ///< the check stops after this many
};

/// Rebuilds the topology from the elements' nodes and the rest positions alone, and compares it with the mesh's data.
std::vector<TopologyViolation> checkTopology(const MeshTopology& mesh, const TopologyBounds& bounds);
/// The same for a sheet: an edge has one or two triangles, which face the same way, and a node one fan.
std::vector<TopologyViolation> checkSheetTopology(const MeshTopology& mesh, const TopologyBounds& bounds);

/// Compares the mirror, and positions that followed its edits, with the mesh.
std::vector<TopologyViolation> checkMirror(const MeshTopology& mesh, const frame::TopologyMirror& mirror,
                                           const std::vector<Vec3>& positions);

/// Checks the mesh of a body that may be cut: cuts keep the surface a manifold and the elements good only if they are
/// so at the start. Throws an Error that begins with `object`; warns of bad elements.
void checkForCuts(const std::string& object, const EditableMesh& mesh);

/// Hash of all numbers of the mesh.
std::uint64_t hashOf(const MeshTopology& mesh);

} // namespace filasofia::engine

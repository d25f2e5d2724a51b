#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/runtime/show.h"

#include <vector>

/// The picture of connective tissue: thin strands between the points of an attachment and what they are attached to.
namespace filasofia::runtime {

/// The triangles of so many strands, and vertices that are all in one place.
geometry::TriangleMesh strandMesh(int count, Vec3 place);

/// Appends to `vertices` those of the attachment's strands, in the order of strandMesh(). Returns the number of
/// strands. The strands of a point keep their places beside each other as long as it holds.
int writeStrands(const std::vector<frame::AttachedPoint>& points, AttachmentId attachment, const StrandsDef& def,
                 std::vector<Vec3>& vertices);

} // namespace filasofia::runtime

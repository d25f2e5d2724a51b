#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/mapping/map.h"

#include <memory>
#include <vector>

namespace filasofia::mapping {

/// A surface that was made for the skin of a body that may be cut, as of an organ in finer detail than its mesh, and
/// how it opens with the body: along the rim of what cuts have opened its triangles are divided, and each part rides on
/// the element behind its own side. A strip of skin joins it to the rim where it lies above.
class OpeningSurface {
public:
    /// `whole` follows the mesh `rest`, both in world coordinates. None where some vertex is farther from the mesh's
    /// boundary than one of its edges by mean, which is no skin.
    static std::shared_ptr<const OpeningSurface> make(std::shared_ptr<const MappedSurface> whole,
                                                      const geometry::TetMesh& rest);

    /// The surface as it is on a body with this boundary; parts of pieces that were removed are left out. Parts that
    /// no cut came near keep their map. A pure function, in the order of a millisecond per thousand triangles of both.
    [[nodiscard]] std::shared_ptr<const MappedSurface> on(const frame::Boundary& boundary) const;

private:
    struct Anchor {
        geometry::Triangle nodes = {}; ///< of the boundary as it was made, the smallest first
        double distance = 0.0;         ///< [m] to it
    };
    std::shared_ptr<const MappedSurface> whole_;
    geometry::Embedding embedding_; ///< of its vertices, where the map is another kind too
    std::vector<Anchor> anchors_;   ///< per vertex
};

} // namespace filasofia::mapping

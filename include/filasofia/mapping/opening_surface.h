#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/mapping/map.h"

#include <memory>
#include <vector>

namespace filasofia::mapping {

/// A surface made for the skin of a body that may be cut, such as an organ in finer detail than its mesh, and how it
/// opens with the body: its triangles are divided along the rim of what cuts have opened, and each part is embedded in
/// the elements behind its own side. If the surface lies above the rim, a strip of skin joins it to the rim.
class OpeningSurface {
public:
    /// `whole` follows the mesh `rest`, both in world coordinates. Returns null if some vertex is farther from the
    /// mesh's boundary than its mean edge length, because such a surface is not a skin.
    static std::shared_ptr<const OpeningSurface> make(std::shared_ptr<const MappedSurface> whole,
                                                      const geometry::TetMesh& rest);

    /// The surface on a body with this boundary; parts on pieces that were removed are left out. Parts far from all
    /// cuts keep their map. A pure function that takes on the order of a millisecond per thousand triangles of both.
    [[nodiscard]] std::shared_ptr<const MappedSurface> on(const frame::Boundary& boundary) const;

private:
    struct Anchor {
        geometry::Triangle nodes = {}; ///< nodes of a triangle of the original boundary, the smallest first
        double distance = 0.0;         ///< [m] distance to that triangle
    };
    std::shared_ptr<const MappedSurface> whole_;
    geometry::Embedding embedding_; ///< embedding of its vertices, even if the map is of another kind
    std::vector<Anchor> anchors_;   ///< per vertex
};

} // namespace filasofia::mapping

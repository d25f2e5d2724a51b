#pragma once

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace filasofia::surface {

/// Tetrahedra of a body's mesh of which the same share is denatured from now on.
struct HeatedPart {
    double share = 0.0;               ///< [-], in (0, 1], of their volume; one of a few levels
    std::vector<int> tetrahedra = {}; ///< ascending
};

/// Which tetrahedra lie in the layer that heat has changed. Tissue is as far denatured as the most denatured place of
/// the surface within the layer's depth, in front of which it does not lie. All places are those at rest. A plain
/// value: a copy saves it.
class HeatedTissue {
public:
    /// `mesh` is the body's before it is cut, its nodes in the world.
    HeatedTissue(std::shared_ptr<const geometry::TetMesh> mesh, double depth);

    /// The surface now: triangles by vertices, and per vertex its node, its place at rest [m], and the share of its
    /// collagen that is intact. Returns the tetrahedra that have reached a higher level, by levels.
    std::vector<HeatedPart> spread(std::span<const geometry::Triangle> triangles, std::span<const int> nodes,
                                   std::span<const Vec3> places, std::span<const double> intact);
    [[nodiscard]] const std::shared_ptr<const geometry::TetMesh>& mesh() const { return mesh_; }

private:
    static constexpr int kSamples = 20; ///< per tetrahedron, for equal parts of its volume
    struct Heated {
        std::array<float, kSamples> denatured{}; ///< [-]
        int level = 0;
    };
    void heat(const std::array<Vec3, 3>& corners, const std::array<double, 3>& denatured);
    [[nodiscard]] std::array<Vec3, kSamples> samplesOf(int tetrahedron) const;

    std::shared_ptr<const geometry::TetMesh> mesh_;
    std::shared_ptr<const geometry::Bvh> tetrahedra_;
    double depth_;
    std::vector<std::uint8_t> seen_; ///< per node, steps of its denaturation that have been spread
    std::map<int, Heated> heated_;   ///< by tetrahedra
    std::vector<int> found_;         ///< working memory, as the next
    std::vector<int> changed_;
};

} // namespace filasofia::surface

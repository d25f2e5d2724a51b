#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/visual/float3.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace filasofia::visual {

/// Loop subdivision of a triangle mesh: the topology is refined once, then any positions of its vertices are refined by
/// one sparse product. Boundaries stay boundaries.
class Subdivision {
public:
    /// Throws an Error naming `name` if the mesh is wrong (geometry::check), the level is outside [0, 3], or, from
    /// level 1 on, an edge belongs to more than two triangles or to two with opposite orientation.
    Subdivision(const geometry::TriangleMesh& mesh, int level, std::string_view name);
    ~Subdivision();
    Subdivision(Subdivision&&) noexcept;
    Subdivision& operator=(Subdivision&&) noexcept;

    [[nodiscard]] int controlCount() const { return controlCount_; }
    [[nodiscard]] int vertexCount() const { return vertexCount_; }
    /// Three refined vertices per refined triangle.
    [[nodiscard]] std::span<const std::uint32_t> indices() const { return indices_; }
    /// The positions of the refined vertices, or any other values of three floats. `control` has controlCount() of
    /// them.
    [[nodiscard]] std::vector<Float3> refine(std::span<const Float3> control) const;

private:
    struct Stencils;
    int controlCount_ = 0;
    int vertexCount_ = 0;
    std::vector<std::uint32_t> indices_;
    std::unique_ptr<Stencils> stencils_; ///< null at level 0
};

} // namespace filasofia::visual

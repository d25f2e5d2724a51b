#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/visual/float3.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace filasofia::visual {

/// Loop subdivision of a triangle mesh: the topology is refined once, then any positions of its vertices are refined by
/// one sparse product. Boundaries stay boundaries. Where the texture has a seam, refined vertices are drawn more than
/// once, with the texture coordinates of each side; normals know nothing of it.
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

    /// Three drawn vertices per refined triangle: the refined ones, and after them the copies of those on seams.
    [[nodiscard]] std::span<const std::uint32_t> drawnIndices() const { return copies_.empty() ? indices_ : drawn_; }
    /// Texture coordinates of the drawn vertices; empty if the mesh has none.
    [[nodiscard]] const std::vector<std::array<float, 2>>& uv() const { return uv_; }
    /// Appends to values of the refined vertices those of the copies.
    template <class T> void addCopies(std::vector<T>& values) const
    {
        values.reserve(values.size() + copies_.size());
        for (const std::uint32_t vertex : copies_) values.push_back(values[vertex]);
    }

private:
    struct Stencils;
    /// Texture coordinates that differ from corner to corner, each pair once for every vertex that has it.
    struct CornerUv;
    void refineUv(const geometry::TriangleMesh& mesh); ///< one pair per vertex
    void copySeams(std::span<const Float3> values, std::span<const int> ofCorners);

    int controlCount_ = 0;
    int vertexCount_ = 0;
    std::vector<std::uint32_t> indices_;
    std::vector<std::uint32_t> copies_; ///< the refined vertex that each copy is of
    std::vector<std::uint32_t> drawn_;
    std::vector<std::array<float, 2>> uv_;
    std::unique_ptr<Stencils> stencils_; ///< null at level 0
};

} // namespace filasofia::visual

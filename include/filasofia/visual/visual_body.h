#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/visual/material.h"
#include "filasofia/visual/prepared_mesh.h"
#include "filasofia/visual/transform.h"

#include <memory>
#include <span>

namespace filasofia::visual {

/// A surface to be drawn.
struct VisualBodyDef {
    std::string name = "body";
    geometry::TriangleMesh mesh = {};     ///< [m], at rest
    int subdivision = 0;                  ///< [-], in [0, 3], Loop subdivision steps, each with 4 times the triangles
    Material material = TissueMaterial{}; ///< what it looks like
    bool castShadows = true;
    int label = 0; ///< [-], in [0, 16777215], its number in depth images; a Simulation gives BodyId::value
};

constexpr auto fields(const VisualBodyDef*)
{
    using D = VisualBodyDef;
    return describe("VisualBodyDef", field("name", &D::name, "name in errors"),
                    field("mesh", &D::mesh, "surface at rest"),
                    field("subdivision", &D::subdivision, "-", closed(0, 3), "Loop subdivision steps"),
                    field("material", &D::material, "what it looks like"),
                    field("castShadows", &D::castShadows, "whether it casts shadows"),
                    field("label", &D::label, "-", closed(0, 16777215), "its number in depth images"));
}

/// The state of the surface at one vertex.
struct SurfaceState {
    double blood = 0.0;   ///< [-], in [0, 1]
    double burn = 0.0;    ///< [-], in [0, 1], charred by cautery
    double wetness = 0.0; ///< [-], in [0, 1], liquid in addition to the material's own

    friend constexpr bool operator==(const SurfaceState&, const SurfaceState&) = default;
};

constexpr auto fields(const SurfaceState*)
{
    using S = SurfaceState;
    return describe("SurfaceState", field("blood", &S::blood, "-", closed(0, 1), "covered by blood"),
                    field("burn", &S::burn, "-", closed(0, 1), "charred by cautery"),
                    field("wetness", &S::wetness, "-", closed(0, 1), "liquid on top of the material's own"));
}

/// A surface drawn by a VisualServer; made by VisualServer::add. Main thread only.
class VisualBody final : public Transform {
public:
    struct Impl;
    VisualBody(std::string name, std::unique_ptr<Impl> impl);
    ~VisualBody() override;

    /// Number of vertices of the mesh before subdivision.
    [[nodiscard]] int vertexCount() const;
    /// The last given positions [m], in the body's own coordinates.
    [[nodiscard]] std::span<const Vec3> vertices() const;
    /// The triangles of the mesh before subdivision.
    [[nodiscard]] std::span<const geometry::Triangle> triangles() const;

    /// Sets new positions [m] of the mesh's vertices, in the body's own coordinates; normals and bounds follow. Throws
    /// an Error naming the body unless there is one finite position (below 1e6 m) per vertex; the old shape then stays.
    void setVertices(std::span<const Vec3> positions);

    /// Sets new triangles, as after a cut: `mesh.vertices` are the present positions, `rest` the positions at rest to
    /// which the pattern is fixed, one per vertex. Surface state, seam and heat are reset. Throws an Error naming the
    /// body if mesh or rest are wrong; the old shape then stays.
    void setMesh(const geometry::TriangleMesh& mesh, std::span<const Vec3> rest);
    /// The fast part of setMesh(): adopts new triangles that another thread has prepared, at the positions `now`.
    /// Throws an Error naming the body if the positions are wrong; the old shape then stays.
    void adopt(PreparedMesh prepared, std::span<const Vec3> now);

    /// One state per vertex. Throws an Error naming the body if the count or a number is wrong.
    void setSurfaceState(std::span<const SurfaceState> states);
    /// Marks the rim of what was cut: 1 for each vertex on it, 0 elsewhere. Along edges between two such vertices
    /// tissue, mucosa and bone show a thin dark line, also while the cut is closed. Throws an Error naming the body if
    /// the count is wrong.
    void setSeam(std::span<const std::uint8_t> onSeam);
    /// How far heat has gone at each vertex [-], in [-1, 3]: -1 cold, 0 where tissue begins to be damaged, 9/7 boiling,
    /// 16/7 dry. The picture decides between the vertices what is blanched and charred, so that a burn is round where
    /// triangles are large. Throws an Error naming the body if the count or a number is wrong.
    void setHeat(std::span<const float> levels);

    [[nodiscard]] const Material& material() const;
    /// Throws an Error naming the body and the field that is out of range, the file that cannot be read, or the
    /// material or view that the server does not have.
    void setMaterial(const Material& material);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual

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
    int subdivision = 0;                  ///< [-], in [0, 3]: Loop subdivision steps, each times 4 triangles
    Material material = TissueMaterial{}; ///< what it looks like
    bool castShadows = true;
};

constexpr auto fields(const VisualBodyDef*)
{
    using D = VisualBodyDef;
    return describe("VisualBodyDef", field("name", &D::name, "name in errors"),
                    field("mesh", &D::mesh, "surface at rest"),
                    field("subdivision", &D::subdivision, "-", closed(0, 3), "Loop subdivision steps"),
                    field("material", &D::material, "what it looks like"),
                    field("castShadows", &D::castShadows, "whether it throws shadows"));
}

/// What has happened to the surface at one vertex.
struct SurfaceState {
    double blood = 0.0;   ///< [-], in [0, 1]
    double burn = 0.0;    ///< [-], in [0, 1], charred by cautery
    double wetness = 0.0; ///< [-], in [0, 1], liquid on top of the material's own

    friend constexpr bool operator==(const SurfaceState&, const SurfaceState&) = default;
};

constexpr auto fields(const SurfaceState*)
{
    using S = SurfaceState;
    return describe("SurfaceState", field("blood", &S::blood, "-", closed(0, 1), "share of full"),
                    field("burn", &S::burn, "-", closed(0, 1), "charred by cautery"),
                    field("wetness", &S::wetness, "-", closed(0, 1), "liquid on top of the material's own"));
}

/// A surface that a VisualServer draws; made by VisualServer::add. Main thread only.
class VisualBody final : public Transform {
public:
    struct Impl;
    VisualBody(std::string name, std::unique_ptr<Impl> impl);
    ~VisualBody() override;

    /// Vertices of the mesh before subdivision.
    [[nodiscard]] int vertexCount() const;
    /// The last positions given [m], in the body's own coordinates.
    [[nodiscard]] std::span<const Vec3> vertices() const;
    /// The triangles of the mesh before subdivision.
    [[nodiscard]] std::span<const geometry::Triangle> triangles() const;

    /// New positions [m] of the mesh's vertices, in the body's own coordinates; normals and bounds follow. Throws an
    /// Error naming the body unless there is one finite position (below 1e6 m) for each vertex; the old shape then
    /// stays.
    void setVertices(std::span<const Vec3> positions);

    /// New triangles, as after a cut: `mesh.vertices` are the positions now, `rest` the positions at rest that the
    /// pattern sticks to, one for each vertex. The surface state starts anew. Throws an Error naming the body when mesh
    /// or rest are wrong; the old shape then stays.
    void setMesh(const geometry::TriangleMesh& mesh, std::span<const Vec3> rest);
    /// The short part of setMesh(): new triangles that another thread has prepared, at the positions `now`. Throws an
    /// Error naming the body when the positions are wrong; the old shape then stays.
    void adopt(PreparedMesh prepared, std::span<const Vec3> now);

    /// One for each vertex. Throws an Error naming the body when the count or a number is wrong.
    void setSurfaceState(std::span<const SurfaceState> states);

    [[nodiscard]] const Material& material() const;
    /// Throws an Error naming the body, and the field that is out of range, the file that cannot be read, or what the
    /// server has not.
    void setMaterial(const Material& material);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual

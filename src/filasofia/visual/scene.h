#pragma once

#include "filasofia/core/assert.h"
#include "filasofia/visual/prepared_mesh.h"
#include "filasofia/visual/render_backend.h"
#include "filasofia/visual/stage_watch.h"
#include "filasofia/visual/subdivision.h"

#include <thread>

namespace filasofia::visual {

/// What a server shares with its entities.
struct Scene {
    std::unique_ptr<RenderBackend> backend;
    std::thread::id thread = std::this_thread::get_id();
    std::vector<const LightDef*> lights; ///< of all lights, to hold new ones against the library's limits
    long vertexUpdates = 0;
    StageWatch watch;

    /// The graphics library's objects belong to the thread that made them.
    void assertThread() const { FILASOFIA_ASSERT(std::this_thread::get_id() == thread); }
};

struct VisualBody::Impl {
    Scene& scene;
    Slot slot;
    VisualBodyDef def; ///< its mesh is the current one: positions as last given
    Subdivision subdivision;
    bool visible = true;
    std::vector<Float3> control = {}; ///< kept from frame to frame: what setVertices() computes with
    std::vector<Float3> normals = {};

    /// Takes the positions of the mesh's vertices; what is drawn of them.
    VertexData deform(std::span<const Vec3> positions);
};

struct PreparedMesh::Impl {
    geometry::TriangleMesh rest;
    Subdivision subdivision;
    BodyGeometry geometry; ///< at rest
};

struct Light::Impl {
    Scene& scene;
    Slot slot;
    LightDef def;
};

struct Camera::Impl {
    Scene& scene;
    Slot slot;
    CameraDef def;
};

struct View::Impl {
    Scene& scene;
    Slot slot;
    ViewDef def;
    Camera* camera;
};

/// Throw an Error naming the object when the Def is wrong, alone or beside what the scene holds.
void check(const LightDef& def, const Scene& scene, const LightDef* replaced);
void check(const CameraDef& def);
void check(const ViewDef& def);
void check(const EnvironmentDef& def);
/// Material and positions; the mesh's triangles are checked by Subdivision.
void check(const VisualBodyDef& def);
void checkPositions(std::span<const Vec3> positions, std::size_t count, std::string_view body);

/// The surface that `rest` and `now` (both before subdivision) give.
BodyGeometry bodyGeometry(const Subdivision& subdivision, std::span<const Vec3> rest, std::span<const Vec3> now);

} // namespace filasofia::visual

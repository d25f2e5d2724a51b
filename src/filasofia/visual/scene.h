#pragma once

#include "filasofia/core/assert.h"
#include "filasofia/visual/material_store.h"
#include "filasofia/visual/prepared_mesh.h"
#include "filasofia/visual/render_backend.h"
#include "filasofia/visual/stage_watch.h"
#include "filasofia/visual/subdivision.h"

#include <thread>

namespace filasofia::visual {

/// Filament 1.9 keeps its handles in a fixed arena, and the process ends when that is full: about 10,900 handles of the
/// size of buffers, of which a body takes seven. (Measured: 1,650 bodies and nothing else.)
constexpr std::size_t kMaxBodies = 1400;

/// What a server shares with its entities.
struct Scene {
    std::unique_ptr<RenderBackend> backend;
    std::thread::id thread = std::this_thread::get_id();
    MaterialStore materials;
    std::vector<VisualBody*> bodies; ///< all, in the order in which they were made, like the next three
    std::vector<Light*> lights;
    std::vector<Camera*> cameras;
    std::vector<View*> views;
    long vertexUpdates = 0;
    StageWatch watch;

    /// The graphics library's objects belong to the thread that made them.
    void assertThread() const { FILASOFIA_ASSERT(std::this_thread::get_id() == thread); }
};

struct VisualBody::Impl {
    Scene& scene;
    Slot slot;
    VisualBodyDef def; ///< its mesh has the positions given last
    Subdivision subdivision;
    bool tangents = false;            ///< the material needs frames along the uv
    std::vector<Float3> control = {}; ///< kept from frame to frame: what setVertices() computes with
    std::vector<Float3> normals = {};
    std::vector<TangentSum> tangentSums = {};
    std::vector<PackedState> states = {}; ///< after subdivision; empty: none was set since the last new triangles

    /// Takes the positions of the mesh's vertices and returns what is drawn of them.
    VertexData deform(std::span<const Vec3> positions);
    /// Sends the states with some numbers of each vertex replaced: `count` of PackedState from the `first`, by those of
    /// the mesh's vertices in [0, 1].
    void putStates(std::span<const Float3> shares, std::size_t first, std::size_t count);
    /// Sends a material to the backend, and the frames that it needs.
    void look(const ReadyMaterial& material);
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
    bool visible = true;
};

/// Passes pose, scale and visibility of everything to the backend.
void sendPlaces(Scene& scene);

/// Throw an Error naming the object if the Def is wrong, alone or together with the scene.
void check(const LightDef& def, const Scene& scene, const LightDef* replaced);
void check(const CameraDef& def);
void check(const ViewDef& def, const Scene& scene, const ViewDef* replaced);
void check(const EnvironmentDef& def);
/// Checks numbers and positions; Subdivision checks the mesh's triangles, readyMaterial the material.
void check(const VisualBodyDef& def);
/// Reads the files that the material names. Throws an Error naming the body if anything is wrong, an off-screen view
/// does not exist, or the mesh has no uv for its textures.
ReadyMaterial readyMaterial(Scene& scene, const Material& material, const geometry::TriangleMesh& mesh,
                            std::string_view body);
/// The same of the pool's material `pool` with the body's overrides.
ReadyMaterial readyMaterial(Scene& scene, const Material& pool, const NamedMaterial& named,
                            const geometry::TriangleMesh& mesh, std::string_view body);
/// Gives the bodies that show off-screen views their materials again, after such a view has come, changed or gone.
void refreshViewPictures(Scene& scene);
void checkPositions(std::span<const Vec3> positions, std::size_t count, std::string_view body);

/// The pool of materials; see VisualServer.
void addMaterial(Scene& scene, const std::string& name, const Material& material);
void changeMaterial(Scene& scene, const std::string& name, const Material& material);
void removeMaterial(Scene& scene, const std::string& name);

/// The surface given by `rest` and `now`, both before subdivision.
BodyGeometry bodyGeometry(const Subdivision& subdivision, std::span<const Vec3> rest, std::span<const Vec3> now);

} // namespace filasofia::visual

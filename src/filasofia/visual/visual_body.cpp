#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/visual/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::visual {
namespace {

// Bounds of a million metres keep every square and product of the graphics library finite in float.
constexpr double kFarthest = 1e6;

std::vector<Float3> toFloats(std::span<const Vec3> positions)
{
    std::vector<Float3> floats(positions.size());
    std::transform(positions.begin(), positions.end(), floats.begin(), toFloat3);
    return floats;
}

std::string bodyName(std::string_view name) { return text("body '", name, "'"); }
std::string materialName(std::string_view body) { return text(bodyName(body), ": material"); }

/// Throws an Error unless the scene has the views and the mesh the uv that the material shows.
void checkFits(const Scene& scene, const ReadyMaterial& ready, const geometry::TriangleMesh& mesh,
               std::string_view body)
{
    for (const std::string& view : ready.views)
        if (std::none_of(scene.views.begin(), scene.views.end(), [&](View* each) {
                return each->def().name == view && std::holds_alternative<OffScreen>(each->def().target);
            }))
            fail(materialName(body), ": there is no off-screen view '", view, "'");
    if (!ready.needsUv.empty() && mesh.uv.empty())
        fail(materialName(body), ": ", ready.needsUv, " needs texture coordinates, but the mesh has no uv");
}

void checkCount(const VisualBody& body, std::size_t count, std::string_view what)
{
    if (count == std::size_t(body.vertexCount())) return;
    fail(bodyName(body.name()), ": needs one ", what, " for each of its ", body.vertexCount(), " vertices, got ",
         count);
}

} // namespace

void checkPositions(std::span<const Vec3> positions, std::size_t count, std::string_view body)
{
    if (positions.size() != count)
        fail(bodyName(body), ": needs one position for each of its ", count, " vertices, got ", positions.size());
    for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k)
            if (!(std::abs(positions[i][k]) < kFarthest))
                fail(bodyName(body), ": the position of vertex ", i, " must be finite and nearer than ", kFarthest,
                     " m, got ", positions[i][k]);
}

void check(const VisualBodyDef& def)
{
    validate(def, bodyName(def.name));
    checkPositions(def.mesh.vertices, def.mesh.vertices.size(), def.name);
}

ReadyMaterial readyMaterial(Scene& scene, const Material& material, const geometry::TriangleMesh& mesh,
                            std::string_view body)
{
    ReadyMaterial ready = scene.materials.ready(material, materialName(body));
    checkFits(scene, ready, mesh, body);
    return ready;
}

ReadyMaterial readyMaterial(Scene& scene, const Material& pool, const NamedMaterial& named,
                            const geometry::TriangleMesh& mesh, std::string_view body)
{
    ReadyMaterial ready = scene.materials.ready(pool, named, materialName(body));
    checkFits(scene, ready, mesh, body);
    return ready;
}

void refreshViewPictures(Scene& scene)
{
    for (VisualBody* body : scene.bodies) {
        const ReadyMaterial ready = scene.materials.ready(body->material(), bodyName(body->name()));
        if (!ready.views.empty()) scene.backend->setMaterial(body->impl().slot, ready);
    }
}

BodyGeometry bodyGeometry(const Subdivision& subdivision, std::span<const Vec3> rest, std::span<const Vec3> now)
{
    BodyGeometry geometry;
    geometry.rest = subdivision.refine(toFloats(rest));
    subdivision.addCopies(geometry.rest);
    const std::span<const std::uint32_t> drawn = subdivision.drawnIndices();
    geometry.indices.assign(drawn.begin(), drawn.end());
    geometry.uv = subdivision.uv();
    std::vector<Float3> normals;
    geometry.vertices = vertexData(subdivision.refine(toFloats(now)), subdivision.indices(), normals);
    subdivision.addCopies(geometry.vertices.positions);
    subdivision.addCopies(geometry.vertices.frames);
    return geometry;
}

VisualBody::VisualBody(std::string name, std::unique_ptr<Impl> impl)
    : Transform(std::move(name)), impl_(std::move(impl))
{
    impl_->scene.bodies.push_back(this);
}
VisualBody::~VisualBody() { std::erase(impl_->scene.bodies, this); }

int VisualBody::vertexCount() const { return static_cast<int>(impl_->def.mesh.vertices.size()); }
std::span<const Vec3> VisualBody::vertices() const { return impl_->def.mesh.vertices; }
std::span<const geometry::Triangle> VisualBody::triangles() const { return impl_->def.mesh.triangles; }
const Material& VisualBody::material() const { return impl_->def.material; }

void VisualBody::setVertices(std::span<const Vec3> positions)
{
    impl_->scene.assertThread();
    impl_->scene.watch.start();
    checkPositions(positions, impl_->def.mesh.vertices.size(), name());
    VertexData data = impl_->deform(positions);
    impl_->scene.backend->setVertices(impl_->slot, std::move(data));
    impl_->scene.watch.lap(&VisualStages::upload);
    ++impl_->scene.vertexUpdates;
}

void VisualBody::setMesh(const geometry::TriangleMesh& mesh, std::span<const Vec3> rest)
{
    impl_->scene.assertThread();
    checkPositions(mesh.vertices, mesh.vertices.size(), name());
    checkPositions(rest, mesh.vertices.size(), name());
    adopt(PreparedMesh({{rest.begin(), rest.end()}, mesh.triangles, mesh.uv}, impl_->def.subdivision, name()),
          mesh.vertices);
}

void VisualBody::adopt(PreparedMesh prepared, std::span<const Vec3> now)
{
    impl_->scene.assertThread();
    impl_->scene.watch.start();
    PreparedMesh::Impl& ready = prepared.impl();
    checkPositions(now, ready.rest.vertices.size(), name());
    if (ready.rest.uv.empty()) readyMaterial(impl_->scene, impl_->def.material, ready.rest, name());
    impl_->subdivision = std::move(ready.subdivision);
    impl_->states.clear();
    impl_->def.mesh = std::move(ready.rest);
    ready.geometry.vertices = impl_->deform(now);
    impl_->scene.backend->setGeometry(impl_->slot, std::move(ready.geometry));
    impl_->scene.watch.lap(&VisualStages::upload);
    ++impl_->scene.vertexUpdates;
}

VertexData VisualBody::Impl::deform(std::span<const Vec3> positions)
{
    if (positions.data() != def.mesh.vertices.data()) def.mesh.vertices.assign(positions.begin(), positions.end());
    control.resize(positions.size());
    std::transform(positions.begin(), positions.end(), control.begin(), toFloat3);
    std::vector<Float3> refined = subdivision.refine(control);
    scene.watch.lap(&VisualStages::subdivision);
    VertexData data = vertexData(std::move(refined), subdivision.indices(), normals);
    subdivision.addCopies(data.positions);
    subdivision.addCopies(data.frames);
    if (tangents && !subdivision.uv().empty()) {
        subdivision.addCopies(normals);
        alignFrames(data, subdivision.drawnIndices(), subdivision.uv(), normals, tangentSums);
    }
    scene.watch.lap(&VisualStages::normals);
    return data;
}

void VisualBody::Impl::look(const ReadyMaterial& material)
{
    scene.backend->setMaterial(slot, material);
    if (std::exchange(tangents, material.needsTangents) == tangents) return;
    scene.watch.start();
    scene.backend->setVertices(slot, deform(def.mesh.vertices));
    scene.watch.lap(&VisualStages::upload);
    ++scene.vertexUpdates;
}

void VisualBody::setSurfaceState(std::span<const SurfaceState> states)
{
    impl_->scene.assertThread();
    checkCount(*this, states.size(), "surface state");
    std::vector<Float3> control(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
        for (double value : {states[i].blood, states[i].burn, states[i].wetness})
            if (!(value >= 0.0 && value <= 1.0))
                fail(bodyName(name()), ": the surface state of vertex ", i, " must be in [0, 1], got ", value);
        control[i] = toFloat3({states[i].blood, states[i].burn, states[i].wetness});
    }
    impl_->putStates(control, 0, 3);
}

void VisualBody::setSeam(std::span<const std::uint8_t> onSeam)
{
    impl_->scene.assertThread();
    checkCount(*this, onSeam.size(), "seam flag");
    std::vector<Float3> control(onSeam.size());
    for (std::size_t i = 0; i < onSeam.size(); ++i) control[i].x = onSeam[i] != 0 ? 1.0F : 0.0F;
    impl_->putStates(control, 3, 1);
}

void VisualBody::setHeat(std::span<const float> levels)
{
    impl_->scene.assertThread();
    checkCount(*this, levels.size(), "level of heat");
    std::vector<Float3> control(levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (!(levels[i] >= -1.0F && levels[i] <= 3.0F))
            fail(bodyName(name()), ": the heat of vertex ", i, " must be in [-1, 3], got ", levels[i]);
        control[i].x = 0.25F * (levels[i] + 1.0F);
    }
    impl_->putStates(control, 4, 1);
}

void VisualBody::Impl::putStates(std::span<const Float3> shares, std::size_t first, std::size_t count)
{
    // The refined values are means of the given ones, up to rounding.
    const auto pack = [](float v) { return static_cast<std::uint8_t>(std::lrint(255.0F * std::clamp(v, 0.0F, 1.0F))); };
    const std::vector<Float3> refined = subdivision.refine(shares);
    states.resize(refined.size());
    for (std::size_t i = 0; i < refined.size(); ++i) {
        const std::array values{refined[i].x, refined[i].y, refined[i].z};
        for (std::size_t k = 0; k < count; ++k) states[i][first + k] = pack(values[k]);
    }
    std::vector<PackedState> drawn = states;
    subdivision.addCopies(drawn);
    scene.backend->setSurfaceState(slot, std::move(drawn));
}

void VisualBody::setMaterial(const Material& material)
{
    impl_->scene.assertThread();
    const ReadyMaterial ready = readyMaterial(impl_->scene, material, impl_->def.mesh, name());
    impl_->look(ready);
    impl_->def.material = material;
}

} // namespace filasofia::visual

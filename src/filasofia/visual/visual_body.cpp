#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/visual/scene.h"

#include <algorithm>
#include <cmath>

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
    const std::string object = text(bodyName(body), ": material");
    ReadyMaterial ready = scene.materials.ready(material, object);
    for (const std::string& view : ready.views)
        if (std::none_of(scene.views.begin(), scene.views.end(), [&](View* each) {
                return each->def().name == view && std::holds_alternative<OffScreen>(each->def().target);
            }))
            fail(object, ": there is no off-screen view '", view, "'");
    if (ready.needsUv && mesh.uv.empty()) fail(object, " has a texture, but the mesh has no uv");
    return ready;
}

void refreshViewPictures(Scene& scene)
{
    for (VisualBody* body : scene.bodies) {
        const ReadyMaterial ready = scene.materials.ready(body->material(), bodyName(body->name()));
        if (!ready.views.empty()) scene.backend->setMaterial(body->impl().slot, ready);
    }
}

BodyGeometry bodyGeometry(const Subdivision& subdivision, std::span<const Vec3> rest, const geometry::TriangleMesh& now)
{
    BodyGeometry geometry;
    geometry.rest = subdivision.refine(toFloats(rest));
    geometry.indices.assign(subdivision.indices().begin(), subdivision.indices().end());
    std::vector<Float3> normals;
    geometry.vertices = vertexData(subdivision.refine(toFloats(now.vertices)), geometry.indices, normals);
    std::vector<Float3> uv(now.uv.size());
    for (std::size_t i = 0; i < uv.size(); ++i) uv[i] = toFloat3({now.uv[i][0], now.uv[i][1], 0.0});
    if (!uv.empty())
        for (const Float3& refined : subdivision.refine(uv)) geometry.uv.push_back({refined.x, refined.y});
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
    impl_->def.mesh = std::move(ready.rest);
    ready.geometry.vertices = impl_->deform(now);
    impl_->scene.backend->setGeometry(impl_->slot, std::move(ready.geometry));
    impl_->scene.watch.lap(&VisualStages::upload);
    ++impl_->scene.vertexUpdates;
}

VertexData VisualBody::Impl::deform(std::span<const Vec3> positions)
{
    def.mesh.vertices.assign(positions.begin(), positions.end());
    control.resize(positions.size());
    std::transform(positions.begin(), positions.end(), control.begin(), toFloat3);
    std::vector<Float3> refined = subdivision.refine(control);
    scene.watch.lap(&VisualStages::subdivision);
    VertexData data = vertexData(std::move(refined), subdivision.indices(), normals);
    scene.watch.lap(&VisualStages::normals);
    return data;
}

void VisualBody::setSurfaceState(std::span<const SurfaceState> states)
{
    impl_->scene.assertThread();
    if (states.size() != impl_->def.mesh.vertices.size())
        fail(bodyName(name()), ": needs one surface state for each of its ", vertexCount(), " vertices, got ",
             states.size());
    std::vector<Float3> control(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
        for (double value : {states[i].blood, states[i].burn, states[i].wetness})
            if (!(value >= 0.0 && value <= 1.0))
                fail(bodyName(name()), ": the surface state of vertex ", i, " must be in [0, 1], got ", value);
        control[i] = toFloat3({states[i].blood, states[i].burn, states[i].wetness});
    }
    // The refined values are means of the given ones, up to rounding.
    const auto pack = [](float v) { return static_cast<std::uint8_t>(std::lrint(255.0F * std::clamp(v, 0.0F, 1.0F))); };
    const std::vector<Float3> refined = impl_->subdivision.refine(control);
    std::vector<PackedState> packed(refined.size());
    for (std::size_t i = 0; i < refined.size(); ++i)
        packed[i] = {pack(refined[i].x), pack(refined[i].y), pack(refined[i].z), 0};
    impl_->scene.backend->setSurfaceState(impl_->slot, std::move(packed));
}

void VisualBody::setMaterial(const Material& material)
{
    impl_->scene.assertThread();
    const ReadyMaterial ready = readyMaterial(impl_->scene, material, impl_->def.mesh, name());
    impl_->scene.backend->setMaterial(impl_->slot, ready);
    impl_->def.material = material;
}

} // namespace filasofia::visual

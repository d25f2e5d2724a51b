#include "filasofia/visual/null_backend.h"

#include "filasofia/core/assert.h"
#include "filasofia/visual/depth_views.h"

#include <utility>

namespace filasofia::visual {
namespace {

Image blackImage(int width, int height)
{
    Image image{width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height), 0)};
    for (std::size_t alpha = 3; alpha < image.rgba.size(); alpha += 4) image.rgba[alpha] = 255;
    return image;
}

} // namespace

void NullBackend::addBody(Slot slot, const ReadyMaterial& material, const BodyTraits& traits, BodyGeometry geometry)
{
    FILASOFIA_ASSERT(!bodies.contains(slot) && !placed.contains(slot));
    Body body;
    body.geometry = std::move(geometry);
    body.states.resize(body.geometry.rest.size());
    body.material = material.material;
    body.castShadows = traits.castShadows;
    body.label = traits.label;
    bodies.emplace(slot, std::move(body));
}

void NullBackend::setGeometry(Slot body, BodyGeometry geometry)
{
    Body& changed = bodies.at(body);
    changed.geometry = std::move(geometry);
    changed.states.assign(changed.geometry.rest.size(), {});
    ++changed.geometryCalls;
}

void NullBackend::setVertices(Slot body, VertexData vertices)
{
    Body& changed = bodies.at(body);
    FILASOFIA_ASSERT(vertices.positions.size() == changed.geometry.rest.size());
    changed.geometry.vertices = std::move(vertices);
    ++changed.vertexCalls;
}

void NullBackend::setSurfaceState(Slot body, std::vector<PackedState> states)
{
    Body& changed = bodies.at(body);
    FILASOFIA_ASSERT(states.size() == changed.geometry.rest.size());
    changed.states = std::move(states);
}

void NullBackend::setMaterial(Slot body, const ReadyMaterial& material)
{
    bodies.at(body).material = material.material;
    ++bodies.at(body).materialCalls;
}
void NullBackend::putLight(Slot slot, const LightDef&) { ++placed[slot].putCalls; }
void NullBackend::putCamera(Slot slot, const CameraDef&) { ++placed[slot].putCalls; }
void NullBackend::putView(Slot slot, const ViewDef& def, Slot camera)
{
    FILASOFIA_ASSERT(placed.contains(camera));
    ++placed[slot].putCalls;
    const auto* picture = std::get_if<OffScreen>(&def.target);
    placed[slot].width = picture ? picture->width : 0;
    placed[slot].height = picture ? picture->height : 0;
}
void NullBackend::setEnvironment(const EnvironmentDef&) { ++environmentCalls; }

void NullBackend::setPose(Slot entity, const Pose& world)
{
    const auto body = bodies.find(entity);
    (body != bodies.end() ? body->second.pose : placed.at(entity).pose) = world;
}

void NullBackend::setScale(Slot body, double scale) { bodies.at(body).scale = scale; }

void NullBackend::setVisible(Slot entity, bool visible)
{
    const auto body = bodies.find(entity);
    (body != bodies.end() ? body->second.visible : placed.at(entity).visible) = visible;
}

void NullBackend::remove(Slot entity) { FILASOFIA_ASSERT(bodies.erase(entity) + placed.erase(entity) == 1); }

void NullBackend::resize(int width, int height)
{
    width_ = width;
    height_ = height;
}

bool NullBackend::draw()
{
    ++frames;
    return true;
}

Image NullBackend::capture()
{
    draw();
    return blackImage(width_, height_);
}

Image NullBackend::capture(Slot view)
{
    const Placed& shown = placed.at(view);
    FILASOFIA_ASSERT(shown.width > 0);
    return blackImage(shown.width, shown.height);
}

DepthImage NullBackend::captureDepth() { return emptyDepth(width_, height_); }

DepthImage NullBackend::captureDepth(Slot view)
{
    const Placed& shown = placed.at(view);
    return emptyDepth(shown.width, shown.height);
}

} // namespace filasofia::visual

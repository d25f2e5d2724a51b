#include "filasofia/runtime/bindings.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/surface_fit.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/strands.h"
#include "filasofia/runtime/surfaces.h"
#include "filasofia/visual/visual_server.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {
namespace {

/// Calls `visit` with every texture of a built-in material, and the name of its field.
template <class Held, class Visit> void forEachTexture(Held& material, Visit&& visit)
{
    if constexpr (!std::is_same_v<Held, visual::CustomMaterial> && !std::is_same_v<Held, visual::NamedMaterial>)
        forEachField<Held>([&](const auto& each) {
            auto& value = material.*(each.member);
            using Value = std::remove_cvref_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, visual::Texture> || std::is_same_v<Value, visual::TextureMap>)
                visit(value, each.name);
        });
}

/// The inside has no uv, so no textures either: neither its own nor those that it has by a name of the pool.
void dropTextures(visual::Material& inside, const std::map<std::string, visual::Material>& pool)
{
    const auto drop = [](auto& texture, std::string_view) { texture = visual::NoTexture{}; };
    std::visit([&](auto& held) { forEachTexture(held, drop); }, inside);
    auto* named = std::get_if<visual::NamedMaterial>(&inside);
    const auto found = named ? pool.find(named->name) : pool.end();
    if (found == pool.end()) return;
    const auto none = [&](const auto& texture, std::string_view name) {
        const auto count =
            std::erase_if(named->overrides, [&](const visual::MaterialParameter& each) { return each.name == name; });
        if (count > 0 || texture.index() > 0)
            named->overrides.push_back({std::string(name), visual::Texture{visual::NoTexture{}}});
    };
    visual::Material shown = found->second;
    std::visit([&](auto& held) { forEachTexture(held, none); }, shown);
}

/// The attachment whose strands are to be drawn. Throws an Error that begins with `object` if it has none.
AttachmentId strandsOf(BodyId id, const StrandsDef& def, const physics::BodyDef& body,
                       const physics::PhysicsServer& physics, const std::string& object)
{
    const auto* soft = std::get_if<physics::SoftBodyDef>(&body);
    if (!soft) fail(object, ": strands need a soft body");
    const auto index = static_cast<std::size_t>(def.attachment);
    if (index >= soft->attachments.size())
        fail(object, ": strands.attachment must be in [0, ", soft->attachments.size(), "), got ", index);
    const physics::AttachmentDef& attachment = soft->attachments[index];
    if (attachment.pointBreakForce == physics::kNever && attachment.cutDistance == 0.0)
        fail(object, ": strands.attachment: attachments[", index,
             "] has neither pointBreakForce nor cutDistance, so it holds as a whole");
    return physics.attachments(id).at(index);
}

/// Inside, tissue is redder and wetter than its skin.
visual::Material interiorOf(const visual::Material& skin, const visual::VisualServer& server)
{
    visual::Material inside = skin;
    dropTextures(inside, server.materials());
    if (auto* tissue = std::get_if<visual::TissueMaterial>(&inside)) {
        const auto mixed = [](visual::Color a, visual::Color b) {
            return visual::Color{0.5 * (a.red + b.red), 0.5 * (a.green + b.green), 0.5 * (a.blue + b.blue)};
        };
        tissue->baseColor = mixed(tissue->baseColor, {0.30, 0.012, 0.010});
        tissue->subsurfaceColor = mixed(tissue->subsurfaceColor, {0.55, 0.02, 0.015});
        tissue->wetness = 1.0;
        tissue->vessels *= 0.3;
    }
    return inside;
}

bool fits(const mapping::MappedSurface& surface, const frame::SoftBodyFrame& body)
{
    return mapping::nodesNeeded(surface.map) <= static_cast<int>(body.positions.size());
}

} // namespace

ShownId Bindings::show(BodyId id, const ShowDef& given, const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text("show ", physics::describeBody(*body));
    validate(given, object);
    ShowDef def = given;
    if (!def.material) def.material = def.strands ? connectiveTissue() : materialOf(*body);
    const auto surface = loadSurface(def.surface, object);

    std::vector<Binding> made;
    if (def.strands) {
        if (surface) fail(object, ": surface must be empty if strands are given");
        const AttachmentId attachment = strandsOf(id, *def.strands, *body, physics, object);
        const auto& soft = std::get<physics::SoftBodyDef>(*body);
        made.push_back({.id = id,
                        .name = soft.name,
                        .mapped = std::make_shared<const mapping::MappedSurface>(
                            mapping::MappedSurface{strandMesh(1, soft.pose.position), mapping::IdentityMap{}}),
                        .start = soft.pose,
                        .def = def,
                        .strandsOf = attachment});
    } else if (const auto* soft = std::get_if<physics::SoftBodyDef>(&*body)) {
        auto mapped = std::make_shared<const mapping::MappedSurface>(mapSoft(*soft, surface.get(), object));
        if (surface && !physics::isShell(*soft))
            if (const std::string odd = geometry::oddFit(mapped->surface.vertices, physics::worldMesh(*soft).nodes);
                !odd.empty())
                logWarning(object, ": surface ", odd);
        std::shared_ptr<const mapping::OpeningSurface> opening;
        if (surface && soft->dynamicTopology && physics::isShell(*soft))
            fail(object, ": surface must be empty if a shell has dynamicTopology: it is drawn as its own triangles, "
                         "which follow its cuts");
        if (surface && soft->dynamicTopology) {
            opening = mapping::OpeningSurface::make(mapped, physics::worldMesh(*soft));
            if (!opening)
                logWarning(
                    object,
                    ": this surface deforms with the body but does not open where it is cut, because parts of it are "
                    "not near the body's skin; without a surface the body's own boundary is drawn, which opens");
        }
        if (soft->dynamicTopology && physics::isShell(*soft) && !mapped->surface.uv.empty()) {
            const std::lock_guard lock(mutex_);
            printed_.try_emplace(id, mapped->surface);
        }
        const int nodes = mapping::nodesNeeded(mapped->map);
        made.push_back({.id = id,
                        .name = soft->name,
                        .mapped = std::move(mapped),
                        .nodes = nodes,
                        .start = soft->pose,
                        .def = def,
                        .boundary = !surface,
                        .opening = std::move(opening)});
    } else if (const auto* rod = std::get_if<physics::RodBodyDef>(&*body)) {
        auto mapped = std::make_shared<const mapping::MappedSurface>(mapRod(*rod, surface.get(), object));
        const int nodes = mapping::nodesNeeded(mapped->map);
        made.push_back(
            {.id = id, .name = rod->name, .mapped = std::move(mapped), .nodes = nodes, .start = rod->pose, .def = def});
    } else {
        const auto& rigid = std::get<physics::RigidBodyDef>(*body);
        const int count = static_cast<int>(rigid.elements.size());
        if (def.element >= count) fail(object, ": element must be in [0, ", count, "), got ", def.element);
        if (!surface && def.element > 0)
            fail(object, ": element needs a surface (without one every element is drawn), got ", def.element);
        const auto drawn = std::make_shared<const mapping::MappedSurface>(
            mapping::MappedSurface{surface ? *surface : ownSurface(rigid, def, object), {}});
        for (int element = surface ? def.element : 0; element < (surface ? def.element + 1 : count); ++element)
            made.push_back({.id = id,
                            .soft = false,
                            .name = rigid.name,
                            .mapped = drawn,
                            .rigidMap = {element},
                            .start = rigid.elements[element],
                            .def = def});
    }
    const std::lock_guard lock(mutex_);
    const ShownId shown{++lastShown_};
    for (Binding& binding : made) {
        binding.shown = shown;
        binding.key = ++lastKey_;
        binding.subdivision = def.subdivision;
        if (binding.strandsOf) { // nobody paints them
            pending_.push_back(std::move(binding));
            continue;
        }
        const auto element = binding.soft ? std::nullopt : std::optional<int>(binding.rigidMap.element);
        painted_.add(binding.key, {binding.id, element, binding.start}, binding.mapped);
        askMesh(binding); // the body may have been cut already
        pending_.push_back(std::move(binding));
    }
    return shown;
}

Bindings::PendingChange& Bindings::change(ShownId id, const char* what)
{
    if (!id || id.value > lastShown_) fail(what, ": nothing shown has the id ", id.value);
    return changes_[id];
}

void Bindings::setVisible(ShownId id, bool visible)
{
    const std::lock_guard lock(mutex_);
    change(id, "setVisible").visible = visible;
}

void Bindings::setMaterial(ShownId id, const visual::Material& material)
{
    ShowDef def;
    def.material = material;
    validate(def, "setMaterial");
    const std::lock_guard lock(mutex_);
    change(id, "setMaterial").material = material;
}

void Bindings::remove(ShownId id)
{
    const std::lock_guard lock(mutex_);
    change(id, "unshow").gone = true;
}

int Bindings::paint(BodyId id, const PaintDef& def, physics::PhysicsServer& physics)
{
    const std::string object = text("paint ", physics::describeBody(*physics.def(id)));
    validate(def, object);
    const frame::FrameRef frame = physics.latest();
    return painted_.paint(id, def, frame ? &*frame : nullptr);
}

void Bindings::retopologise(BodyId id, SharedSurface surface, SharedSurface interior,
                            std::shared_ptr<const frame::Boundary> boundary)
{
    FILASOFIA_ASSERT(surface);
    const std::lock_guard lock(mutex_);
    topology_[id] = {std::move(surface), std::move(interior), std::move(boundary)};
    changed_.insert(id);
}

bool Bindings::isCut(BodyId id) const
{
    const std::lock_guard lock(mutex_);
    return topology_.contains(id);
}

void Bindings::followTopology(const frame::Frame& frame)
{
    for (const frame::SoftBodyFrame& body : frame.softBodies) {
        if (!body.boundary) continue;
        const auto last = std::exchange(boundaries_[body.id], body.boundary);
        if (last == body.boundary) continue;
        if (!last && body.boundary->revision == 0 && !isCut(body.id)) continue; // drawn as it was built
        const auto part = [&](bool opened) {
            mapping::MappedSurface made = mapping::mapBoundary(*body.boundary, opened);
            const std::lock_guard lock(mutex_);
            if (const auto print = printed_.find(body.id); print != printed_.end() && !opened)
                print->second.print(made);
            return std::make_shared<const mapping::MappedSurface>(std::move(made));
        };
        auto interior = part(true);
        const bool open = !interior->surface.triangles.empty();
        retopologise(body.id, part(false), open ? std::move(interior) : nullptr, body.boundary);
    }
}

void Bindings::apply(const PendingChange& change, Binding& binding, const visual::VisualServer& visual)
{
    if (change.visible) binding.def.visible = *change.visible;
    if (change.material)
        binding.def.material =
            binding.interior ? binding.def.interior.value_or(interiorOf(*change.material, visual)) : *change.material;
    if (!binding.drawn) return;
    if (change.visible) binding.drawn->setVisible(*change.visible);
    try {
        if (change.material) binding.drawn->setMaterial(*binding.def.material);
    } catch (const Error& problem) { // a problem that shows only now, such as a missing file; the picture goes on
        logError(problem.what());
    }
}

void Bindings::forget(const Binding& binding)
{
    painted_.forget(binding.key);
    worker_.forget(binding.key);
}

void Bindings::applyChanges(visual::VisualServer& visual)
{
    const std::map<ShownId, PendingChange> changes = std::exchange(changes_, {});
    for (std::vector<Binding>* list : {&pending_, &shown_})
        std::erase_if(*list, [&](Binding& binding) {
            const auto found = changes.find(binding.shown);
            if (found == changes.end()) return false;
            apply(found->second, binding, visual);
            if (!found->second.gone) return false;
            if (binding.drawn) visual.remove(*binding.drawn);
            forget(binding);
            return true;
        });
}

void Bindings::applyTopology()
{
    const std::set<BodyId> changed = std::exchange(changed_, {});
    for (const std::vector<Binding>* list : {&pending_, &shown_})
        for (const Binding& binding : *list)
            if (changed.contains(binding.id)) askMesh(binding);
    openInteriors();
}

void Bindings::openInteriors()
{
    std::vector<Binding> made;
    for (const std::vector<Binding>* list : {&pending_, &shown_})
        for (const Binding& skin : *list) {
            const auto newest = topology_.find(skin.id);
            if (!(skin.boundary || skin.opening) || skin.interior || newest == topology_.end() ||
                !newest->second.interior)
                continue;
            const auto isInside = [&](const Binding& each) { return each.interior && each.shown == skin.shown; };
            if (std::ranges::any_of(pending_, isInside) || std::ranges::any_of(shown_, isInside)) continue;
            Binding& inside = made.emplace_back(skin);
            inside.key = ++lastKey_;
            inside.boundary = true;
            inside.interior = true;
            inside.opening = nullptr;
            inside.drawn = nullptr;
            inside.marks = {};
            inside.mapped = newest->second.interior;
            inside.nodes = mapping::nodesNeeded(inside.mapped->map);
            inside.def.material = skin.def.interior.value_or(interiorOf(*skin.def.material, *visual_));
            inside.subdivision = 0; // until the worker has it
            painted_.add(inside.key, {inside.id, std::nullopt, inside.start}, inside.mapped);
            askMesh(inside);
        }
    for (Binding& each : made) pending_.push_back(std::move(each));
}

void Bindings::askMesh(const Binding& binding)
{
    const auto newest = topology_.find(binding.id);
    if (newest == topology_.end()) return;
    const auto& [skin, interior, boundary] = newest->second;
    MeshJob job{binding.mapped, nullptr, binding.def.subdivision, binding.name};
    if (binding.opening) {
        job.opening = binding.opening;
        job.boundary = boundary;
    } else if (binding.boundary) {
        job.to = binding.interior ? interior : skin;
    }
    if (job.to || job.boundary) worker_.ask(binding.key, std::move(job));
}

void Bindings::forgetRemoved(const physics::PhysicsServer& physics)
{
    const std::lock_guard lock(mutex_);
    std::erase_if(pending_, [&](const Binding& binding) {
        const bool removed = !physics.has(binding.id);
        if (removed) forget(binding);
        return removed;
    });
}

void Bindings::addPending(visual::VisualServer& visual)
{
    visual_ = &visual;
    const std::lock_guard lock(mutex_);
    applyChanges(visual);
    applyTopology();
    std::size_t added = 0;
    const auto forgetAdded = [&] { pending_.erase(pending_.begin(), pending_.begin() + static_cast<long>(added)); };
    try {
        for (; added < pending_.size(); ++added) {
            const Binding& binding = pending_[added];
            if (binding.def.interior && !binding.interior) // a wrong material is reported now, not at the first cut
                visual.addMaterial(text(kInteriorOf, binding.name, " ", binding.key), *binding.def.interior);
            visual::VisualBody& drawn = visual.add(visual::VisualBodyDef{.name = binding.name,
                                                                         .mesh = binding.mapped->surface,
                                                                         .subdivision = binding.subdivision,
                                                                         .material = *binding.def.material,
                                                                         .castShadows = binding.def.castShadows,
                                                                         .label = static_cast<int>(binding.id.value)});
            if (!binding.mapped->pattern.empty()) drawn.setMesh(binding.mapped->surface, binding.mapped->pattern);
            if (!binding.def.visible) drawn.setVisible(false);
            if (!binding.strandsOf) painted_.resend(binding.key);
            shown_.push_back(std::move(pending_[added]));
            shown_.back().drawn = &drawn;
            shown_.back().strands = 1;
            drawSeam(shown_.back());
        }
    } catch (...) {
        forgetAdded();
        throw;
    }
    forgetAdded();
}

void Bindings::update(const frame::Frame& frame, const physics::PhysicsServer& physics, visual::VisualServer& visual)
{
    followTopology(frame);
    std::erase_if(shown_, [&](Binding& binding) {
        const bool found = place(binding, frame);
        binding.seen = binding.seen || found;
        // A body that has not come yet is waited for, unless it was removed before it came.
        const bool removed = !found && (binding.seen || !physics.has(binding.id));
        const bool gone = removed || closedAgain(binding);
        if (gone) {
            visual.remove(*binding.drawn);
            forget(binding);
        }
        if (removed) {
            const std::lock_guard lock(mutex_);
            topology_.erase(binding.id);
            boundaries_.erase(binding.id);
        }
        if (gone) return true;
        if (!binding.strandsOf) drawMarks(binding);
        return false;
    });
    followers_.update(frame, physics);
}

void Bindings::setFilms(const std::map<BodyId, NodeFilm>& blood, const std::map<BodyId, NodeFilm>& burns)
{
    for (const auto& [id, film] : blood) marks_[id].blood = film;
    for (const auto& [id, film] : burns) marks_[id].heat = film;
}

void Bindings::drawMarks(Binding& binding)
{
    const auto newest = marks_.find(binding.id);
    const NodeMarks marks = binding.soft && newest != marks_.end() ? newest->second : NodeMarks{};
    const bool painted = painted_.takeNew(binding.key).has_value();
    if (!painted && marks == binding.marks) return;
    binding.marks = marks;
    std::vector<visual::SurfaceState> states = painted_.states(binding.key);
    states.resize(binding.mapped->surface.vertices.size());
    const mapping::SoftMap& map = binding.mapped->map;
    if (marks.blood) addBlood(map, *marks.blood, states);
    binding.drawn->setSurfaceState(states);
    if (marks.heat) binding.drawn->setHeat(heatOf(map, *marks.heat, states.size()));
}

void Bindings::drawSeam(const Binding& binding)
{
    if (!binding.mapped->rim.empty()) binding.drawn->setSeam(binding.mapped->rim);
}

bool Bindings::place(Binding& binding, const frame::Frame& frame)
{
    if (!binding.soft) {
        const frame::RigidBodyFrame* body = frame.rigidBody(binding.id);
        if (body) binding.drawn->setPose(mapping::apply(binding.rigidMap, *body));
        return body != nullptr;
    }
    const frame::SoftBodyFrame* body = frame.softBody(binding.id);
    if (!body) return false;
    if (binding.strandsOf) {
        placeStrands(binding, frame);
        return true;
    }
    auto ready = worker_.take(binding.key, [&](const mapping::MappedSurface& surface) { return fits(surface, *body); });
    if (ready) {
        binding.mapped = ready->surface;
        binding.nodes = mapping::nodesNeeded(binding.mapped->map);
        binding.subdivision = ready->subdivision;
        painted_.moveTo(binding.key, ready->surface, ready->transfers);
    }
    // An invisible surface costs nothing; if nodes are missing it stays as it was.
    if (!ready && !binding.def.visible) return true;
    if (binding.nodes > static_cast<int>(body->positions.size())) return true;
    vertices_.resize(binding.mapped->surface.vertices.size());
    mapping::apply(binding.mapped->map, *body, vertices_);
    if (ready) {
        binding.drawn->adopt(std::move(ready->mesh), vertices_);
        drawSeam(binding);
        binding.marks = {}; // the new triangles do not have them yet
    } else
        binding.drawn->setVertices(vertices_);
    return true;
}

void Bindings::placeStrands(Binding& binding, const frame::Frame& frame)
{
    vertices_.clear();
    const int count = writeStrands(frame.attachedPoints, binding.strandsOf, *binding.def.strands, vertices_);
    binding.drawn->setVisible(binding.def.visible && count > 0);
    if (count == 0) return;
    if (count > binding.strands) {
        geometry::TriangleMesh mesh = strandMesh(count, {});
        mesh.vertices = vertices_;
        binding.drawn->setMesh(mesh, vertices_);
        binding.strands = count;
        return;
    }
    const std::size_t each = vertices_.size() / static_cast<std::size_t>(count);
    vertices_.resize(each * static_cast<std::size_t>(binding.strands), vertices_.back()); // no strand, but a point
    binding.drawn->setVertices(vertices_);
}

bool Bindings::closedAgain(const Binding& binding)
{
    if (!binding.interior) return false;
    const std::lock_guard lock(mutex_);
    const auto newest = topology_.find(binding.id);
    return newest != topology_.end() && !newest->second.interior;
}

void Bindings::finishMeshes(const frame::Frame* newest)
{
    if (newest) followTopology(*newest);
    {
        const std::lock_guard lock(mutex_);
        applyTopology();
    }
    worker_.finish();
}

void Bindings::follow(visual::Transform& transform, BodyId id, const FollowDef& def,
                      const physics::PhysicsServer& physics)
{
    if (!visual_) fail("follow: there is no visual server yet; call it from the function given to dress()");
    if (!visual_->has(transform)) fail("follow: the transform does not belong to the visual server");
    followers_.follow(transform, id, def, physics);
}

void Bindings::release()
{
    const std::lock_guard lock(mutex_);
    boundaries_.clear();
    std::erase_if(shown_, [](const Binding& binding) { return binding.interior; }); // openInteriors() makes them again
    for (Binding& binding : shown_) {
        binding.drawn = nullptr;
        binding.marks = {};
        binding.seen = false;
        pending_.push_back(std::move(binding));
    }
    shown_.clear();
    followers_.clear();
    visual_ = nullptr;
}

std::vector<Vec3> Bindings::points() const
{
    std::vector<Vec3> points;
    const std::lock_guard lock(mutex_);
    for (const auto* list : {&pending_, &shown_})
        for (const Binding& binding : *list) {
            const Pose start = binding.soft ? Pose{} : binding.start; // a soft body's surface is in the world
            for (const Vec3& vertex : binding.mapped->surface.vertices) points.push_back(transform(start, vertex));
        }
    return points;
}

std::vector<Vec3> Bindings::pointsNow() const
{
    std::vector<Vec3> points;
    for (const Binding& binding : shown_) {
        if (!binding.drawn->visible()) continue;
        const Pose pose = binding.drawn->worldPose();
        for (const Vec3& vertex : binding.drawn->vertices()) points.push_back(transform(pose, vertex));
    }
    return points;
}

} // namespace filasofia::runtime

#include "filasofia/runtime/bindings.h"

#include "filasofia/core/validate.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/visual/visual_server.h"

namespace filasofia::runtime {
namespace {

using geometry::TriangleMesh;

/// The surface that was asked for, in the body's coordinates; nothing where none was.
std::shared_ptr<const TriangleMesh> loadSurface(const SurfaceSource& source, const std::string& object)
{
    if (const auto* file = std::get_if<std::string>(&source)) {
        if (file->empty()) return nullptr;
        return std::make_shared<const TriangleMesh>(geometry::loadTriangleMesh(*file));
    }
    const auto& given = std::get<std::shared_ptr<const TriangleMesh>>(source);
    if (given) geometry::check(*given, object + ": surface");
    return given;
}

mapping::MappedSurface mapSoft(const physics::SoftBodyDef& body, const TriangleMesh* surface)
{
    const geometry::TetMesh rest = physics::worldMesh(body);
    if (!surface) return mapping::mapBoundary(rest);
    TriangleMesh inWorld = *surface;
    for (Vec3& vertex : inWorld.vertices) vertex = transform(body.pose, vertex);
    return mapping::mapSurface(rest, std::move(inWorld));
}

constexpr double kCrease = 0.6; ///< [rad], 34 degrees: a box has edges, a sphere of 20 sides has none

/// The mesh of a rigid body that is drawn as it is.
TriangleMesh ownSurface(const physics::RigidBodyDef& body, const ShowDef& def, const std::string& object)
{
    const auto mesh = physics::loadMesh(body.mesh, object);
    if (!mesh) fail(object, ": surface must name a file or be a surface, as the body has no mesh of its own");
    if (def.subdivision > 0)
        return *mesh; // subdividing rounds edges, and would tear a surface that is split along them
    return mapping::withCreases(*mesh, kCrease);
}

} // namespace

void Bindings::show(BodyId id, const ShowDef& def, const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text("show ", physics::describeBody(*body));
    validate(def, object);
    const auto surface = loadSurface(def.surface, object);

    std::vector<Binding> made;
    if (const auto* soft = std::get_if<physics::SoftBodyDef>(&*body)) {
        mapping::MappedSurface mapped = mapSoft(*soft, surface.get());
        Binding& binding = made.emplace_back(Binding{.id = id, .def = def});
        binding.name = soft->name;
        binding.surface = std::move(mapped.surface);
        binding.softMap = std::move(mapped.map);
    } else {
        const auto& rigid = std::get<physics::RigidBodyDef>(*body);
        const int count = static_cast<int>(rigid.elements.size());
        if (def.element >= count) fail(object, ": element must be in [0, ", count, "), got ", def.element);
        if (!surface && def.element > 0)
            fail(object, ": element needs a surface (without one every element is drawn), got ", def.element);
        const TriangleMesh drawn = surface ? *surface : ownSurface(rigid, def, object);
        for (int element = surface ? def.element : 0; element < (surface ? def.element + 1 : count); ++element)
            made.push_back({.id = id,
                            .soft = false,
                            .name = rigid.name,
                            .surface = drawn,
                            .rigidMap = {element},
                            .start = rigid.elements[element],
                            .def = def});
    }
    const std::lock_guard lock(pendingMutex_);
    for (Binding& binding : made) pending_.push_back(std::move(binding));
}

void Bindings::addPending(visual::VisualServer& visual)
{
    const std::lock_guard lock(pendingMutex_);
    std::size_t added = 0;
    const auto forgetAdded = [&] { pending_.erase(pending_.begin(), pending_.begin() + static_cast<long>(added)); };
    try {
        for (; added < pending_.size(); ++added) {
            const Binding& binding = pending_[added];
            visual::VisualBody& drawn = visual.add(visual::VisualBodyDef{.name = binding.name,
                                                                         .mesh = binding.surface,
                                                                         .subdivision = binding.def.subdivision,
                                                                         .material = binding.def.material,
                                                                         .castShadows = binding.def.castShadows});
            shown_.push_back(std::move(pending_[added]));
            shown_.back().drawn = &drawn;
        }
    } catch (...) {
        forgetAdded();
        throw;
    }
    forgetAdded();
}

void Bindings::update(const frame::Frame& frame, const physics::PhysicsServer& physics, visual::VisualServer& visual)
{
    std::erase_if(shown_, [&](Binding& binding) {
        const bool found = place(binding, frame, vertices_);
        binding.seen = binding.seen || found;
        // A body that has not come yet is waited for, unless it was removed before it came.
        const bool gone = !found && (binding.seen || !physics.has(binding.id));
        if (gone) visual.remove(*binding.drawn);
        return gone;
    });
}

bool Bindings::place(Binding& binding, const frame::Frame& frame, std::vector<Vec3>& vertices)
{
    if (binding.soft) {
        const frame::SoftBodyFrame* body = frame.softBody(binding.id);
        if (!body) return false;
        vertices.resize(binding.surface.vertices.size());
        mapping::apply(binding.softMap, *body, vertices);
        binding.drawn->setVertices(vertices);
    } else {
        const frame::RigidBodyFrame* body = frame.rigidBody(binding.id);
        if (!body) return false;
        binding.drawn->setPose(mapping::apply(binding.rigidMap, *body));
    }
    return true;
}

void Bindings::release()
{
    const std::lock_guard lock(pendingMutex_);
    for (Binding& binding : shown_) {
        binding.drawn = nullptr;
        binding.seen = false;
        pending_.push_back(std::move(binding));
    }
    shown_.clear();
}

geometry::Box Bindings::bounds() const
{
    geometry::Box box;
    const std::lock_guard lock(pendingMutex_);
    for (const auto* list : {&pending_, &shown_})
        for (const Binding& binding : *list)
            for (const Vec3& vertex : binding.surface.vertices) box = merged(box, transform(binding.start, vertex));
    return box;
}

} // namespace filasofia::runtime

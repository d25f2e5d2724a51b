#include "filasofia/engine/step/tune_scene.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/engine/scene/check_scene.h"
#include "filasofia/engine/scene/snapshot.h"
#include "filasofia/engine/topology/loose_pieces.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// Callers know bodies by id and have checked their commands against the numbers of nodes: neither may change.
void checkSameBodies(const Snapshot& before, const Scene& scene)
{
    const auto same = [](const auto& a, const auto& b) { return a.id == b.id && a.rest.size() == b.rest.size(); };
    bool all = scene.soft.size() == before.softCount() && scene.rigid.size() == before.rigidCount();
    for (std::size_t b = 0; all && b < scene.soft.size(); ++b) all = same(scene.soft[b].model, before.soft(b));
    for (std::size_t b = 0; all && b < scene.rigid.size(); ++b) all = same(scene.rigid[b].model, before.rigid(b));
    if (!all) fail("tune: bodies, their ids, nodes and elements must not change; use add() and remove()");
}

/// The editable mesh must still match the model.
void checkSameMesh(const SoftModel& before, const SoftBody& body)
{
    const SoftModel& model = body.model;
    const BodyTopology& topology = body.topology;
    if (model.dynamicTopology != (topology.start != nullptr))
        fail("tune: ", describe(model), ": dynamicTopology must not change");
    if (!topology.mesh) return;
    const MeshTopology& mesh = topology.mesh->data();
    bool same =
        model.rest == mesh.rest && model.surface == before.surface && elementCount(model) == mesh.tetrahedra.size();
    for (std::size_t e = 0; same && e < mesh.tetrahedra.size(); ++e)
        same = mesh.tetrahedra[e] == elementNodes(model, e);
    if (!same)
        fail("tune: soft body '", model.name, "': nodes at rest, elements and surface must not change: it may be cut");
}

void checkScene(const Snapshot& before, const Scene& scene)
{
    if (!nonNegative().contains(scene.time)) fail("tune: time must be >= 0 s, got ", scene.time);
    if (!isFinite(scene.gravity)) fail("tune: gravity must be finite");
    for (const SoftBody& body : scene.soft) check(body.model, body.state);
    for (const RigidBody& body : scene.rigid) check(body.model, body.state);
    for (std::size_t b = 0; b < scene.soft.size(); ++b) checkSameMesh(before.soft(b), scene.soft[b]);
    checkAttachments(scene);
    checkContacts(scene);
}

/// Clears contact data of surfaces that were replaced: the new surface numbers its features differently.
void forgetReplacedSurfaces(const Snapshot& before, Scene& scene)
{
    const auto forget = [&](const auto& old, const auto& now) {
        for (std::size_t m = 0; m < std::max(old.collision.size(), now.collision.size()); ++m)
            if (m >= old.collision.size() || m >= now.collision.size() ||
                old.collision[m].shape != now.collision[m].shape)
                forgetSurface({now.id, static_cast<int>(m)}, scene);
    };
    for (std::size_t b = 0; b < scene.soft.size(); ++b) forget(before.soft(b), scene.soft[b].model);
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) forget(before.rigid(b), scene.rigid[b].model);
}

/// Updates the data derived from models and states after the user's change.
void followTune(const Snapshot& before, Scene& scene)
{
    forgetReplacedSurfaces(before, scene);
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        auto& [model, state, system, topology] = scene.soft[b];
        findHeld(model.pins, model.pieces);
        model.nodalVolumes = hasNodalVolumes(model.elements);
        // A reset restores the tuned model; if the mesh was edited, it restores the model from before the edits.
        if (topology.start && topology.revision == 0) *topology.start = model;
        // A jump is not a motion that blades could cut along.
        if (state.x != before.softState(b).x) topology.followed = false;
    }
}

} // namespace

void tuneScene(const physics::Tune& tune, physics::PhysicsEngine& self, Scene& scene, physics::StepReport& report)
{
    report.set(physics::StepFlag::Tuned);
    const Snapshot before(scene);
    const auto reject = [&](const char* why) {
        before.restore(scene);
        report.set(physics::StepFlag::TuneRejected);
        logError("tune() was rolled back: ", why);
    };
    bool changed = false;
    try {
        tune.change(self);
        checkSameBodies(before, scene);
        checkScene(before, scene);
        followTune(before, scene);
        changed = true;
    } catch (const std::exception& problem) {
        reject(problem.what());
    } catch (...) {
        reject("it threw something that is not a std::exception");
    }
    for (SoftBody& body : scene.soft) outdate(changed || body.system.tuned, body.system);
}

} // namespace filasofia::engine

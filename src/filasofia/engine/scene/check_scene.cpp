#include "filasofia/engine/scene/check_scene.h"

#include "filasofia/core/error.h"
#include "filasofia/engine/collision/proximity.h"
#include "filasofia/engine/constraint/body_point.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/physics/check_mouth.h"

#include <cmath>
#include <tuple>

/// Checks of a scene after a tune() has had access to it.
namespace filasofia::engine {

void checkAttachments(const Scene& scene)
{
    if (scene.attachmentForces.size() != scene.attachments.size())
        fail("attachments: holding must have one entry per attachment");
    const auto checkPoint = [&](const AttachedPoint& point, BodyId id, const std::string& object) {
        const auto body = findBody(scene, id);
        if (id && !body) fail(object, ": body ", id.value, ": no such body");
        if (!isFinite(point.place)) fail(object, ": place must be finite");
        const std::size_t nodes = body && body->soft ? scene.soft[body->index].model.rest.size() : 0;
        if ((nodes > 0) != !point.nodes.empty() || point.nodes.size() > std::tuple_size_v<decltype(BodyPoint::nodes)>)
            fail(object, ": a point must have one to twelve nodes if it is on a soft body, else none");
        for (const NodeWeight& each : point.nodes)
            if (each.node < 0 || static_cast<std::size_t>(each.node) >= nodes || !std::isfinite(each.weight))
                fail(object, ": node must be in [0, ", nodes, "), got ", each.node);
        if (const std::size_t elements = body && !body->soft ? scene.rigid[body->index].model.rest.size() : 1;
            point.element < 0 || static_cast<std::size_t>(point.element) >= elements)
            fail(object, ": element must be in [0, ", elements, "), got ", point.element);
    };
    const auto isKinematic = [&](const std::optional<BodyPlace>& body) {
        return !body || (!body->soft && !scene.rigid[body->index].model.dynamic); // as space does
    };
    const auto checkPair = [&](BodyId body, BodyId to, const std::string& object) {
        const auto held = findBody(scene, body), holder = findBody(scene, to);
        if (!held) fail(object, ": body ", body.value, ": no such body");
        if (to && !holder) fail(object, ": body ", to.value, ": no such body");
        if (body == to) fail(object, ": must attach two bodies, got body ", body.value, " twice");
        if (isKinematic(held) && isKinematic(holder))
            fail(object, ": two kinematic bodies cannot be attached: one of the two must be dynamic or soft");
    };
    const auto checkTurn = [&](const AttachedTurn& turn, const Attachment& of, const std::string& object) {
        const auto rod = findBody(scene, of.body), holder = findBody(scene, of.to);
        if (!rod->soft || !holder || holder->soft) fail(object, ": only a rod turns, with a rigid body");
        const std::size_t edges = scene.soft[rod->index].model.rod.edges.size();
        const std::size_t elements = scene.rigid[holder->index].model.rest.size();
        if (turn.edge < 0 || static_cast<std::size_t>(turn.edge) >= edges)
            fail(object, ": edge must be in [0, ", edges, "), got ", turn.edge);
        if (turn.element < 0 || static_cast<std::size_t>(turn.element) >= elements)
            fail(object, ": element must be in [0, ", elements, "), got ", turn.element);
        if (!isFinite(turn.director)) fail(object, ": director must be finite");
    };
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        const Attachment& each = scene.attachments[a];
        const std::string object = text("attachment ", each.id.value);
        if (a > 0 && !(scene.attachments[a - 1].id < each.id)) fail(object, ": attachments must ascend by their ids");
        if (!each.id) fail(object, ": its id must be > 0");
        checkPair(each.body, each.to, object);
        if (!positiveOrInfinite().contains(each.stiffness)) fail(object, ": stiffness must be > 0 N/m");
        if (!positiveOrInfinite().contains(each.breakForce)) fail(object, ": breakForce must be > 0 N");
        if (!positiveOrInfinite().contains(each.pointBreakForce))
            fail(object, ": pointBreakForce must be > 0 N, got ", each.pointBreakForce);
        if (!(each.cutDistance >= 0.0 && std::isfinite(each.cutDistance)))
            fail(object, ": cutDistance must be >= 0 m, got ", each.cutDistance);
        if (scene.attachmentForces[a].size() != each.pairs.size() + each.turns.size())
            fail(object, ": holding must have one entry per pair and turn");
        for (const Vec3& force : scene.attachmentForces[a])
            if (!isFinite(force)) fail(object, ": holding must be finite");
        for (const auto& pair : each.pairs) {
            checkPoint(pair[0], each.body, object);
            checkPoint(pair[1], each.to, object);
        }
        for (const AttachedTurn& turn : each.turns) checkTurn(turn, each, object);
    }
    for (std::size_t g = 0; g < scene.grasps.size(); ++g) {
        const PendingGrasp& each = scene.grasps[g];
        const std::string object = text("grasp ", each.id.value);
        if (!each.id || (g > 0 && !(scene.grasps[g - 1].id < each.id)))
            fail(object, ": grasps must ascend by their ids, from 1 on");
        checkPair(each.rigid, each.target, object);
        if (!each.target) fail(object, ": must name a target");
        if (findBody(scene, each.rigid)->soft) fail(object, ": only a rigid body can grasp");
        if (!positiveOrInfinite().contains(each.stiffness)) fail(object, ": stiffness must be > 0 N/m");
        if (!positiveOrInfinite().contains(each.breakForce)) fail(object, ": breakForce must be > 0 N");
        const std::size_t elements = scene.rigid[findBody(scene, each.rigid)->index].state.poses.size();
        if (each.mouth) physics::check(*each.mouth, elements, object + ": mouth");
    }
}

void checkContacts(const Scene& scene)
{
    const auto surfaceOf = [&](SurfaceName name) -> const CollisionShape* {
        const auto body = findBody(scene, name.body);
        if (!body) return nullptr;
        const auto& models =
            body->soft ? scene.soft[body->index].model.collision : scene.rigid[body->index].model.collision;
        const auto place = static_cast<std::size_t>(name.model);
        return name.model >= 0 && place < models.size() ? models[place].shape.get() : nullptr;
    };
    for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
        const CachedContact& memory = scene.contacts[c];
        const std::string object = text("contacts[", c, "]");
        const FeaturePair pair = featurePair(memory.feature);
        if (!surfaceOf({memory.first, pair.models[0]}) || !surfaceOf({memory.second, pair.models[1]}))
            fail(object, ": body ", memory.first.value, " or body ", memory.second.value, ": no such surface");
        if (!isFinite(memory.point) || !isFinite(memory.force)) fail(object, ": point and force must be finite");
        const auto key = [](const CachedContact& m) { return std::tuple(m.first, m.second, m.feature); };
        if (c > 0 && key(memory) < key(scene.contacts[c - 1]))
            fail(object, ": contacts must ascend by bodies and feature");
    }
    for (std::size_t s = 0; s < scene.sides.size(); ++s) {
        const SheetSide& kept = scene.sides[s];
        const std::string object = text("sides[", s, "]");
        const CollisionShape *source = surfaceOf(kept.source), *target = surfaceOf(kept.target);
        if (!source || !target)
            fail(object, ": body ", kept.source.body.value, " or body ", kept.target.body.value, ": no such surface");
        const auto isVertex = [](const CollisionShape& shape, int vertex) {
            return vertex >= 0 && static_cast<std::size_t>(vertex) < shape.rest.size();
        };
        if (!isVertex(*source, kept.point)) fail(object, ": point must be a vertex, got ", kept.point);
        for (const int vertex : kept.feature)
            if (vertex != -1 && !isVertex(*target, vertex))
                fail(object, ": feature must consist of vertices or -1, got ", vertex);
        if (kept.side != 1 && kept.side != -1) fail(object, ": side must be 1 or -1, got ", kept.side);
        if (s > 0 && kept < scene.sides[s - 1]) fail(object, ": sides must ascend");
    }
}

} // namespace filasofia::engine

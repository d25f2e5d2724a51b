#include "filasofia/physics/registry.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/validate.h"
#include "filasofia/math/rounded.h"
#include "filasofia/physics/articulation.h"
#include "filasofia/physics/check_attachment.h"
#include "filasofia/physics/check_clip.h"
#include "filasofia/physics/check_field.h"
#include "filasofia/physics/check_mouth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::physics {

namespace {

/// The mesh of a soft body. Only in a recording that was tampered with it is the name of a file.
const geometry::TetMesh& meshOf(const BodyDef& def)
{
    const auto* mesh = std::get_if<std::shared_ptr<const geometry::TetMesh>>(&std::get<SoftBodyDef>(def).mesh);
    if (!mesh) fail(describeBody(def), ": mesh must be a mesh to have its tissue changed, is the name of a file");
    return **mesh;
}

/// The regions of a material that have a density of their own, with labels by number.
std::vector<TissueRegion> densities(const FemMaterial& material, const BodyDef& def)
{
    std::vector<TissueRegion> out;
    for (std::size_t i = 0; i < material.regions.size(); ++i) {
        if (!material.regions[i].density) continue;
        TissueRegion& each =
            out.emplace_back(TissueRegion{.where = material.regions[i].where, .density = material.regions[i].density});
        resolveNames(meshOf(def), text(describeBody(def), ": material.regions[", i, "].where"), each.where);
    }
    return out;
}

/// The name of the kind of a material.
std::string_view nameOf(const SoftMaterial& material)
{
    return std::visit([](const auto& each) { return fields(&each).typeName; }, material);
}

/// The lengths of a rod.
void measure(const RodBodyDef& def, Registry::Body& body)
{
    const std::vector<Vec3> nodes = centreLine(def);
    const std::size_t count = nodes.size(), edges = def.closed ? count : count - 1;
    const auto edge = [&](std::size_t e) { return distance(nodes[e % count], nodes[(e + 1) % count]); };
    for (std::size_t e = 0; e < edges; ++e) body.length += edge(e);
    for (std::size_t e = def.closed ? 0 : 1; e < edges; ++e)
        body.longestBend = std::max(body.longestBend, 0.5 * (edge(e) + edge(e + count - 1)));
}

} // namespace

std::size_t familiesOf(const SoftMaterial& material)
{
    const auto* fem = std::get_if<FemMaterial>(&material);
    return fem ? fem->fibres.size() : 0;
}

/// One function per kind of command.
struct Registry::Check {
    const Registry& registry;

    void operator()(const AddBody& add) const
    {
        FILASOFIA_ASSERT(add.def != nullptr && add.body != nullptr);
        if (add.id <= registry.last_)
            fail("body ", add.id.value, ": id must be > ", registry.last_.value, ", the last one used, got ",
                 add.id.value);
        checkAttachments(registry, {{}, *add.def, add.body->nodeCount()});
        if (const auto* rigid = std::get_if<RigidBodyDef>(add.def.get())) checkBase(registry, *rigid);
        if (const std::uint32_t count = attachmentCount(*add.def); count > 0) checkFresh(add.attachments, count);
    }
    void operator()(const RemoveBody& remove) const { static_cast<void>(registry.find(remove.id)); }
    void operator()(const SetPose& set) const
    {
        const Body& body = find<RigidBodyDef>(set.id, "must be a rigid body to have its pose set");
        const std::string object = describeBody(*body.def);
        checkElement(set.element, static_cast<std::size_t>(body.nodeCount), object + ": element");
        checkSettable(registry, std::get<RigidBodyDef>(*body.def), set.element);
        validate(set.pose, object);
        static_cast<void>(unitPose(set.pose, object));
    }
    void operator()(const SetJoint& set) const
    {
        const Body& body = find<RigidBodyDef>(set.id, "must be a rigid body to have a joint set");
        checkCommand(std::get<RigidBodyDef>(*body.def), body.takesForce, set);
    }
    void operator()(const SetWrench& set) const
    {
        const Body& body = find<RigidBodyDef>(set.id, "must be a dynamic rigid body to have a wrench set");
        const std::string object = describeBody(*body.def);
        if (!std::get<RigidBodyDef>(*body.def).dynamic)
            fail(object, ": must be a dynamic body to have a wrench set; it is kinematic");
        checkElement(set.element, static_cast<std::size_t>(body.nodeCount), object + ": element");
        validate(set, object);
    }
    void operator()(const SetHaptic& set) const
    {
        const Body& body = find<RigidBodyDef>(set.id, "must be a rigid body to be held by a hand");
        const std::string object = describeBody(*body.def);
        checkElement(set.element, static_cast<std::size_t>(body.nodeCount), object + ": element");
        validate(set, object);
        const auto& def = std::get<RigidBodyDef>(*body.def);
        if (def.dynamic && !def.articulation.joints.empty())
            fail(object, ": must not be a dynamic body with joints to be held by a hand; attach its base to a body "
                         "that the hand "
                         "holds");
        checkSettable(registry, def, set.element);
        static_cast<void>(unitPose(set.target.pose, object + ": target.pose"));
        for (const Vec3 v : {set.target.velocity, set.target.angularVelocity})
            if (!(length(v) < kFarthest))
                fail(object, ": target: velocity and angularVelocity must have a length < ", kFarthest,
                     " m/s and rad/s, got ", v.x, " ", v.y, " ", v.z);
    }
    void operator()(const SetGravity& set) const
    {
        const Vec3 g = set.gravity;
        if (!isFinite(g)) fail("physics server: gravity must be finite, got ", g.x, " ", g.y, " ", g.z);
        validate(set, "physics server");
    }
    void operator()(const SetMaterial& set) const
    {
        const Body& body = registry.find(set.id);
        if (set.body) return; // it was checked before it was built
        registry.checkMaterial(set.id, set.material);
        if (const auto* fem = std::get_if<FemMaterial>(&set.material))
            physics::check(*fem, meshOf(*body.def), describeBody(*body.def) + ": material");
    }
    void operator()(const SetTissue& set) const
    {
        const Body& body = find<SoftBodyDef>(set.id, "must be a soft body to have its tissue changed");
        const std::string object = describeBody(*body.def) + ": region";
        validate(set.region, object);
        if (set.factors) validate(*set.factors, describeBody(*body.def) + ": factors");
        const auto& def = std::get<SoftBodyDef>(*body.def);
        if (!std::holds_alternative<FemMaterial>(def.material))
            fail(object, ": the body's material must be a FemMaterial, is a ", nameOf(def.material));
        if (set.region.tearingThreshold && !def.dynamicTopology)
            fail(object, ".tearingThreshold needs a body with dynamicTopology");
        if (set.region.density) fail(object, ".density cannot change during a run, got ", *set.region.density);
        const auto* box = std::get_if<geometry::Box>(&set.region.where);
        if (box && geometry::isEmpty(*box)) fail(object, ".where: high must be >= low in every axis of a box");
        if (!isPlace(set.region.where))
            static_cast<void>(tetrahedraOf(set.region.where, meshOf(*body.def), object + ".where"));
    }
    void operator()(const SetFibreStress& set) const
    {
        const Body& body = find<SoftBodyDef>(set.id, "must be a soft body to have the stress of its fibres set");
        const std::string object = describeBody(*body.def);
        validate(set, object);
        if (static_cast<std::size_t>(set.family) >= body.families)
            fail(object, ": family must be in [0, ", body.families, "), the number of its families of fibres, got ",
                 set.family);
    }
    void operator()(const SetCavity& set) const
    {
        const Body& body = find<SoftBodyDef>(set.id, "must be a soft body to have a cavity filled");
        const std::string object = describeBody(*body.def);
        validate(set, object);
        const auto& cavities = std::get<SoftBodyDef>(*body.def).cavities;
        const auto count = static_cast<int>(cavities.size());
        if (count == 0) fail(object, ": has no cavities, got cavity ", set.cavity);
        if (set.cavity < 0 || set.cavity >= count)
            fail(object, ": cavity must be in [0, ", count, "), the number of its cavities, got ", set.cavity);
        if (set.inflow && cavities[static_cast<std::size_t>(set.cavity)].fill == CavityFill::Source)
            fail(object, ": inflow cannot be set for cavities[", set.cavity, "]: its pressure is that of a source");
        if (set.pressure)
            checkPressure(cavities[static_cast<std::size_t>(set.cavity)], *set.pressure, object + ": pressure");
        if (!set.pressure && !set.inflow) fail(object, ": SetCavity must give a pressure or an inflow");
    }
    void operator()(const SetCurvature& set) const
    {
        const Body& body = find<RodBodyDef>(set.id, "must be a rod to have its curvature commanded");
        const std::string object = describeBody(*body.def);
        validate(set, object);
        constexpr double kRounding = 1e-9;
        for (std::size_t i = 0; i < set.sections.size(); ++i) {
            const RodSection& section = set.sections[i];
            const std::string name = text(object, ": sections[", i, "]");
            if (!(section.begin < body.length))
                fail(name, ".begin must be in [0, ", body.length, ") m, the rod's length, got ", section.begin);
            if (i > 0 && std::isinf(set.sections[i - 1].end) && section.begin > set.sections[i - 1].begin)
                fail(object, ": sections[", i - 1, "].end must be given, at most ", section.begin,
                     " m: without it the section ends with the rod and overlaps sections[", i, "]");
            if (i > 0 && !(section.begin >= set.sections[i - 1].end))
                fail(name, ".begin must be >= ", set.sections[i - 1].end, " m, where sections[", i - 1, "] ends, got ",
                     section.begin);
            if (!(section.end > section.begin))
                fail(name, ".end must be > begin, ", section.begin, " m, got ", section.end);
            if (std::isfinite(section.end) && section.end > (1.0 + kRounding) * body.length)
                fail(name, ".end must be at most ", body.length, " m, the rod's length, got ", section.end);
            const double size = std::hypot(section.curvature[0], section.curvature[1]);
            if (!(size * body.longestBend <= (1.0 + kRounding) * kMostTurnPerNode))
                fail(name, ".curvature must be at most ", advised(kMostTurnPerNode / body.longestBend), " 1/m, ",
                     kMostTurnPerNode, " rad per node, got ", size);
        }
    }
    void operator()(const SetCutting& set) const
    {
        const Body& body = find<RigidBodyDef>(set.id, "must be a rigid body to have its blades switched");
        const auto& models = std::get<RigidBodyDef>(*body.def).collision;
        if (std::ranges::none_of(models, &CollisionDef::cutting))
            fail(describeBody(*body.def), ": has no blade to switch: none of its ", models.size(),
                 " collision models has cutting set");
    }
    void operator()(const SetForces& set) const
    {
        const Body& body =
            find<SoftBodyDef, RodBodyDef>(set.id, "must be a soft body or a rod to have nodal forces set");
        const std::string object = describeBody(*body.def);
        for (std::size_t i = 0; i < set.forces.size(); ++i) {
            validate(set.forces[i], text(object, ": forces[", i, "]"));
            if (const int node = set.forces[i].node; node >= body.nodeCount)
                fail(object, ": forces[", i, "].node must be in [0, ", body.nodeCount, "), got ", node);
        }
    }
    void operator()(const SetPressure& set) const
    {
        const Body& body = find<SoftBodyDef>(set.id, "must be a soft body to have its pressure set");
        if (!std::isfinite(set.pressure))
            fail(describeBody(*body.def), ": pressure must be finite, got ", set.pressure);
        validate(set, describeBody(*body.def));
    }
    void operator()(const Attach& attach) const
    {
        const Body& body = find<SoftBodyDef, RodBodyDef>(
            attach.body, "attachment must be a RigidAttachmentDef for a rigid body, got an AttachmentDef");
        checkAttachment(registry, {attach.body, *body.def, body.nodeCount}, attach.def,
                        describeBody(*body.def) + ": attachment");
        checkFresh(attach.id);
    }
    void operator()(const AttachRigid& attach) const
    {
        const Body& body = find<RigidBodyDef>(
            attach.body, "attachment must be an AttachmentDef for a soft body, got a RigidAttachmentDef");
        checkAttachment(registry, {attach.body, *body.def, body.nodeCount}, attach.def,
                        describeBody(*body.def) + ": attachment");
        checkFresh(attach.id);
    }
    void operator()(const Release& release) const
    {
        if (!release.id || release.id > std::max(registry.lastAttachment_, registry.known_))
            fail("attachment ", release.id.value, ": no such attachment (it was never made)");
    }
    void operator()(const RemovePiece& remove) const
    {
        const Body& body =
            find<SoftBodyDef, RodBodyDef>(remove.id, "must be a soft body or a rod to have a piece removed");
        const std::string object = describeBody(*body.def);
        validate(remove, object);
        const auto* rod = std::get_if<RodBodyDef>(body.def.get());
        if (!(rod ? rod->dynamicTopology : std::get<SoftBodyDef>(*body.def).dynamicTopology))
            fail(object, ": piece ", remove.piece, " cannot be removed; without dynamicTopology a body has no pieces");
    }
    void operator()(const Grasp& grasp) const
    {
        const Body& body = find<RigidBodyDef>(grasp.rigid, "must be a rigid body to grasp");
        const std::string object = describeBody(*body.def) + ": grasp";
        if (grasp.target == grasp.rigid) fail(object, ": target must be another body, got the grasping body itself");
        const Body& target = registry.find(grasp.target);
        validate(grasp.def, object);
        if (grasp.def.mouth)
            physics::check(*grasp.def.mouth, static_cast<std::size_t>(body.nodeCount), object + ": mouth");
        const auto* other = std::get_if<RigidBodyDef>(target.def.get());
        if (other && !other->dynamic && !std::get<RigidBodyDef>(*body.def).dynamic)
            fail(object, " must have a dynamic or soft body on one side; both are kinematic");
        checkFresh(grasp.id);
    }
    void operator()(const ApplyClip& clip) const
    {
        const Body& body = find<RigidBodyDef>(clip.rigid, "must be a rigid body to be a clip");
        const std::string object = describeBody(*body.def) + ": clip";
        physics::check(clip.def, object);
        if (!std::get<RigidBodyDef>(*body.def).dynamic) fail(object, " must be a dynamic body; it is kinematic");
        if (clip.def.element >= body.nodeCount)
            fail(object, ".element must be in [0, ", body.nodeCount, "), got ", clip.def.element);
        const Body& tissue = find<SoftBodyDef>(clip.target, "must be a soft body to be clipped");
        checkClipped(std::get<SoftBodyDef>(*tissue.def), describeBody(*tissue.def));
        checkFresh(clip.id);
    }
    void operator()(const Reset&) const {}
    void operator()(const Pause&) const {}
    void operator()(const Tune& tune) const
    {
        if (!tune.change) fail("tune: change must be a function, got nothing");
    }

private:
    /// Checks the first of `count` > 0 new ids. A damaged recording may name any number.
    void checkFresh(AttachmentId first, std::uint32_t count = 1) const
    {
        if (!registry.areFree(first, count))
            fail("attachment ", first.value, ": id must be > ", registry.lastAttachment_.value,
                 ", the last one used, got ", first.value);
        constexpr std::uint32_t maxId = std::numeric_limits<std::uint32_t>::max();
        if (first.value > maxId - (count - 1))
            fail("attachment ", first.value, ": id must be <= ", maxId - (count - 1), " to leave room for ", count,
                 " ids, got ", first.value);
    }

    /// The body of an id, which must be of one of these kinds.
    template <class... Def> const Body& find(BodyId id, const char* what) const
    {
        const Body& body = registry.find(id);
        if (!(std::holds_alternative<Def>(*body.def) || ...)) fail(describeBody(*body.def), ": ", what);
        return body;
    }
};

void Registry::check(const Command& command) const { std::visit(Check{*this}, command); }

void Registry::checkMaterial(BodyId id, const SoftMaterial& material) const
{
    const Body& body = find(id);
    const std::string object = describeBody(*body.def);
    const auto* soft = std::get_if<SoftBodyDef>(body.def.get());
    if (!soft) fail(object, ": must be a soft body to have its material set");
    std::visit([&](const auto& each) { validate(each, object); }, material);
    if (material.index() != soft->material.index())
        fail(object, ": material must be of the kind that the body was made with");
    const auto* fem = std::get_if<FemMaterial>(&material);
    if (fem && densities(*fem, *body.def) != densities(std::get<FemMaterial>(soft->material), *body.def))
        fail(object, ": material.regions must give the densities that the body was made with: mass cannot change");
    const auto* shell = std::get_if<ShellMaterial>(&material);
    if (shell && shell->thickness != std::get<ShellMaterial>(soft->material).thickness)
        fail(object, ": material.thickness must be ", std::get<ShellMaterial>(soft->material).thickness,
             " m, with which the body was made: mass cannot change; got ", shell->thickness);
    SoftBodyDef def = *soft;
    def.material = material;
    const bool bendsNow =
        shell && shell->bendingScale > 0.0 && std::get<ShellMaterial>(soft->material).bendingScale == 0.0;
    if (bendsNow) static_cast<void>(loadShell(def)); // a membrane may be folded, a shell that bends may not
    physics::check(BodyDef{std::move(def)});
}

std::shared_ptr<Registry::Body> Registry::bodyOf(const AddBody& add)
{
    const auto* soft = std::get_if<SoftBodyDef>(add.def.get());
    auto body = std::make_shared<Body>(Body{.def = add.def,
                                            .nodeCount = add.body->nodeCount(),
                                            .firstAttachment = add.attachments,
                                            .takesForce = forceable(*add.def),
                                            .families = soft ? familiesOf(soft->material) : 0});
    if (const auto* rod = std::get_if<RodBodyDef>(add.def.get())) measure(*rod, *body);
    return body;
}

bool Registry::areFree(AttachmentId first, std::uint32_t count) const
{
    if (first > lastAttachment_) return true;
    auto range = free_.upper_bound(first.value);
    if (range == free_.begin()) return false;
    --range;
    return first.value <= range->second && count - 1 <= range->second - first.value;
}

void Registry::noteAttachments(AttachmentId first, std::uint32_t count)
{
    const std::uint32_t last = first.value + (count - 1);
    if (first > lastAttachment_) {
        if (first.value > lastAttachment_.value + 1) free_[lastAttachment_.value + 1] = first.value - 1;
        lastAttachment_ = {last};
        return;
    }
    const auto range = std::prev(free_.upper_bound(first.value));
    const auto [from, to] = *range;
    free_.erase(range);
    if (from < first.value) free_[from] = first.value - 1;
    if (last < to) free_[last + 1] = to;
}

void Registry::note(const Command& command, std::shared_ptr<const Body> added)
{
    if (const auto* add = std::get_if<AddBody>(&command)) {
        bodies_[add->id] = added ? std::move(added) : bodyOf(*add);
        last_ = add->id;
        if (const std::uint32_t count = attachmentCount(*add->def); count > 0) noteAttachments(add->attachments, count);
    } else if (const auto* set = std::get_if<SetMaterial>(&command)) {
        noteFamilies(set->id, familiesOf(set->material));
    } else if (const auto* remove = std::get_if<RemoveBody>(&command)) {
        if (const auto found = bodies_.find(remove->id); found != bodies_.end()) {
            gone_[remove->id] = {bodyName(remove->id), describeBody(*found->second->def)};
            bodies_.erase(found);
        }
    } else if (const auto* attach = std::get_if<Attach>(&command)) {
        noteAttachments(attach->id, 1);
    } else if (const auto* rigid = std::get_if<AttachRigid>(&command)) {
        noteAttachments(rigid->id, 1);
    } else if (const auto* grasp = std::get_if<Grasp>(&command)) {
        noteAttachments(grasp->id, 1);
    } else if (const auto* clip = std::get_if<ApplyClip>(&command)) {
        noteAttachments(clip->id, 1);
    }
}

void Registry::noteFamilies(BodyId id, std::size_t families)
{
    auto changed = std::make_shared<Body>(find(id));
    changed->families = families;
    bodies_[id] = std::move(changed);
}

std::uint32_t attachmentCount(const BodyDef& def)
{
    return std::visit([](const auto& each) { return static_cast<std::uint32_t>(each.attachments.size()); }, def);
}

const Registry::Body& Registry::find(BodyId id) const
{
    const auto found = bodies_.find(id);
    if (found == bodies_.end()) failMissing(id);
    return *found->second;
}

void Registry::failMissing(BodyId id, std::string_view before) const
{
    if (const auto gone = gone_.find(id); gone != gone_.end())
        fail(before, gone->second.described, " (body ", id.value, "): no such body any more: it was removed");
    fail(before, "body ", id.value, ": no such body (it was never added)");
}

std::string Registry::bodyName(BodyId id) const
{
    if (const auto found = bodies_.find(id); found != bodies_.end())
        return std::visit([](const auto& each) { return each.name; }, *found->second->def);
    const auto gone = gone_.find(id);
    return gone != gone_.end() ? gone->second.name : text("body ", id.value);
}

std::vector<BodyId> Registry::bodies() const
{
    std::vector<BodyId> ids;
    for (const auto& [id, body] : bodies_) ids.push_back(id);
    return ids;
}

std::size_t Registry::softBodyCount() const
{
    return static_cast<std::size_t>(
        std::count_if(bodies_.begin(), bodies_.end(), [](const auto& each) { return !isRigid(*each.second->def); }));
}

std::size_t Registry::dynamicElementCount() const
{
    std::size_t count = 0;
    for (const auto& [id, body] : bodies_)
        if (const auto* rigid = std::get_if<RigidBodyDef>(body->def.get());
            rigid && (rigid->dynamic || isArticulated(*rigid)))
            count += static_cast<std::size_t>(body->nodeCount);
    return count;
}

std::string Registry::differenceFrom(const Registry& saved) const
{
    if (bodies() != saved.bodies()) return "bodies were added or removed since the state was saved";
    for (const auto& [id, body] : bodies_) {
        const Body& before = *saved.bodies_.at(id);
        if (describeBody(*body->def) != describeBody(*before.def) || body->nodeCount != before.nodeCount)
            return text("the state has ", describeBody(*before.def), " with ", before.nodeCount, " nodes in place of ",
                        describeBody(*body->def), " with ", body->nodeCount);
    }
    return {};
}

} // namespace filasofia::physics

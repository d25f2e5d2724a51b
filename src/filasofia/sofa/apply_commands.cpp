#include "filasofia/sofa/apply_commands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/sofa/cut_bodies.h"
#include "filasofia/sofa/make_tie.h"
#include "filasofia/sofa/node_removal.h"
#include "filasofia/sofa/scene_state.h"
#include "filasofia/sofa/sofa_process.h"

#include <algorithm>
#include <optional>

namespace filasofia::sofaengine {
namespace {

using physics::Command;
using physics::StepFlag;

/// One function per kind of command. Commands that checkCommand() refuses never arrive.
struct ApplyCommand {
    physics::PhysicsEngine& self;
    SofaScene& scene;
    physics::StepReport& report;

    void operator()(physics::AddBody& add) const
    {
        const std::unique_ptr<physics::BuiltBody> body = std::move(add.body);
        if (auto* soft = dynamic_cast<PlannedSoft*>(body.get())) {
            for (PinGroup& group : soft->plan.pins) group.id.value += add.attachments.value;
            startContact(soft->plan.collision, scene);
            auto made = std::make_unique<SoftNode>(add.id, std::move(soft->plan), *scene.root, scene.contact);
            if (made->plan().def.dynamicTopology)
                made->setCuts(std::make_unique<SoftCuts>(made->plan()), made->settings().tissue);
            scene.soft.push_back(std::move(made));
            tieAll(add, scene.soft.back()->plan().def.attachments);
        } else if (auto* rigid = dynamic_cast<PlannedRigid*>(body.get())) {
            startContact(rigid->plan.collision, scene);
            if (isDriven(rigid->plan.def)) startConstraints(scene);
            scene.rigid.push_back(
                std::make_unique<RigidNode>(add.id, std::move(rigid->plan), *scene.root, scene.contact));
            tieAll(add, scene.rigid.back()->plan().def.attachments);
        }
    }
    void operator()(const physics::RemoveBody& remove) const
    {
        std::optional<PartedSlaves> parted; // before its contacts go
        if (const SoftNode* body = findBody(scene.soft, remove.id)) parted.emplace(body->node());
        scene.contact.forget();
        std::erase_if(scene.ties, [&](const auto& each) { return each->holds(remove.id); });
        std::erase_if(scene.grasps,
                      [&](const auto& each) { return each.rigid == remove.id || each.target == remove.id; });
        const auto isIt = [&](const auto& each) { return each->id() == remove.id; };
        std::erase_if(scene.soft, isIt);
        std::erase_if(scene.rigid, isIt);
        std::erase_if(scene.contacts, [&](const FoundContact& each) {
            return each.contact.first == remove.id || each.contact.second == remove.id;
        });
    }
    void operator()(const physics::SetPose& set) const { rigid(set.id)->setPose(set.element, set.pose); }
    void operator()(const physics::SetWrench& set) const
    {
        rigid(set.id)->setWrench(set.element, {set.force, set.torque});
    }
    void operator()(const physics::SetHaptic& set) const { rigid(set.id)->setHand(set.element, set.target); }
    void operator()(const physics::SetJoint& set) const
    {
        RigidNode& body = *rigid(set.id);
        if (std::holds_alternative<physics::JointForce>(set.command)) startConstraints(scene);
        body.setJoint(set.joint, set.command);
    }
    void operator()(const physics::SetGravity& set) const { scene.root->setGravity(toSofa(set.gravity)); }
    void operator()(physics::SetMaterial& set) const
    {
        auto* built = dynamic_cast<PlannedSoft*>(set.body.get());
        if (!built) return;
        const SoftPlan& plan = built->plan;
        soft(set.id)->setTissue(std::make_shared<const SoftSettings::Tissue>(
            SoftSettings::Tissue{plan.def.material, plan.youngModulus, plan.poissonRatio, plan.tearing}));
    }
    void operator()(const physics::SetForces& set) const { soft(set.id)->loads().forces = set.forces; }
    void operator()(const physics::SetPressure& set) const { soft(set.id)->loads().pressure = set.pressure; }
    void operator()(const physics::AttachRigid& attach) const
    {
        addTie(attach.id, rigid(attach.body)->id(), attach.def, scene);
    }
    void operator()(const physics::Grasp& grasp) const
    {
        // Threads take ids before their commands are queued: they may come slightly out of order.
        scene.grasps.insert(std::ranges::upper_bound(scene.grasps, grasp.id, {}, &physics::Grasp::id), grasp);
    }
    void operator()(const physics::Attach& attach) const
    {
        if (isTie(attach.def)) {
            if (!addTie(attach.id, soft(attach.body)->id(), attach.def, scene))
                nothingAttached({.id = attach.id, .body = attach.body, .to = attach.def.to});
            return;
        }
        SoftNode& body = *soft(attach.body);
        SoftState now;
        body.read(now);
        PinGroup group{.id = attach.id, .nodes = nodesOf(attach.def, now.positions), .stiffness = attach.def.stiffness};
        const std::vector<char> gone = goneNodes(body.plan());
        std::erase_if(group.nodes, [&](int node) { return gone[static_cast<std::size_t>(node)] != 0; });
        if (group.nodes.empty()) {
            nothingAttached({.id = attach.id, .body = attach.body});
            return;
        }
        for (const int node : group.nodes) group.places.push_back(now.positions[static_cast<std::size_t>(node)]);
        std::vector<PinGroup> pins = body.pins();
        pins.push_back(std::move(group));
        body.setPins(std::move(pins));
    }
    void operator()(const physics::Release& release) const
    {
        std::erase_if(scene.ties, [&](const auto& each) { return each->id() == release.id; });
        std::erase_if(scene.grasps, [&](const auto& each) { return each.id == release.id; });
        for (const auto& body : scene.soft) {
            std::vector<PinGroup> pins = body->pins();
            if (std::erase_if(pins, [&](const PinGroup& each) { return each.id == release.id; }) > 0)
                body->setPins(std::move(pins));
        }
    }
    void operator()(const physics::Reset&) const { resetScene(scene); }
    void operator()(const physics::SetCutting& set) const
    {
        RigidNode& tool = *rigid(set.id);
        if (set.cutting == tool.isCutting()) return;
        tool.setBlades(set.cutting, set.cutting ? 0 : engine::sheathOf(elementsAtBlades(tool, scene)));
    }
    void operator()(const physics::RemovePiece& remove) const
    {
        const Removal done = soft(remove.id)->cuts() ? removePieceOf(remove.id, remove.piece, scene) : Removal::NoPiece;
        report.topology.noPiece += done == Removal::NoPiece ? 1 : 0;
        if (done == Removal::Failed) report.set(StepFlag::TuneRejected);
    }
    void operator()(const physics::Pause&) const {} // the server steps with dt = 0
    void operator()(const physics::Tune& tune) const
    {
        report.set(StepFlag::Tuned);
        const SceneState before = stateOf(scene);
        const auto change = [&] {
            tune.change(self);
            if (!isUsable(scene)) fail("it left numbers that are not finite, or too large");
        };
        if (attempt("tune", change)) return;
        report.set(StepFlag::TuneRejected);
        attempt("tune", [&] { setState(before, scene); }); // components that it added or changed stay
    }
    template <class Refused> void operator()(const Refused&) const {} // see checkCommand()

private:
    void nothingAttached(const physics::NothingHeld& held) const
    {
        report.set(StepFlag::NothingAttached);
        report.nothingHeld.push_back(held);
        logWarning("soft body '", soft(held.body)->plan().def.name, "': an attachment found no node");
    }
    /// The attachments of a new body's Def that are no pins.
    template <class Def> void tieAll(const physics::AddBody& add, const std::vector<Def>& defs) const
    {
        for (std::size_t i = 0; i < defs.size(); ++i) {
            const AttachmentId id{add.attachments.value + static_cast<std::uint32_t>(i)};
            if constexpr (std::is_same_v<Def, physics::AttachmentDef>)
                if (!isTie(defs[i])) continue;
            if (!addTie(id, add.id, defs[i], scene)) nothingAttached({.id = id, .body = add.id, .to = defs[i].to});
        }
    }
    /// Throws an Error if SOFA could not make the body.
    template <class Body> static Body* made(Body* body, BodyId id)
    {
        if (!body) fail("body ", id.value, " could not be made when it was added");
        return body;
    }
    [[nodiscard]] SoftNode* soft(BodyId id) const { return made(findBody(scene.soft, id), id); }
    [[nodiscard]] RigidNode* rigid(BodyId id) const { return made(findBody(scene.rigid, id), id); }
};

/// The command's name, if this engine has no such command at all.
struct Missing {
    const char* operator()(const physics::SetTissue&) const { return "SetTissue"; }
    const char* operator()(const physics::SetFibreStress&) const { return "SetFibreStress"; }
    const char* operator()(const physics::SetCavity&) const { return "SetCavity"; }
    const char* operator()(const physics::SetCurvature&) const { return "SetCurvature"; }
    const char* operator()(const physics::ApplyClip&) const { return "ApplyClip"; }
    template <class Known> const char* operator()(const Known&) const { return nullptr; }
};

} // namespace

std::unique_ptr<physics::BuiltBody> planBody(const physics::BodyDef& def)
{
    if (const auto* soft = std::get_if<physics::SoftBodyDef>(&def)) {
        auto planned = std::make_unique<PlannedSoft>();
        planned->plan = planSoft(*soft);
        return planned;
    }
    if (const auto* rigid = std::get_if<physics::RigidBodyDef>(&def)) {
        auto planned = std::make_unique<PlannedRigid>();
        planned->plan = planRigid(*rigid);
        return planned;
    }
    fail(describeBody(def), ": a rod is not available with the engine 'sofa'");
}

void checkCommand(const Command& command, const physics::BodyDef* def)
{
    const std::string object = def ? describeBody(*def) : std::string("physics");
    if (const char* name = std::visit(Missing{}, command))
        fail(object, ": ", name, " is not available with the engine 'sofa'");
}

void applyCommands(std::span<Command> commands, physics::PhysicsEngine& self, SofaScene& scene,
                   physics::StepReport& report)
{
    for (Command& command : commands)
        if (!attempt("SOFA: a command failed", [&] { std::visit(ApplyCommand{self, scene, report}, command); }))
            report.set(StepFlag::TuneRejected);
}

} // namespace filasofia::sofaengine

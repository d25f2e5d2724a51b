#include "filasofia/scene/commands.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/command_trial.h"
#include "filasofia/physics/give.h"
#include "filasofia/scene/has_come.h"
#include "filasofia/scene/pedals.h"
#include "filasofia/scene/remember_past.h"
#include "filasofia/scene/scene_numbers.h"

#include <algorithm>

namespace filasofia::scene {
namespace {

/// The body that a command is for, and its kind.
struct Target {
    BodyId body = {};
    std::optional<bool> soft = {}; ///< not given: any
};

struct TargetOf {
    Target operator()(const physics::Attach& c) const { return {c.body, true}; }
    Target operator()(const physics::AttachRigid& c) const { return {c.body, false}; }
    Target operator()(const physics::Grasp& c) const { return {c.rigid, false}; }
    Target operator()(const physics::ApplyClip& c) const { return {c.rigid, false}; }
    Target operator()(const physics::RemovePiece& c) const { return {c.id, true}; }
    Target operator()(const physics::RemoveBody& c) const { return {c.id, {}}; }
    Target operator()(const physics::SetForces& c) const { return {c.id, true}; }
    Target operator()(const physics::SetWrench& c) const { return {c.id, false}; }
    Target operator()(const physics::SetPressure& c) const { return {c.id, true}; }
    Target operator()(const physics::SetFibreStress& c) const { return {c.id, true}; }
    Target operator()(const physics::SetCurvature& c) const { return {c.id, true}; }
    Target operator()(const physics::SetCutting& c) const { return {c.id, false}; }
    Target operator()(const physics::SetCavity& c) const { return {c.id, true}; }
    Target operator()(const physics::SetTissue& c) const { return {c.id, true}; }
    Target operator()(const SetMaterial& c) const { return {c.id, true}; }
    Target operator()(const Treat& c) const { return {c.id, true}; }
    Target operator()(const Activate& c) const { return {c.id, false}; }
    Target operator()(const surface::Extract& c) const { return {c.body, false}; }
    Target operator()(const physics::SetPose& c) const { return {c.id, false}; }
    Target operator()(const physics::SetJoint& c) const { return {c.id, false}; }
    Target operator()(const physics::SetHaptic& c) const { return {c.id, false}; }
    Target operator()(const surface::Distend&) const { return {}; }
    Target operator()(const physics::Reset&) const { return {}; }
    Target operator()(const physics::Release&) const { return {}; }
    Target operator()(const physics::SetGravity&) const { return {}; }
};

/// Gives each command as soon as its time has come.
class CommandFollower {
public:
    CommandFollower(runtime::Simulation& simulation, std::vector<TimedCommand> commands, std::vector<BodyId> ids,
                    std::map<AttachmentId, AttachmentId> attachments)
        : simulation_(simulation), commands_(std::move(commands)),
          ids_(std::move(ids)), past_{.attachments = std::move(attachments)}
    {
    }

    void give(double time)
    {
        for (std::size_t& next = past_.next; next < commands_.size() && hasCome(commands_[next].time, time); ++next)
            try {
                std::visit([this](const auto& each) { give(each); }, commands_[next].command);
            } catch (const Error& error) {
                fail(commands_[next].place, ": ", error.what());
            }
    }

    /// What saved states have of it.
    struct Past {
        std::map<AttachmentId, AttachmentId> attachments; ///< by their numbers in the scene
        std::size_t next = 0;                             ///< the command that comes next
    };
    [[nodiscard]] const Past& past() const { return past_; }
    void goBack(const Past& past) { past_ = past; }

private:
    template <class Command> void give(Command command)
    {
        physics::PhysicsServer& server = simulation_.physics();
        AttachmentId number;
        if constexpr (requires { command.def; }) number = command.id; // it makes an attachment
        SceneNumbers(ids_, &past_.attachments).replaceIn(command);
        if constexpr (std::is_same_v<Command, SetMaterial>)
            server.setMaterial(command.id, command.material);
        else if constexpr (std::is_same_v<Command, Treat>)
            simulation_.treat(command.id, command.treatment);
        else if constexpr (std::is_same_v<Command, Activate>)
            simulation_.activate(command.id, command.on, command.electrode);
        else if constexpr (std::is_same_v<Command, surface::Extract>)
            simulation_.extract(command);
        else if constexpr (std::is_same_v<Command, surface::Distend>)
            simulation_.distend(command);
        else if constexpr (std::is_same_v<Command, physics::Reset>)
            simulation_.reset(); // removes the paint, too
        else if (const AttachmentId made = physics::give(server, command))
            past_.attachments[number] = made;
    }

    runtime::Simulation& simulation_;
    std::vector<TimedCommand> commands_;
    std::vector<BodyId> ids_;
    Past past_;
};

/// Tries what the commands ask for, one after the other, so that none fails in the run that can be seen to fail now.
class CommandCheck {
public:
    CommandCheck(runtime::Simulation& simulation, const std::vector<BodyId>& ids,
                 std::map<AttachmentId, AttachmentId> attachments)
        : simulation_(simulation), trial_(simulation.physics()), ids_(ids), attachments_(std::move(attachments))
    {
    }

    void give(const TimedCommand& command)
    {
        try {
            std::visit([this](auto each) { give(std::move(each)); }, command.command);
        } catch (const Error& error) {
            fail(command.place, ": ", error.what());
        }
    }

private:
    template <class Command> void give(Command command)
    {
        AttachmentId number;
        if constexpr (requires { command.def; }) number = command.id;
        SceneNumbers(ids_, &attachments_).replaceIn(command);
        if constexpr (std::is_same_v<Command, SetMaterial>)
            trial_.give(physics::SetMaterial{command.id, std::move(command.material), {}});
        else if constexpr (std::is_same_v<Command, Activate>)
            trial_.mustBeThere(command.id);
        else if constexpr (std::is_same_v<Command, Treat>) {
            trial_.mustBeThere(command.id);
            simulation_.checkTreat(command.id, command.treatment);
        } else if constexpr (std::is_same_v<Command, surface::Extract>) {
            if (command.body) trial_.mustBeThere(command.body);
            simulation_.checkExtract(command);
        } else if constexpr (std::is_same_v<Command, surface::Distend>) {
            simulation_.checkDistend(command);
        } else if (const AttachmentId made = trial_.give(std::move(command)))
            attachments_[number] = made;
    }

    const runtime::Simulation& simulation_;
    physics::CommandTrial trial_;
    const std::vector<BodyId>& ids_;
    std::map<AttachmentId, AttachmentId> attachments_; ///< by their numbers in the scene
};

} // namespace

void followCommands(runtime::Simulation& simulation, std::vector<TimedCommand> commands, const std::vector<BodyId>& ids)
{
    if (commands.empty()) return;
    physics::PhysicsServer& server = simulation.physics();
    for (const TimedCommand& each : commands) {
        Target target = std::visit(TargetOf(), each.command);
        SceneNumbers(ids).replaceIn(target.body);
        if (!target.body) continue;
        const physics::BodyDef& def = *server.def(target.body);
        if (target.soft && *target.soft == physics::isRigid(def))
            fail(each.place, ": needs a ", *target.soft ? "soft" : "rigid", " body, got ", physics::describeBody(def));
        if (const auto* pedal = std::get_if<Activate>(&each.command))
            checkElectrode(simulation, target.body, pedal->electrode, each.place);
    }
    std::map<AttachmentId, AttachmentId> attachments;
    for (const BodyId id : ids)
        for (const AttachmentId each : server.attachments(id))
            attachments.emplace(AttachmentId{static_cast<std::uint32_t>(attachments.size()) + 1}, each);
    std::ranges::stable_sort(commands, {}, &TimedCommand::time);
    CommandCheck check(simulation, ids, attachments);
    for (const TimedCommand& each : commands) check.give(each);
    const auto follower =
        std::make_shared<CommandFollower>(simulation, std::move(commands), ids, std::move(attachments));
    simulation.everyStep([follower](double time) { follower->give(time); });
    rememberPast(simulation, "the commands", follower);
}

} // namespace filasofia::scene

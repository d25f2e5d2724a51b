#include "filasofia/sofa/loaded_world.h"

#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/sofa/sofa_process.h"

#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/UpdateMappingVisitor.h>

#include <algorithm>

namespace filasofia::sofaengine {
namespace {

using Lock = std::lock_guard<std::recursive_mutex>;
using ::sofa::core::vec_id::read_access::position;
using ::sofa::core::vec_id::read_access::velocity;

struct PlannedItem final : physics::BuiltBody {
    std::size_t item = 0;
    int nodes = 0;
    [[nodiscard]] int nodeCount() const override { return nodes; }
};

struct LoadedState final : physics::EngineState {
    GraphState graph;
    Vec3 gravity; ///< in the scene's units
    double time = 0.0;
    std::uint64_t steps = 0;
};

const std::string& nameOf(const physics::BodyDef& def)
{
    return std::visit([](const auto& each) -> const std::string& { return each.name; }, def);
}

frame::SoftBodyFrame softFrame(BodyId id, const LoadedItem& item, double unit)
{
    frame::SoftBodyFrame body{.id = id};
    const auto& x = item.soft->read(position)->getValue();
    const auto* speeds = item.picture ? nullptr : item.soft->read(velocity);
    const std::size_t count = item.vertices.empty() ? x.size() : item.vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = item.vertices.empty() ? i : static_cast<std::size_t>(item.vertices[i]);
        body.positions.push_back(unit * fromSofa(x[at]));
        const bool moves = speeds && at < speeds->getValue().size(); // pictures have no velocities
        body.velocities.push_back(moves ? unit * fromSofa(speeds->getValue()[at]) : Vec3{});
    }
    return body;
}

frame::RigidBodyFrame rigidFrame(BodyId id, const ::sofa::core::State<RigidTypes>& state, double unit)
{
    frame::RigidBodyFrame body{.id = id};
    for (const auto& x : state.read(position)->getValue())
        body.poses.push_back({unit * fromSofa(x.getCenter()), fromSofa(x.getOrientation())});
    for (const auto& v : state.read(velocity)->getValue()) {
        body.velocities.push_back(unit * fromSofa(getVCenter(v)));
        body.angularVelocities.push_back(fromSofa(getVOrientation(v)));
    }
    return body;
}

} // namespace

LoadedWorld::LoadedWorld(::sofa::simulation::Node::SPtr root, std::vector<LoadedItem> items, double unit)
    : root_(std::move(root)), items_(std::move(items)), unit_(unit)
{
}

LoadedWorld::~LoadedWorld()
{
    const Lock lock(sofaMutex());
    ::sofa::simulation::node::unload(root_);
    root_.reset();
}

physics::EngineInfo LoadedWorld::info() const { return {.name = "sofa", .version = FILASOFIA_SOFA_VERSION}; }

std::unique_ptr<physics::BuiltBody> LoadedWorld::build(const physics::BodyDef& def) const
{
    const auto found = std::ranges::find(items_, nameOf(def), &LoadedItem::name);
    if (found == items_.end()) fail(describeBody(def), ": a loaded scene of SOFA has no bodies besides its own");
    auto planned = std::make_unique<PlannedItem>();
    planned->item = static_cast<std::size_t>(found - items_.begin());
    if (found->rigid)
        planned->nodes = static_cast<int>(found->rigid->getSize());
    else
        planned->nodes = static_cast<int>(found->vertices.empty() ? found->soft->getSize() : found->vertices.size());
    return planned;
}

void LoadedWorld::check(const physics::Command& command, const physics::BodyDef* def) const
{
    using namespace physics;
    const bool known = std::holds_alternative<AddBody>(command) || std::holds_alternative<RemoveBody>(command) ||
                       std::holds_alternative<SetGravity>(command) || std::holds_alternative<Pause>(command) ||
                       std::holds_alternative<Reset>(command) || std::holds_alternative<Tune>(command);
    if (!known)
        fail(def ? describeBody(*def) : std::string("physics"),
             ": this command is not available for a loaded scene of SOFA: use sofaengine::tune()");
}

physics::StepReport LoadedWorld::step(const physics::StepInput& in)
{
    physics::StepReport report{.dt = in.dt, .flags = in.flags};
    const auto now = [&] { return in.budget && in.budget->now ? in.budget->now() : std::int64_t{0}; };
    const Lock lock(sofaMutex());
    const std::int64_t begin = now();
    apply(in.commands, report);
    if (in.dt > 0.0) {
        advance(in.dt, report);
        ++steps_;
        time_ += in.dt;
    }
    report.times.advance = 1e-9 * static_cast<double>(now() - begin);
    report.step = steps_;
    report.time = time_;
    return report;
}

void LoadedWorld::apply(std::span<physics::Command> commands, physics::StepReport& report)
{
    for (physics::Command& command : commands) {
        if (auto* add = std::get_if<physics::AddBody>(&command))
            seen_.push_back({add->id, dynamic_cast<const PlannedItem&>(*add->body).item});
        if (auto* remove = std::get_if<physics::RemoveBody>(&command))
            std::erase_if(seen_, [&](const Seen& each) { return each.id == remove->id; });
        if (auto* set = std::get_if<physics::SetGravity>(&command)) root_->setGravity(toSofa(set->gravity / unit_));
        if (std::holds_alternative<physics::Reset>(command)) ::sofa::simulation::node::reset(root_.get());
        auto* tune = std::get_if<physics::Tune>(&command);
        if (!tune) continue;
        report.set(physics::StepFlag::Tuned);
        const GraphState before = stateOfGraph(*root_);
        try {
            tune->change(*this);
        } catch (const std::exception& problem) {
            setGraphState(before, *root_); // components that it added or changed stay
            report.set(physics::StepFlag::TuneRejected);
            logError("tune: ", problem.what());
        }
    }
}

void LoadedWorld::advance(double dt, physics::StepReport& report)
{
    const GraphState before = stateOfGraph(*root_);
    root_->setDt(dt);
    ::sofa::simulation::node::updateContext(root_.get());
    if (animate(*root_, dt) && isUsable(stateOfGraph(*root_), unit_)) return;
    setGraphState(before, *root_);
    root_->execute<::sofa::simulation::UpdateMappingVisitor>(::sofa::core::execparams::defaultInstance());
    report.set(physics::StepFlag::Undone);
}

void LoadedWorld::capture(frame::Frame& out) const
{
    const Lock lock(sofaMutex());
    out.step = steps_;
    out.time = time_;
    out.softBodies.clear();
    out.rigidBodies.clear();
    for (const auto& [id, item] : seen_)
        if (items_[item].soft)
            out.softBodies.push_back(softFrame(id, items_[item], unit_));
        else
            out.rigidBodies.push_back(rigidFrame(id, *items_[item].rigid, unit_));
    out.contacts.clear();
    out.attachments.clear();
    out.channels.clear();
}

void LoadedWorld::record(physics::StepRecord& out) const
{
    const Lock lock(sofaMutex());
    out.rigidPoses.clear();
    for (const auto& [id, item] : seen_) {
        if (!items_[item].rigid) continue;
        const std::vector<Pose> poses = rigidFrame(id, *items_[item].rigid, unit_).poses;
        out.rigidPoses.insert(out.rigidPoses.end(), poses.begin(), poses.end());
    }
    out.contacts.clear();
    out.attachments.clear();
    out.channels.clear();
}

std::uint64_t LoadedWorld::hash() const
{
    const Lock lock(sofaMutex());
    Hasher hasher;
    hasher.add(steps_);
    hasher.add(time_);
    for (const std::vector<double>& each : stateOfGraph(*root_)) hasher.addAll(std::span<const double>(each));
    return hasher.value();
}

std::shared_ptr<const physics::EngineState> LoadedWorld::save() const
{
    const Lock lock(sofaMutex());
    auto state = std::make_shared<LoadedState>();
    state->graph = stateOfGraph(*root_);
    state->gravity = fromSofa(root_->getGravity());
    state->time = time_;
    state->steps = steps_;
    return state;
}

void LoadedWorld::restore(const physics::EngineState& saved)
{
    const auto* state = dynamic_cast<const LoadedState*>(&saved);
    if (!state) fail("restore: the state is one of another engine");
    const Lock lock(sofaMutex());
    if (state->graph.size() != stateOfGraph(*root_).size()) fail("restore: the state has other objects");
    setGraphState(state->graph, *root_);
    root_->setGravity(toSofa(state->gravity));
    root_->execute<::sofa::simulation::UpdateMappingVisitor>(::sofa::core::execparams::defaultInstance());
    time_ = state->time;
    steps_ = state->steps;
}

::sofa::simulation::Node* LoadedWorld::nodeOf(BodyId id) const
{
    const auto found = std::ranges::find(seen_, id, &Seen::id);
    if (found == seen_.end()) return nullptr;
    const LoadedItem& item = items_[found->item];
    const ::sofa::core::BaseState* state = item.soft;
    if (!state) state = item.rigid;
    return dynamic_cast<::sofa::simulation::Node*>(
        const_cast<::sofa::core::objectmodel::BaseContext*>(state->getContext()));
}

} // namespace filasofia::sofaengine

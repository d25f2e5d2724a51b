#include "filasofia/sofa/loaded_world.h"

#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/sofa/node_removal.h"
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
    std::vector<ItemElements> elements; ///< per item
    Vec3 gravity;                       ///< in the scene's units
    double time = 0.0;
    std::uint64_t steps = 0;
};

const std::string& nameOf(const physics::BodyDef& def)
{
    return std::visit([](const auto& each) -> const std::string& { return each.name; }, def);
}

std::vector<ItemElements> elementsOf(const std::vector<ItemView>& views)
{
    std::vector<ItemElements> elements;
    for (const ItemView& each : views) elements.push_back(each.elements());
    return elements;
}

/// Whether a state has the objects and the meshes of a graph.
bool fits(const LoadedState& state, ::sofa::simulation::Node& root, const std::vector<ItemView>& views)
{
    const auto sameSize = [](const auto& a, const auto& b) { return a.size() == b.size(); };
    return std::ranges::equal(state.graph, stateOfGraph(root), sameSize) && state.elements == elementsOf(views);
}

std::vector<ItemView> viewsOf(std::vector<LoadedItem> items, double unit, bool cut)
{
    std::vector<ItemView> views;
    for (LoadedItem& each : items) views.emplace_back(std::move(each), unit, cut);
    return views;
}

void updateMappings(::sofa::simulation::Node& root)
{
    root.execute<::sofa::simulation::UpdateMappingVisitor>(::sofa::core::execparams::defaultInstance());
}

} // namespace

LoadedWorld::Graph::~Graph()
{
    views.clear();
    if (root) removeNode(root);
}

LoadedWorld::Graph& LoadedWorld::Graph::operator=(Graph&& other) noexcept
{
    std::swap(root, other.root); // it unloads the old one
    std::swap(views, other.views);
    return *this;
}

LoadedWorld::LoadedWorld(::sofa::simulation::Node::SPtr root, std::vector<LoadedItem> items, LoadDef def)
    : def_(std::move(def))
{
    graph_.root = std::move(root);
    graph_.views = viewsOf(std::move(items), def_.unit, false);
}

LoadedWorld::~LoadedWorld()
{
    const Lock lock(sofaMutex());
    graph_ = {};
}

physics::EngineInfo LoadedWorld::info() const { return {.name = "sofa", .version = FILASOFIA_SOFA_VERSION}; }

std::unique_ptr<physics::BuiltBody> LoadedWorld::build(const physics::BodyDef& def) const
{
    const Lock lock(sofaMutex()); // a step may read the file again
    const auto nameOfView = [](const ItemView& each) { return each.item().name; };
    const auto found = std::ranges::find(graph_.views, nameOf(def), nameOfView);
    if (found == graph_.views.end()) fail(describeBody(def), ": a loaded scene of SOFA has no bodies besides its own");
    auto planned = std::make_unique<PlannedItem>();
    planned->item = static_cast<std::size_t>(found - graph_.views.begin());
    planned->nodes = found->nodeCount();
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
    for (physics::Command& each : in.commands)
        if (!attempt("SOFA: a command failed", [&] { apply(each, report); }))
            report.set(physics::StepFlag::TuneRejected);
    if (in.dt > 0.0) {
        advance(in.dt, report);
        ++steps_;
        time_ += in.dt;
    }
    look();
    report.times.advance = 1e-9 * static_cast<double>(now() - begin);
    report.step = steps_;
    report.time = time_;
    return report;
}

void LoadedWorld::apply(physics::Command& command, physics::StepReport& report)
{
    if (auto* add = std::get_if<physics::AddBody>(&command))
        seen_.push_back({add->id, dynamic_cast<const PlannedItem&>(*add->body).item});
    if (auto* remove = std::get_if<physics::RemoveBody>(&command))
        std::erase_if(seen_, [&](const Seen& each) { return each.id == remove->id; });
    if (auto* set = std::get_if<physics::SetGravity>(&command))
        graph_.root->setGravity(toSofa(set->gravity / def_.unit));
    if (std::holds_alternative<physics::Reset>(command)) reset();
    auto* tune = std::get_if<physics::Tune>(&command);
    if (!tune) return;
    report.set(physics::StepFlag::Tuned);
    const GraphState before = stateOfGraph(*graph_.root);
    const auto change = [&] {
        tune->change(*this);
        if (!isUsable(stateOfGraph(*graph_.root), def_.unit)) fail("it left numbers that are not finite, or too large");
    };
    if (attempt("tune", change)) return;
    setGraphState(before, *graph_.root, def_.unit); // components that it added or changed stay
    report.set(physics::StepFlag::TuneRejected);
}

void LoadedWorld::advance(double dt, physics::StepReport& report)
{
    const GraphState before = stateOfGraph(*graph_.root);
    graph_.root->setDt(dt);
    ::sofa::simulation::node::updateContext(graph_.root.get());
    if (animate(*graph_.root, dt) && isUsable(stateOfGraph(*graph_.root), def_.unit)) return;
    report.set(physics::StepFlag::Undone);
    setGraphState(before, *graph_.root, def_.unit);
    attempt("SOFA: a step was undone, but not its pictures", [&] { updateMappings(*graph_.root); });
}

bool LoadedWorld::isCut() const
{
    return std::ranges::any_of(graph_.views, [](const ItemView& each) { return each.isCut(); });
}

LoadedWorld::Graph LoadedWorld::loadAgain() const
{
    Graph graph;
    graph.root = loadGraph(def_);
    std::vector<std::string> left;
    std::vector<LoadedItem> items = itemsOf(*graph.root, def_.unit, left);
    const auto nameOfView = [](const ItemView& each) { return each.item().name; };
    if (!std::ranges::equal(items, graph_.views, {}, &LoadedItem::name, nameOfView))
        fail(def_.file, ": has other objects than when it was loaded");
    graph.root->setGravity(graph_.root->getGravity());
    graph.views = viewsOf(std::move(items), def_.unit, true);
    return graph;
}

// SOFA resets numbers, but not meshes.
void LoadedWorld::reset()
{
    if (isCut())
        graph_ = loadAgain();
    else
        ::sofa::simulation::node::reset(graph_.root.get());
}

void LoadedWorld::look()
{
    for (ItemView& each : graph_.views) each.look();
}

void LoadedWorld::capture(frame::Frame& out) const
{
    const Lock lock(sofaMutex());
    out.step = steps_;
    out.time = time_;
    out.softBodies.clear();
    out.rigidBodies.clear();
    for (const auto& [id, item] : seen_) {
        const ItemView& view = graph_.views[item];
        if (view.item().soft)
            view.write(id, out.softBodies.emplace_back());
        else
            out.rigidBodies.emplace_back(view.rigid()).id = id;
    }
    out.contacts.clear();
    out.attachments.clear();
    out.channels.clear();
}

void LoadedWorld::record(physics::StepRecord& out) const
{
    const Lock lock(sofaMutex());
    out.rigidPoses.clear();
    for (const auto& [id, item] : seen_) {
        const std::vector<Pose>& poses = graph_.views[item].rigid().poses;
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
    for (const std::vector<double>& each : stateOfGraph(*graph_.root)) hasher.addAll(std::span<const double>(each));
    return hasher.value();
}

std::shared_ptr<const physics::EngineState> LoadedWorld::save() const
{
    const Lock lock(sofaMutex());
    auto state = std::make_shared<LoadedState>();
    state->graph = stateOfGraph(*graph_.root);
    state->elements = elementsOf(graph_.views);
    state->gravity = fromSofa(graph_.root->getGravity());
    state->time = time_;
    state->steps = steps_;
    return state;
}

void LoadedWorld::restore(const physics::EngineState& saved)
{
    const auto* state = dynamic_cast<const LoadedState*>(&saved);
    if (!state) fail("restore: the state is one of another engine");
    const Lock lock(sofaMutex());
    if (!fits(*state, *graph_.root, graph_.views)) {
        Graph again = loadAgain(); // the state may be one from before a cut
        if (!fits(*state, *again.root, again.views))
            fail("restore: the scene's meshes are not those of the state, and not those of ", def_.file);
        graph_ = std::move(again);
    }
    setGraphState(state->graph, *graph_.root, def_.unit);
    graph_.root->setGravity(toSofa(state->gravity));
    updateMappings(*graph_.root);
    look();
    time_ = state->time;
    steps_ = state->steps;
}

::sofa::simulation::Node* LoadedWorld::nodeOf(BodyId id) const
{
    const auto found = std::ranges::find(seen_, id, &Seen::id);
    if (found == seen_.end()) return nullptr;
    const LoadedItem& item = graph_.views[found->item].item();
    const ::sofa::core::BaseState* state = item.soft;
    if (!state) state = item.rigid;
    return dynamic_cast<::sofa::simulation::Node*>(
        const_cast<::sofa::core::objectmodel::BaseContext*>(state->getContext()));
}

} // namespace filasofia::sofaengine

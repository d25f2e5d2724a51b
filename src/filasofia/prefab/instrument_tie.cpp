#include "filasofia/prefab/instrument_tie.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/physics/defs.h"
#include "filasofia/prefab/instrument_tie_impl.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/standing_strand.h"

#include <algorithm>
#include <utility>

namespace filasofia::prefab {
namespace {

constexpr double kBeside = 1.2e-3; ///< [m] between the assistant's fingers, along the thread

InstrumentTieDef checkedTie(runtime::Simulation& simulation, InstrumentTieDef def)
{
    const std::string object = text("instrument tie '", def.name, "'");
    validate(def, object);
    def.nodes = heldNodes(simulation, def.thread, def.nodes, object);
    if (def.turns.empty() || def.turns.size() > 3)
        fail(object, ": turns must have one to three entries, got ", def.turns.size());
    // A second throw of two turns, after a first one of two, pressed the thread through the driver for a few steps.
    for (std::size_t i = 1; i < def.turns.size(); ++i)
        if (def.turns[i] > 1) fail(object, ": turns[", i, "] must be 1, got ", def.turns[i]);
    makeAxes(def.up, def.across, object);
    if (!def.driver.grasps) fail(object, ": driver.grasps must be true, got false");
    return def;
}

} // namespace

InstrumentTie::Impl::Impl(runtime::Simulation& sim, const InstrumentTieDef& given)
    : simulation(sim),
      def(checkedTie(sim, given)), driver{.instrument = ArticulatedInstrument(sim, def.driver), .mouth = def.mouth}
{
    hand.body = sim.add(physics::RigidBodyDef{.name = text(def.name, ": hand"), .elements = {Pose{def.place}}});
    assistant.body = sim.add(physics::RigidBodyDef{.name = text(def.name, ": assistant"),
                                                   .elements = std::vector<Pose>(2, Pose{def.place})});
    fingersBody = sim.add(physics::RigidBodyDef{
        .name = text(def.name, ": fingers"),
        .elements = std::vector<Pose>(static_cast<std::size_t>(mostFingers()) + 2, Pose{def.place})});
    plan = {.across = def.across, .up = def.up, .front = cross(def.across, def.up), .mouth = def.mouth};
}

void InstrumentTie::Impl::begin()
{
    turns.take(!simulation.physics().stepsHere(), [this] {
        if (phase == TiePhase::Idle) wanted = true;
    });
}

void InstrumentTie::Impl::release()
{
    turns.take(!simulation.physics().stepsHere(), [this] {
        letGo(hand);
        leaveTail();
        openFingers();
        if (driver.instrument.holding()) driver.instrument.open(kOpen);
        wanted = false;
        next(TiePhase::Idle);
    });
}

void InstrumentTie::Impl::step(double time)
{
    const frame::FrameRef now = simulation.physics().latest();
    if (!now) return;
    turns.now([&] {
        const frame::SoftBodyFrame* thread = now->softBody(def.thread);
        if (thread == nullptr) return;
        const double dt = std::max(time - now->time, 0.0);
        if (phase == TiePhase::Idle) {
            if (std::exchange(wanted, false)) seize(*now, *thread);
        } else {
            work(*now, *thread, dt);
        }
        publish();
    });
}

void InstrumentTie::Impl::seize(const frame::Frame& now, const frame::SoftBodyFrame& thread)
{
    throws = 0;
    largest = 0.0;
    driver.pose = driver.instrument.pose();
    plan.side = 1.0;
    measure(thread);
    if (dot(plan.strandBase - plan.tailBase, def.across) < 0.0) plan.side = -1.0;
    const HandStep moves = handStep(now, 0.0);
    moves.put(hand, nodeOf(thread, 0));
    reachTail(now, thread);
    next(TiePhase::Take);
}

void InstrumentTie::Impl::hold(StrandHand& with, int node)
{
    with.grip = simulation.physics().attach(
        def.thread,
        {.nodes = {def.nodes[static_cast<std::size_t>(node)]}, .stiffness = def.stiffness, .to = with.body});
}

void InstrumentTie::Impl::letGo(StrandHand& with)
{
    if (with.grip) simulation.physics().release(with.grip);
    with.grip = {};
}

/// The assistant's second finger goes to a node beside the one that the driver will take; takeTail() may follow in the
/// next step.
void InstrumentTie::Impl::reachTail(const frame::Frame& now, const frame::SoftBodyFrame& thread)
{
    handStep(now, 0.0).put(assistant, nodeOf(thread, 1));
    const std::vector<int> nodes = fingerNodes(thread, def.nodes[1], {.base = def.nodes[0]},
                                               {.apart = kBeside, .most = 1, .wanted = [](Vec3) { return true; }});
    second.reach(simulation, assistant.body, 1, thread, nodes);
    beside = nodes.empty() ? Vec3{} : thread.positions[static_cast<std::size_t>(nodes[0])] - nodeOf(thread, 1);
}

void InstrumentTie::Impl::takeTail()
{
    hold(assistant, 1);
    second.close(simulation, assistant.body, 1, def.thread, def.stiffness);
}

void InstrumentTie::Impl::leaveTail()
{
    letGo(assistant);
    second.open(simulation);
}

void InstrumentTie::Impl::next(TiePhase to)
{
    phase = to;
    since = still = drawn = stiff = 0.0;
    way = 0;
}

void InstrumentTie::Impl::openFingers()
{
    fingers.open(simulation);
    pinching.open(simulation);
}

Vec3 InstrumentTie::Impl::nodeOf(const frame::SoftBodyFrame& thread, int which) const
{
    return thread.positions[static_cast<std::size_t>(def.nodes[static_cast<std::size_t>(which)])];
}

void InstrumentTie::Impl::measure(const frame::SoftBodyFrame& thread)
{
    const StandingStrand strand = standingStrand(thread, def.nodes[0], def.nodes[1], def.place, def.up);
    const StandingStrand other = standingStrand(thread, def.nodes[1], def.nodes[0], def.place, def.up);
    bases = {strand.base, other.base};
    plan.strand = strand.length;
    plan.tail = other.length;
    plan.strandBase = thread.positions[static_cast<std::size_t>(strand.base)];
    plan.tailBase = thread.positions[static_cast<std::size_t>(other.base)];
}

InstrumentTie::InstrumentTie(runtime::Simulation& simulation, const InstrumentTieDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    simulation.everyStep([impl = impl_](double time) { impl->step(time); });
    remember(simulation, text("instrument tie '", def.name, "'"), impl_);
}
InstrumentTie::~InstrumentTie() = default;

void InstrumentTie::begin() { impl_->begin(); }
void InstrumentTie::release() { impl_->release(); }
int InstrumentTie::tied() const { return impl_->told.read().tied; }
bool InstrumentTie::done() const { return impl_->told.read().done; }
bool InstrumentTie::failed() const { return impl_->told.read().failed; }
double InstrumentTie::largestForce() const { return impl_->told.read().largest; }
BodyId InstrumentTie::hand() const { return impl_->hand.body; }
const ArticulatedInstrument& InstrumentTie::driver() const { return impl_->driver.instrument; }

} // namespace filasofia::prefab

#include "filasofia/prefab/suction_irrigator.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/prefab/remember.h"

#include <algorithm>
#include <atomic>
#include <tuple>
#include <utility>

namespace filasofia::prefab {
namespace {

constexpr double kAgain = 1.0; ///< [s] between two tellings that a valve is open

} // namespace

struct SuctionIrrigator::Impl {
    Impl(runtime::Simulation& sim, ArticulatedInstrument& instrument, const SuctionIrrigatorDef& given)
        : simulation(sim), tool(instrument), name(sim.physics().nameOf(instrument.body())), def(given)
    {
        validate(def, text("suction of '", name, "'"));
    }

    /// The stepping thread, before the step that ends at `time` [s].
    void watch(double time)
    {
        if (state.rinses) state.irrigated += def.irrigation * std::max(time - state.last, 0.0);
        state.last = time;
        const bool sucks = tool.opening() < 0.5, rinses = asked;
        // An open valve is told again: another body may have begun to bleed, or a reset may have ended the flow.
        const bool again = time >= state.again;
        if (again) state.again = time + kAgain;
        if (std::exchange(state.sucks, sucks) != sucks || (again && sucks)) suck(sucks);
        if (std::exchange(state.rinses, rinses) != rinses || (again && rinses)) rinse(rinses);
        newest.write(state);
    }
    void suck(bool on) const
    {
        treatAll(surface::Suck{def.tip, def.reach, on ? def.suction : 0.0, tool.body()});
        if (simulation.hasSmoke()) simulation.extract({def.tip, on ? def.extraction : 0.0, tool.body(), 0, def.source});
    }
    void rinse(bool on) const { treatAll(surface::Rinse{def.tip, def.reach, on ? def.irrigation : 0.0, tool.body()}); }
    void treatAll(const surface::Treatment& treatment) const
    {
        for (const BodyId each : simulation.physics().bodies())
            if (simulation.bleeds(each)) simulation.treat(each, treatment);
    }

    struct State {
        bool sucks = false, rinses = false;
        double irrigated = 0.0;         ///< [m^3]
        double last = 0.0, again = 0.0; ///< [s]
    };
    using Kept = std::tuple<State>;
    auto kept() { return std::tie(state); } // blood and smoke remember themselves what the valves began
    void publish()
    {
        asked = state.rinses;
        newest.write(state);
    }

    runtime::Simulation& simulation;
    ArticulatedInstrument& tool;
    const std::string name;
    const SuctionIrrigatorDef def;
    State state; // the stepping thread's
    std::atomic<bool> asked = false;
    Published<State> newest; // for all threads
};

SuctionIrrigator::SuctionIrrigator(runtime::Simulation& simulation, ArticulatedInstrument& tool,
                                   const SuctionIrrigatorDef& def)
    : impl_(std::make_shared<Impl>(simulation, tool, def))
{
    simulation.everyStep([weak = std::weak_ptr(impl_)](double time) {
        if (const auto impl = weak.lock()) impl->watch(time);
    });
    remember(simulation, text("suction of '", impl_->name, "'"), impl_);
}
SuctionIrrigator::~SuctionIrrigator() = default;

void SuctionIrrigator::rinse(bool on) { impl_->asked = on; }
bool SuctionIrrigator::rinses() const { return impl_->newest.read().rinses; }
bool SuctionIrrigator::sucks() const { return impl_->newest.read().sucks; }
double SuctionIrrigator::irrigated() const { return impl_->newest.read().irrigated; }

} // namespace filasofia::prefab

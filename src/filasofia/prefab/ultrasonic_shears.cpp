#include "filasofia/prefab/ultrasonic_shears.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/math/rounded.h"
#include "filasofia/prefab/remember.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace filasofia::prefab {
namespace {

constexpr double kOpen = 0.5;    ///< [-], the jaws' opening: beyond it they hold nothing, and may part again
constexpr double kParked = 3e-3; ///< [m] behind the pivot, within the shaft
constexpr double kBack = 1.5e-3; ///< [m], width of the blade that parts
constexpr double kBelow = 1e-3;  ///< [m], below the blade's face

/// In the plane across pad and blade; its front edge is at the origin.
std::shared_ptr<const geometry::TriangleMesh> knifeOf(const UltrasonicShearsDef& def)
{
    return std::make_shared<const geometry::TriangleMesh>(geometry::TriangleMesh{
        .vertices = {{0, -kBelow, 0}, {0, def.height, 0}, {0, def.height, kBack}, {0, -kBelow, kBack}},
        .triangles = {{0, 1, 2}, {0, 2, 3}},
        .uv = {}});
}

} // namespace

struct UltrasonicShears::Impl {
    Impl(runtime::Simulation& sim, ArticulatedInstrument& instrument, const UltrasonicShearsDef& asked)
        : simulation(sim), tool(instrument), name(sim.physics().nameOf(instrument.body())), def(asked)
    {
        const std::string object = text("ultrasonic shears '", name, "'");
        validate(def, object);
        if (!(def.to > def.from)) fail(object, ": to must be > from (", def.from, " m), got ", def.to, " m");
        const auto& rigid = std::get<physics::RigidBodyDef>(*sim.physics().def(tool.body()));
        if (rigid.articulation.joints.size() != 1)
            fail(object, ": the tool must have one jaw that moves, got ", rigid.articulation.joints.size());
        if (sim.electrodes(tool.body()) > 0)
            fail(object, ": the tool must have no electrode, got ", sim.electrodes(tool.body()));
        const auto tip = [this](int element) {
            return surface::ElectrodeTip{.element = element, .from = {0, 0, -def.from}, .to = {0, 0, -def.to}};
        };
        sim.addElectrode(tool.body(), {.mode = surface::EnergyMode::Bipolar,
                                       .power = def.power,
                                       .radius = def.radius,
                                       .limit = def.limit,
                                       .tip = tip(0),
                                       .other = tip(1)});
        physics::RigidBodyDef blade{.name = text("blade of ", name), .elements = {parked(rigid.elements.front())}};
        for (const auto& model : rigid.collision)
            if (model.element == 0 &&
                std::ranges::find(blade.collision, model.group, &physics::CollisionDef::group) == blade.collision.end())
                blade.collision.push_back(
                    {.mesh = knifeOf(def), .proximity = model.proximity, .group = model.group, .cutting = true});
        knife = sim.add(blade);
        if (!blade.collision.empty()) sim.physics().setCutting(knife, false);
    }

    [[nodiscard]] static Pose parked(const Pose& tool) { return tool * Pose{{0, 0, kParked}, {}}; }

    /// The stepping thread, before the step that ends at `time` [s].
    void watch(double time)
    {
        const double dt = std::max(time - std::exchange(state.last, time), 0.0);
        const frame::FrameRef frame = simulation.physics().latest();
        const frame::RigidBodyFrame* now = frame ? frame->rigidBody(tool.body()) : nullptr;
        if (now == nullptr) return;
        const double active = simulation.energy(tool.body(), kPedal).active;
        const bool pressed = active > std::exchange(state.active, active);
        const bool closed = tool.opening() < kOpen;
        if (!closed) state.hasParted = false;
        if (pressed) state.sealed = sealed(*frame, *now);
        if (pressed && closed && !state.parts && !state.hasParted && state.sealed >= def.sealed) begin();
        moveKnife(now->poses.front(), dt, pressed);
        newest.write(state);
    }

    void begin()
    {
        state.parts = true;
        state.way = 0.0;
        simulation.physics().setCutting(knife, true);
    }

    /// From the pivot to the tip while the pedal is pressed, and back, where all is parted; then it is parked.
    void moveKnife(const Pose& pivot, double dt, bool pressed)
    {
        Pose at = parked(pivot);
        if (state.parts) {
            if (state.way < 1.0 && !pressed) state.way = 2.0 - state.way;
            const bool comesToTheTip = state.way < 1.0 && state.way + dt / def.parting >= 1.0;
            state.way += dt / def.parting;
            if (comesToTheTip) {
                state.hasParted = true;
                ++state.parted;
            }
            const double part = state.way < 1.0 ? state.way : std::max(2.0 - state.way, 0.0);
            at = pivot * Pose{{0, 0, kParked - part * (kParked + def.to)}, {}};
            if (state.way >= 2.0) {
                state.parts = false;
                simulation.physics().setCutting(knife, false);
            }
        }
        if (at == state.knife) return;
        state.knife = at;
        simulation.physics().setPose(knife, rounded(at));
    }

    /// [-], the share of the surface nodes between blade and pad that is burnt, of all bodies together.
    [[nodiscard]] double sealed(const frame::Frame& frame, const frame::RigidBodyFrame& now) const
    {
        int heated = 0, burnt = 0;
        for (const frame::SoftBodyFrame& each : frame.softBodies) {
            if (!simulation.burns(each.id)) continue;
            const auto damage = simulation.damage(each.id);
            if (!damage) continue;
            for (std::size_t i = 0; i < std::min(damage->size(), each.positions.size()); ++i) {
                if ((*damage)[i] < 0.0f || !isBetween(each.positions[i], now)) continue;
                ++heated;
                burnt += (*damage)[i] >= 1.0f ? 1 : 0;
            }
        }
        return heated > 0 ? static_cast<double>(burnt) / heated : 0.0;
    }
    [[nodiscard]] bool isBetween(Vec3 place, const frame::RigidBodyFrame& now) const
    {
        return std::ranges::any_of(now.poses, [&](const Pose& jaw) {
            const Vec3 in = transform(inverse(jaw), place);
            return distance(in, {0, 0, std::clamp(in.z, -def.to, -def.from)}) <= def.radius;
        });
    }

    struct State {
        bool parts = false, hasParted = false;
        int parted = 0;
        double way = 0.0;    ///< [-], the blade goes to the tip and, from 1 to 2, back
        double sealed = 0.0; ///< [-]
        double active = 0.0; ///< [s], the electrode was active
        double last = 0.0;   ///< [s]
        Pose knife = {};
    };
    using Kept = std::tuple<State>;
    auto kept() { return std::tie(state); }
    void publish() { newest.write(state); }

    runtime::Simulation& simulation;
    ArticulatedInstrument& tool;
    const std::string name;
    const UltrasonicShearsDef def;
    BodyId knife = {};
    State state;             // the stepping thread's
    Published<State> newest; // for all threads
};

UltrasonicShears::UltrasonicShears(runtime::Simulation& simulation, ArticulatedInstrument& tool,
                                   const UltrasonicShearsDef& def)
    : impl_(std::make_shared<Impl>(simulation, tool, def))
{
    simulation.everyStep([weak = std::weak_ptr(impl_)](double time) {
        if (const auto impl = weak.lock()) impl->watch(time);
    });
    remember(simulation, text("ultrasonic shears '", impl_->name, "'"), impl_);
}
UltrasonicShears::~UltrasonicShears() = default;

void UltrasonicShears::press(bool on) { impl_->simulation.activate(impl_->tool.body(), on, kPedal); }
double UltrasonicShears::sealed() const { return impl_->newest.read().sealed; }
bool UltrasonicShears::parts() const { return impl_->newest.read().parts; }
int UltrasonicShears::parted() const { return impl_->newest.read().parted; }

} // namespace filasofia::prefab

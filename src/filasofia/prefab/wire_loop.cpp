#include "filasofia/prefab/wire_loop.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/units.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/math/rounded.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"

#include <cmath>
#include <numbers>
#include <tuple>

namespace filasofia::prefab {
namespace {

WireLoopDef checkedLoop(WireLoopDef def)
{
    const std::string object = text("wire loop '", def.name, "'");
    validate(def, object);
    if (def.depth < 0.5 * def.width)
        fail(object, ": depth must be >= width / 2 (", 0.5 * def.width, " m), got ", def.depth, " m");
    def.pose = physics::unitPose(def.pose, object + ": pose");
    return def;
}

/// From arm to arm: straight sides and half a circle.
std::vector<Vec3> wireOf(const WireLoopDef& def)
{
    constexpr int kEdges = 12; // joints of 15 degrees
    const double radius = 0.5 * def.width, straight = def.depth - radius;
    std::vector<Vec3> line;
    if (straight > 0.0) line.push_back({-radius, 0.0, 0.0});
    for (int i = 0; i <= kEdges; ++i) {
        const double angle = std::numbers::pi * i / kEdges;
        line.push_back({-radius * std::cos(angle), -straight - radius * std::sin(angle), 0.0});
    }
    if (straight > 0.0) line.push_back({radius, 0.0, 0.0});
    return line;
}

/// The surface that the wire spans. Its rim cuts: a closed line, whose sides the cut surface knows apart.
std::shared_ptr<const geometry::TriangleMesh> bladeOf(const std::vector<Vec3>& line)
{
    geometry::TriangleMesh mesh{.vertices = line, .triangles = {}, .uv = {}};
    // A fan around the middle of the straight line above would have flat triangles: a strip from side to side has none.
    for (int low = 0, high = static_cast<int>(line.size()) - 1; high - low > 1; ++low, --high) {
        mesh.triangles.push_back({low, low + 1, high});
        if (high - low > 2) mesh.triangles.push_back({low + 1, high - 1, high});
    }
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

/// The wire with its arms.
std::shared_ptr<const geometry::TriangleMesh> drawn(const WireLoopDef& def, const std::vector<Vec3>& line)
{
    std::vector<Vec3> points = {line.front() + Vec3{0.0, 0.0, def.arms}};
    points.insert(points.end(), line.begin(), line.end());
    points.push_back(line.back() + Vec3{0.0, 0.0, def.arms});
    return geometry::shapes::tube(points, 0.5 * def.wire, 10);
}

} // namespace

struct WireLoop::Impl {
    Impl(runtime::Simulation& sim, const WireLoopDef& asked)
        : simulation(sim), def(checkedLoop(asked)), line(wireOf(def)), lastPose(def.pose), newest(lastPose),
          body(addBody())
    {
        simulation.show(body, {.surface = drawn(def, line), .material = def.material});
    }

    BodyId addBody()
    {
        physics::RigidBodyDef rigid{.name = def.name, .elements = {def.pose}, .friction = def.friction};
        for (const int group : def.groups)
            rigid.collision.push_back(
                {.mesh = bladeOf(line), .proximity = def.proximity, .group = group, .cutting = true});
        const BodyId id = simulation.add(rigid);
        if (def.groups.empty()) return id; // it touches nothing
        const surface::ElectrodeTip tip{
            .from = line.front(), .to = line.back(), .through = {line.begin() + 1, line.end() - 1}};
        using surface::EnergyMode;
        for (const auto& [mode, power] : {std::pair(EnergyMode::Cut, def.cutting), {EnergyMode::Coagulate, def.drying}})
            simulation.addElectrode(id, {.mode = mode, .power = power, .radius = def.reach, .tip = tip});
        return id;
    }

    void press(int electrode, bool on)
    {
        if (!def.groups.empty()) simulation.activate(body, on, electrode);
    }

    using Kept = std::tuple<Pose>;
    auto kept() { return std::tie(lastPose); }
    void publish() { newest.write(lastPose); }

    runtime::Simulation& simulation;
    const WireLoopDef def;
    const std::vector<Vec3> line;
    Turns turns; // guards the pose and the order of commands
    Pose lastPose;
    Published<Pose> newest; // for all threads
    const BodyId body;      // built from the members above
};

WireLoop::WireLoop(runtime::Simulation& simulation, const WireLoopDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    remember(simulation, text("wire loop '", impl_->def.name, "'"), impl_);
}
WireLoop::~WireLoop() = default;

BodyId WireLoop::body() const { return impl_->body; }
const WireLoopDef& WireLoop::def() const { return impl_->def; }
const std::vector<Vec3>& WireLoop::line() const { return impl_->line; }

void WireLoop::move(const Pose& pose)
{
    const Pose unit = physics::unitPose(pose, text("wire loop '", impl_->def.name, "'"));
    impl_->turns.take(!impl_->simulation.physics().stepsHere(), [impl = impl_.get(), unit] {
        impl->lastPose = unit;
        impl->publish();
        impl->simulation.physics().setPose(impl->body, rounded(unit));
    });
}
void WireLoop::cut(bool on) { impl_->press(kCuts, on); }
void WireLoop::dry(bool on) { impl_->press(kDries, on); }
Pose WireLoop::pose() const { return impl_->newest.read(); }

} // namespace filasofia::prefab

#include "filasofia/runtime/electrodes.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/math/rounded.h"
#include "filasofia/runtime/told_and_kept.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

using surface::ElectrodeDef;
using surface::ElectrodeTip;
using surface::EnergyMode;

const physics::RigidBodyDef& rigidBody(const physics::BodyDef& body, const std::string& object)
{
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&body);
    if (rigid == nullptr) fail(object, ": needs a rigid body, got ", physics::describeBody(body));
    return *rigid;
}

void checkTip(const ElectrodeTip& tip, const physics::RigidBodyDef& rigid, const std::string& path)
{
    const auto count = static_cast<int>(physics::elementCount(rigid));
    if (tip.element >= count) fail(path, ".element must be in [0, ", count, "), got ", tip.element);
    constexpr std::size_t kMost = 64;
    if (tip.through.size() > kMost)
        fail(path, ".through must have at most ", kMost, " points, got ", tip.through.size());
}

void check(const ElectrodeDef& def, const physics::RigidBodyDef& rigid, const physics::PhysicsServer& physics,
           const std::string& object)
{
    validate(def, object);
    checkTip(def.tip, rigid, object + ": tip");
    if (def.tip.body) fail(object, ": tip.body must not be given: it is that of the electrode");
    const bool bipolar = def.mode == EnergyMode::Bipolar;
    if (bipolar != def.other.has_value())
        fail(object, bipolar ? ": other must be given if mode is bipolar" : ": other needs the mode bipolar");
    if (def.mode == EnergyMode::Cut && std::ranges::none_of(rigid.collision, &physics::CollisionDef::cutting))
        fail(object, ": mode cut needs a blade: none of its ", rigid.collision.size(),
             " collision models has cutting set");
    if (!bipolar) return;
    if (!def.tip.through.empty() || !def.other->through.empty())
        fail(object, ": through needs the mode cut or coagulate: the tips of a bipolar one are straight");
    const std::string path = object + ": other";
    if (!def.other->body) return checkTip(*def.other, rigid, path);
    const auto body = physics.def(def.other->body);
    checkTip(*def.other, rigidBody(*body, path + ".body"), path);
}

/// The points of a tip now, from end to end; none if its body is gone.
std::vector<Vec3> lineOf(const ElectrodeTip& tip, BodyId owner, const frame::Frame& frame)
{
    const frame::RigidBodyFrame* body = frame.rigidBody(tip.body ? tip.body : owner);
    if (body == nullptr || tip.element >= std::ssize(body->poses)) return {};
    std::vector<Vec3> line = {tip.from};
    line.insert(line.end(), tip.through.begin(), tip.through.end());
    if (line.size() > 1 || tip.to != tip.from) line.push_back(tip.to);
    for (Vec3& each : line) each = transform(body->poses[static_cast<std::size_t>(tip.element)], each);
    return line;
}

/// [m] The middle of a line, by its length.
Vec3 middleOf(const std::vector<Vec3>& line)
{
    double left = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i) left += 0.5 * distance(line[i - 1], line[i]);
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double length = distance(line[i - 1], line[i]);
        if (left <= length && length > 0.0) return line[i - 1] + left / length * (line[i] - line[i - 1]);
        left -= length;
    }
    return line.back();
}

/// What a tip reaches of one body.
struct Reached {
    const Burnings::Surface* surface = nullptr;
    double weight = 0.0; ///< [m^2]
    std::vector<surface::HeatShare> shares = {};
    std::span<const geometry::Triangle> triangles = {}; ///< the body's, now; as long as the frame
    std::span<const Vec3> positions = {};
};

/// [m] The mean edge of the triangles that take heat.
double meanEdge(const Reached& reached)
{
    std::set<int> heated;
    for (const surface::HeatShare& each : reached.shares) heated.insert(each.vertex);
    double sum = 0.0;
    int count = 0;
    const auto& positions = reached.positions;
    for (const geometry::Triangle& corners : reached.triangles) {
        if (std::ranges::none_of(corners, [&](int corner) { return heated.contains(corner); })) continue;
        for (std::size_t k = 0; k < 3; ++k) sum += distance(positions[corners[k]], positions[corners[(k + 1) % 3]]);
        count += 3;
    }
    return count > 0 ? sum / count : 0.0;
}

/// Heat is stored at nodes: a mesh that is coarser than the tip spreads it over too large an area, and burns too little
/// or nothing.
void warnIfCoarse(const std::string& instrument, double radius, const Reached& reached, const std::string& body)
{
    constexpr double kMuch = 2.5; // measured: with 3.4 times the radius nothing burns, with 0.85 all that should
    const double edge = meanEdge(reached), spread = reached.surface->spread, fine = std::max(radius, spread);
    if (!(edge > kMuch * fine)) return;
    const auto mm = [](double length) { return text(rounded(1e3 * length, 10.0), " mm"); };
    logWarning("electrode of rigid body '", shortened(instrument), "': the mesh of ", body,
               " is too coarse for what it burns: its edges there are ", mm(edge), " long, but the tip reaches ",
               mm(radius), " and heat spreads ", mm(spread), "; burns come out too small: use edges of at most ",
               mm(fine), " there");
}

std::vector<Reached> reached(const surface::HeatReach& reach, const frame::Frame& frame,
                             const std::vector<Burnings::Surface>& surfaces)
{
    std::vector<Reached> out;
    double all = 0.0;
    for (const Burnings::Surface& each : surfaces) {
        const frame::SoftBodyFrame* body = frame.softBody(each.body);
        if (body == nullptr) continue;
        const bool cut = body->boundary && body->boundary->revision > 0;
        Reached here{.surface = &each};
        here.triangles = cut ? std::span<const geometry::Triangle>(body->boundary->triangles) : each.skin;
        here.positions = body->positions;
        here.weight = surface::divideSource(here.triangles, here.positions, reach, here.shares);
        all += here.weight;
        if (!here.shares.empty()) out.push_back(std::move(here));
    }
    if (all == 0.0) // it only grazes them
        for (Reached& each : out) each.weight = 1.0;
    return out;
}

std::vector<Reached> reached(const ElectrodeDef& def, BodyId owner, const frame::Frame& frame,
                             const std::vector<Burnings::Surface>& surfaces)
{
    const std::vector<Vec3> one = lineOf(def.tip, owner, frame);
    if (one.empty()) return {};
    std::vector<Reached> at = reached({.points = one, .radius = def.radius}, frame, surfaces);
    if (def.mode != EnergyMode::Bipolar || at.empty()) return at;
    const std::vector<Vec3> two = lineOf(*def.other, owner, frame);
    if (two.empty() || reached({.points = two, .radius = def.radius}, frame, surfaces).empty()) return {};
    // Around the four ends without crossing over: the second tip backwards, unless it points the other way.
    const bool along = dot(one.back() - one.front(), two.back() - two.front()) >= 0.0;
    return reached(
        {.points = {one.front(), one.back(), along ? two.back() : two.front(), along ? two.front() : two.back()},
         .filled = true,
         .radius = def.radius},
        frame, surfaces);
}

} // namespace

int Electrodes::add(BodyId id, const ElectrodeDef& def, const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text("electrode of ", physics::describeBody(*body));
    const physics::RigidBodyDef& rigid = rigidBody(*body, "electrode");
    check(def, rigid, physics, object);
    const std::lock_guard lock(mutex_);
    if (state_.all.empty()) state_.last = now_; // what was before it is not its
    const auto before = std::ranges::count(state_.all, id, &Electrode::body);
    state_.all.push_back({.body = id, .index = static_cast<int>(before), .name = rigid.name, .def = def});
    any_ = true;
    return static_cast<int>(before);
}

std::size_t Electrodes::find(BodyId id, int electrode) const
{
    for (std::size_t i = 0; i < state_.all.size(); ++i)
        if (state_.all[i].body == id && state_.all[i].index == electrode) return i;
    const auto has = std::ranges::count(state_.all, id, &Electrode::body);
    if (has == 0) fail("electrode: body ", id.value, " has none; addElectrode() makes one");
    fail("electrode of body ", id.value, ": electrode must be in [0, ", has, "), got ", electrode);
}

bool Electrodes::Electrode::owes() const
{
    return balance.active > seen ||
           std::ranges::any_of(spent, [this](const auto& of) { return balance.active > of.second; });
}

Electrodes::Moved Electrodes::activate(BodyId id, bool on, int electrode)
{
    const std::lock_guard lock(mutex_);
    Electrode& asked = state_.all[find(id, electrode)];
    if (asked.active == on) return {};
    asked.active = on;
    if (asked.def.mode != EnergyMode::Cut) return {.moved = true};
    const bool cuts = std::ranges::any_of(state_.all, [&](const Electrode& each) {
        return each.body == id && each.active && each.def.mode == EnergyMode::Cut;
    });
    return {.moved = true, .cuts = cuts};
}

surface::EnergyBalance Electrodes::balance(BodyId id, int electrode) const
{
    const std::lock_guard lock(mutex_);
    return state_.all[find(id, electrode)].balance;
}

int Electrodes::count(BodyId id) const
{
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::ranges::count(state_.all, id, &Electrode::body));
}

std::vector<BodyId> Electrodes::cutting() const
{
    const std::lock_guard lock(mutex_);
    std::vector<BodyId> out;
    for (const Electrode& each : state_.all)
        if (each.active && each.def.mode == EnergyMode::Cut) out.push_back(each.body);
    return out;
}

void Electrodes::restart()
{
    const std::lock_guard lock(mutex_);
    for (Electrode& each : state_.all)
        each = {.body = each.body, .index = each.index, .name = std::move(each.name), .def = each.def};
}

bool Electrodes::afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, Burnings& burnings,
                           const Post& post)
{
    now_ = time;
    if (!any_) return true;
    const std::lock_guard lock(mutex_);
    const double dt = std::max(time - std::exchange(state_.last, time), 0.0);
    bool busy = false; // something is to be given
    for (Electrode& each : state_.all) {
        if (each.active) each.balance.active += dt;
        busy = busy || each.owes();
    }
    const std::vector<Burnings::Surface> surfaces = burnings.surfaces(time);
    const bool begins = std::ranges::any_of(surfaces, [](const Burnings::Surface& each) { return each.dt > 0.0; });
    // If readers hold all frames, the heat waits for the next step, and so do we.
    if (const frame::FrameRef frame = busy && (begins || surfaces.empty()) ? physics.latest() : frame::FrameRef();
        frame && frame->step == step)
        touch(*frame, surfaces, burnings, physics);
    bool all = true;
    for (std::size_t i = 0; i < state_.all.size(); ++i) {
        Electrode& each = state_.all[i];
        each.balance.delivered = burnings.taken(static_cast<int>(i));
        all = tell(time, each, post) && all;
    }
    return all;
}

void Electrodes::touch(const frame::Frame& frame, const std::vector<Burnings::Surface>& surfaces, Burnings& burnings,
                       const physics::PhysicsServer& physics)
{
    for (std::size_t i = 0; i < state_.all.size(); ++i) {
        Electrode& each = state_.all[i];
        for (const Burnings::Surface& here : surfaces) each.spent.try_emplace(here.body, each.seen); // it burns now
        if (!each.owes()) continue;
        std::vector<Reached> all = reached(each.def, each.body, frame, surfaces);
        double sum = 0.0;
        for (const Reached& here : all) sum += here.weight;
        for (Reached& here : all) {
            if (looked_.emplace(each.body, here.surface->body).second)
                warnIfCoarse(each.name, each.def.radius, here,
                             text("soft body '", shortened(physics.nameOf(here.surface->body)), "'"));
            const double time = each.balance.active - each.spent.at(here.surface->body);
            const double energy = each.def.power * time * here.weight / sum;
            if (here.surface->dt > 0.0 && energy > 0.0)
                burnings.touch(here.surface->body,
                               {static_cast<int>(i), energy, each.def.limit, std::move(here.shares)});
        }
        if (all.empty()) each.balance.inAir += each.balance.active - each.seen;
        each.seen = each.balance.active;
    }
    for (Electrode& each : state_.all)
        for (const Burnings::Surface& here : surfaces)
            if (here.dt > 0.0) each.spent[here.body] = each.balance.active;
}

std::vector<Electrodes::Given> Electrodes::given(const frame::Frame& frame) const
{
    const std::lock_guard lock(mutex_);
    std::vector<Given> out;
    for (std::size_t i = 0; i < state_.all.size(); ++i) {
        const Electrode& each = state_.all[i];
        if (const std::vector<Vec3> line = lineOf(each.def.tip, each.body, frame); !line.empty())
            out.push_back({i, middleOf(line), each.def.power * each.balance.active});
    }
    return out;
}

bool Electrodes::tell(double time, Electrode& electrode, const Post& post)
{
    const bool moved = electrode.told != electrode.active;
    if (!moved && (electrode.toldOf == electrode.balance || time < electrode.tellFrom)) return true;
    electrode.told = electrode.active;
    electrode.toldOf = electrode.balance;
    electrode.tellFrom = nextTelling(time);
    return post(electrode.body, electrode.index, electrode.active, electrode.balance);
}

void Electrodes::fill(RunReport& report, const Burnings& burnings) const
{
    const std::lock_guard lock(mutex_);
    report.energy.clear();
    for (std::size_t i = 0; i < state_.all.size(); ++i) {
        const Electrode& each = state_.all[i];
        report.energy.push_back({each.name, each.index, each.def.mode, each.balance});
        report.energy.back().balance.delivered = burnings.taken(static_cast<int>(i), true);
    }
}

Memory Electrodes::memory() { return memoryOf("the electrodes", mutex_, state_); }

} // namespace filasofia::runtime

#include "filasofia/runtime/rewind.h"

#include "filasofia/core/validate.h"
#include "filasofia/runtime/simulation_impl.h"

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {
namespace {

/// What a picture needs of a place or a direction: a tenth of a micrometre in a scene of a metre.
struct KeptPoint {
    float x = 0, y = 0, z = 0;
};
using KeptPoints = std::vector<KeptPoint>;

constexpr double kStillEnough = 5e-6;  ///< [m] by which a body may move without being kept anew: no picture shows it
constexpr double kKeepRounding = 1e-9; ///< [s]

struct KeptSoft {
    BodyId id = {};
    std::shared_ptr<const KeptPoints> positions; ///< shared by states in which the body has not moved
    std::shared_ptr<const frame::Boundary> boundary;
    KeptPoints directors;
    std::vector<int> cutEdges;
};
struct KeptRigid {
    BodyId id = {};
    std::vector<Pose> poses;
};
struct KeptState {
    std::uint64_t step = 0;
    double time = 0.0;
    std::vector<KeptSoft> soft = {};
    std::vector<KeptRigid> rigid = {};
};

KeptPoint asKept(Vec3 v) { return {float(v.x), float(v.y), float(v.z)}; }
Vec3 asVector(KeptPoint p) { return {double(p.x), double(p.y), double(p.z)}; }
Vec3 midway(KeptPoint a, KeptPoint b, double part) { return asVector(a) + part * (asVector(b) - asVector(a)); }

KeptPoints asKept(const std::vector<Vec3>& all)
{
    KeptPoints out;
    out.reserve(all.size());
    for (const Vec3& each : all) out.push_back(asKept(each));
    return out;
}

bool movedSince(const std::vector<Vec3>& now, const KeptPoints& then)
{
    if (now.size() != then.size()) return true;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const Vec3 by = now[i] - asVector(then[i]);
        if (!(std::max({std::abs(by.x), std::abs(by.y), std::abs(by.z)}) <= kStillEnough)) return true;
    }
    return false;
}

template <class Body> const Body* keptBody(const std::vector<Body>& all, BodyId id)
{
    const auto found = std::ranges::find(all, id, &Body::id);
    return found == all.end() ? nullptr : &*found;
}

KeptState keptStateOf(const frame::Frame& frame, const KeptState* before)
{
    KeptState out{.step = frame.step, .time = frame.time};
    for (const frame::SoftBodyFrame& body : frame.softBodies) {
        const KeptSoft* last = before ? keptBody(before->soft, body.id) : nullptr;
        const bool still = last && !movedSince(body.positions, *last->positions);
        out.soft.push_back({body.id,
                            still ? last->positions : std::make_shared<const KeptPoints>(asKept(body.positions)),
                            body.boundary, asKept(body.directors), body.cutEdges});
    }
    for (const frame::RigidBodyFrame& body : frame.rigidBodies) out.rigid.push_back({body.id, body.poses});
    return out;
}

/// What a state takes that follows another one [bytes].
std::size_t keptBytesOf(const KeptState& state, const KeptState* before)
{
    std::size_t bytes = sizeof state;
    for (const KeptSoft& body : state.soft) {
        const KeptSoft* last = before ? keptBody(before->soft, body.id) : nullptr;
        bytes += sizeof body + sizeof(KeptPoint) * body.directors.size() + sizeof(int) * body.cutEdges.size();
        if (!last || last->positions != body.positions) bytes += sizeof(KeptPoint) * body.positions->size();
    }
    for (const KeptRigid& body : state.rigid) bytes += sizeof body + sizeof(Pose) * body.poses.size();
    return bytes;
}

frame::SoftBodyFrame midway(const KeptSoft& a, const KeptSoft* b, double part)
{
    // Across a cut there is no straight way: nodes are new.
    if (!b || b->boundary != a.boundary || b->positions->size() != a.positions->size() ||
        b->directors.size() != a.directors.size())
        b = &a;
    frame::SoftBodyFrame out{.id = a.id, .boundary = a.boundary, .cutEdges = a.cutEdges};
    for (std::size_t i = 0; i < a.positions->size(); ++i)
        out.positions.push_back(midway((*a.positions)[i], (*b->positions)[i], part));
    for (std::size_t i = 0; i < a.directors.size(); ++i) {
        const Vec3 across = midway(a.directors[i], b->directors[i], part);
        out.directors.push_back(length(across) > 0.0 ? normalized(across) : asVector(a.directors[i]));
    }
    return out;
}

frame::RigidBodyFrame midway(const KeptRigid& a, const KeptRigid* b, double part)
{
    frame::RigidBodyFrame out{.id = a.id, .poses = a.poses};
    if (!b || b->poses.size() != a.poses.size()) return out;
    for (std::size_t i = 0; i < a.poses.size(); ++i) out.poses[i] = filasofia::between(a.poses[i], b->poses[i], part);
    return out;
}

/// Bodies that the state lacks stand where they are now: a body that is gone from a picture never comes back.
template <class Body> void addLaterBodies(std::vector<Body>& bodies, const std::vector<Body>& now)
{
    const std::size_t count = bodies.size();
    for (const Body& body : now)
        if (!keptBody(bodies, body.id)) bodies.push_back(body);
    if (bodies.size() > count) std::ranges::sort(bodies, {}, [](const Body& body) { return body.id.value; });
}

} // namespace

struct Rewind::Impl {
    Impl(const RewindDef& asked, Simulation::Impl& of) : def(asked), simulation(of) {}

    void keep(const frame::Frame& newest)
    {
        while (!states.empty() && states.back().time > newest.time) drop(); // a saved state was restored
        if (!states.empty() && newest.time < states.back().time + interval - kKeepRounding) return;
        const KeptState* before = states.empty() ? nullptr : &states.back();
        KeptState state = keptStateOf(newest, before);
        bytes += keptBytesOf(state, before);
        states.push_back(std::move(state));
        if (static_cast<double>(bytes) > def.memory && states.size() > 2) thin();
    }
    void drop()
    {
        bytes -= keptBytesOf(states.back(), states.size() > 1 ? &states[states.size() - 2] : nullptr);
        states.pop_back();
    }
    /// Drops every second state.
    void thin()
    {
        std::size_t count = 0;
        for (std::size_t i = 0; i < states.size(); i += 2) {
            if (count != i) states[count] = std::move(states[i]);
            ++count;
        }
        states.resize(count);
        interval *= 2.0;
        bytes = 0;
        for (std::size_t i = 0; i < states.size(); ++i)
            bytes += keptBytesOf(states[i], i > 0 ? &states[i - 1] : nullptr);
    }
    const frame::Frame& drawn(const frame::Frame& newest)
    {
        keep(newest);
        if (!shown || states.empty()) return newest;
        const auto later = std::ranges::upper_bound(states, *shown, {}, &KeptState::time);
        const KeptState& a = later == states.begin() ? *later : *std::prev(later);
        const KeptState& b = later == states.end() ? a : *later;
        const double part = b.time > a.time ? std::clamp((*shown - a.time) / (b.time - a.time), 0.0, 1.0) : 0.0;
        made = {};
        made.step = a.step;
        made.time = std::clamp(*shown, states.front().time, states.back().time);
        for (const KeptSoft& body : a.soft) made.softBodies.push_back(midway(body, keptBody(b.soft, body.id), part));
        for (const KeptRigid& body : a.rigid)
            made.rigidBodies.push_back(midway(body, keptBody(b.rigid, body.id), part));
        addLaterBodies(made.softBodies, newest.softBodies);
        addLaterBodies(made.rigidBodies, newest.rigidBodies);
        return made;
    }

    const RewindDef def;
    Simulation::Impl& simulation;
    double interval = 1.0 / def.rate; ///< [s], between two states
    std::vector<KeptState> states;
    std::size_t bytes = 0;
    std::optional<double> shown;
    frame::Frame made; ///< what is drawn
};

Rewind::Rewind(Simulation& simulation, const RewindDef& def)
{
    validate(def, "rewind");
    Simulation::Impl& of = *simulation.impl_;
    if (of.control.running()) fail("rewind: it must be made before a run, but one is going on");
    if (of.picture.drawn) fail("rewind: the simulation has one already");
    impl_ = std::make_shared<Impl>(def, of);
    of.picture.drawn = [impl = impl_](const frame::Frame& newest) -> const frame::Frame& {
        return impl->drawn(newest);
    };
}

Rewind::~Rewind() { impl_->simulation.picture.drawn = {}; }

double Rewind::begin() const { return impl_->states.empty() ? 0.0 : impl_->states.front().time; }
double Rewind::end() const { return impl_->states.empty() ? 0.0 : impl_->states.back().time; }
std::size_t Rewind::states() const { return impl_->states.size(); }
std::size_t Rewind::bytes() const { return impl_->bytes; }

void Rewind::show(double time)
{
    if (!std::isfinite(time)) fail("rewind: show: time must be finite, got ", time, " s");
    impl_->shown = time;
}
void Rewind::showNewest() { impl_->shown.reset(); }
std::optional<double> Rewind::shown() const { return impl_->shown; }

} // namespace filasofia::runtime

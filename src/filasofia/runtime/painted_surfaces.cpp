#include "filasofia/runtime/painted_surfaces.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/box.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {
namespace {

using visual::SurfaceState;

template <class Combine> SurfaceState combined(const SurfaceState& a, const SurfaceState& b, const Combine& combine)
{
    return {combine(a.blood, b.blood), combine(a.burn, b.burn), combine(a.wetness, b.wetness)};
}

/// 1 up to half of the radius, 0 from the radius on, smooth between.
double strength(double distance, double radius)
{
    const double t = std::clamp(2.0 * (1.0 - distance / radius), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// A mean of three vertices, clamped because the weights sum to one only up to rounding.
struct Sum {
    SurfaceState state;
    friend Sum operator*(double share, const Sum& a)
    {
        return {{share * a.state.blood, share * a.state.burn, share * a.state.wetness}};
    }
    friend Sum operator+(const Sum& a, const Sum& b)
    {
        return {combined(a.state, b.state, [](double x, double y) { return std::min(x + y, 1.0); })};
    }
};

} // namespace

int paint(std::span<const Vec3> rest, Vec3 centre, double radius, const SurfaceState& state, PaintMode mode,
          std::vector<SurfaceState>& states)
{
    FILASOFIA_ASSERT(states.size() == rest.size());
    int reached = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const double share = strength(distance(rest[i], centre), radius);
        if (share == 0.0) continue;
        ++reached;
        states[i] = combined(states[i], state, [&](double old, double now) {
            return mode == PaintMode::Add ? std::max(old, share * now) : std::lerp(old, now, share);
        });
    }
    return reached;
}

std::optional<Vec3> restPlace(const geometry::TriangleMesh& rest, std::span<const Vec3> now, Vec3 place, double radius)
{
    std::optional<Vec3> found;
    double best = radius * radius;
    for (const auto& [a, b, c] : rest.triangles) {
        const geometry::Box box{min(min(now[a], now[b]), now[c]), max(max(now[a], now[b]), now[c])};
        if (geometry::squaredDistance(box, place) > best) continue; // true for nearly all triangles: nothing to compute
        const auto here = geometry::nearestOnTriangle(place, now[a], now[b], now[c]);
        if (!(here.squaredDistance <= best) || (found && here.squaredDistance == best)) continue;
        best = here.squaredDistance;
        const auto& [u, v, w] = here.weights;
        found = u * rest.vertices[a] + v * rest.vertices[b] + w * rest.vertices[c];
    }
    return found;
}

void PaintedSurfaces::add(SurfaceKey key, const Place& place, SharedSurface surface)
{
    const std::lock_guard lock(mutex_);
    painted_[key] = {.place = place, .surface = std::move(surface)};
}

void PaintedSurfaces::forget(SurfaceKey key)
{
    const std::lock_guard lock(mutex_);
    painted_.erase(key);
}

std::optional<Vec3> PaintedSurfaces::centre(const Painted& painted, const PaintDef& def, const frame::Frame* frame)
{
    const auto& [id, element, body] = painted.place;
    const mapping::MappedSurface& surface = *painted.surface;
    if (element) {
        if (def.atRest) return def.place;
        const frame::RigidBodyFrame* now = frame ? frame->rigidBody(id) : nullptr;
        return transform(inverse(now ? now->poses[static_cast<std::size_t>(*element)] : body), def.place);
    }
    if (def.atRest) return transform(body, def.place);
    std::vector<Vec3> vertices = surface.surface.vertices;
    const frame::SoftBodyFrame* now = frame ? frame->softBody(id) : nullptr;
    if (now && mapping::nodesNeeded(surface.map) <= static_cast<int>(now->positions.size()))
        mapping::apply(surface.map, *now, vertices);
    return restPlace(surface.surface, vertices, def.place, def.radius);
}

int PaintedSurfaces::paint(BodyId id, const PaintDef& def, const frame::Frame* frame)
{
    const std::lock_guard lock(mutex_);
    int reached = 0;
    for (auto& [key, painted] : painted_) {
        if (painted.place.id != id) continue;
        const std::optional<Vec3> place = centre(painted, def, frame);
        if (!place) continue;
        const std::vector<Vec3>& rest = painted.surface->surface.vertices;
        painted.states.resize(rest.size());
        const int here = runtime::paint(rest, *place, def.radius, def.state, def.mode, painted.states);
        painted.fresh = painted.fresh || here > 0;
        reached += here;
    }
    return reached;
}

void PaintedSurfaces::clear()
{
    const std::lock_guard lock(mutex_);
    for (auto& [key, painted] : painted_) {
        std::ranges::fill(painted.states, SurfaceState{});
        painted.fresh = !painted.states.empty();
    }
}

std::optional<std::vector<SurfaceState>> PaintedSurfaces::takeNew(SurfaceKey key)
{
    const std::lock_guard lock(mutex_);
    const auto found = painted_.find(key);
    if (found == painted_.end() || !std::exchange(found->second.fresh, false)) return std::nullopt;
    return found->second.states;
}

std::vector<SurfaceState> PaintedSurfaces::states(SurfaceKey key)
{
    const std::lock_guard lock(mutex_);
    const auto found = painted_.find(key);
    return found == painted_.end() ? std::vector<SurfaceState>{} : found->second.states;
}

void PaintedSurfaces::resend(SurfaceKey key)
{
    const std::lock_guard lock(mutex_);
    Painted& painted = painted_.at(key);
    painted.fresh = !painted.states.empty();
}

void PaintedSurfaces::moveTo(SurfaceKey key, SharedSurface surface, std::span<const mapping::SurfaceTransfer> transfers)
{
    const std::lock_guard lock(mutex_);
    Painted& painted = painted_.at(key);
    painted.surface = std::move(surface);
    if (painted.states.empty()) return;
    std::vector<Sum> values;
    for (const SurfaceState& state : painted.states) values.push_back({state});
    for (const mapping::SurfaceTransfer& transfer : transfers) values = mapping::carry(transfer, values);
    painted.states.clear();
    for (const Sum& value : values) painted.states.push_back(value.state);
    painted.fresh = true;
}

} // namespace filasofia::runtime

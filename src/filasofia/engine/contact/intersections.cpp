#include "filasofia/engine/contact/intersections.h"

#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/collision/surface_crossings.h"
#include "filasofia/engine/contact/may_cross.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

// [s] Intersections last. At 1 kHz `filasofia bench contact` shows no cost of one test per 10 ms beside its spread.
constexpr double kInterval = 0.01;
constexpr double kShortest = 1e-5; // [s] it need not be tested more often than in every step
// [m] As an upper bound on the motion between two tests. A tool of 3 mm that is driven through a sheet of 1 mm meets it
// for 4 mm of its way.
constexpr double kTravel = 2.5e-3;
// [s] Between tests of a soft body that does not collide with itself against itself: one that was cut, whose sides
// may part at any time, and of a whole one. Such a test takes as long as two steps: 0.8 ms with 3,000 tetrahedra.
constexpr double kCutInterval = 0.1, kWholeInterval = 1.0;
// Relative to the sum of the proximities: what passes right through a wall by less may be rounding.
constexpr double kShallow = 0.05;

constexpr int kHalvings = 6; // steps by which a depth is halved until it is in a thin body

// [s] What a scraped rim loses for a step or two is pushed out again; what contacts do not know for this long is told.
constexpr double kUnseenFor = 9e-3;

constexpr double kMoved = 1.0; // [s] for which a motion counts as the cause of what is told

bool isDue(double interval, double time, double dt)
{
    // In the middle between two steps, where rounding decides nothing.
    return dt >= interval || std::floor((time + 0.5 * dt) / interval) != std::floor((time - 0.5 * dt) / interval);
}

/// [s] The time between two tests: kInterval, halved until nothing that may meet moves farther than kTravel in it. So
/// the times of a longer interval are among those of a shorter one.
double intervalNow(const ContactDetection& detection)
{
    double squared = 0.0;
    for (std::size_t s = 0; s < detection.surfaces.size(); ++s)
        if (detection.scratch.wanted[s] != 0)
            for (const Vec3& v : detection.surfaces[s].v) squared = std::max(squared, lengthSquared(v));
    double interval = kInterval;
    while (interval * std::sqrt(squared) > kTravel && interval > kShortest) interval *= 0.5;
    return interval;
}

/// Whether contact has lost the place: it is deeper than contacts are followed, or beyond a wall. The rim of a plate
/// that is scraped over tissue at 1 m/s passes through its surface by up to 0.85 mm and is pushed out again.
bool isLost(const SurfaceCrossing& crossing, const SurfacePair& meeting)
{
    return crossing.depth > (crossing.through ? kShallow * meeting.proximities() : meeting.depths());
}

/// A vertex of a surface that lies in another, closed one, if their surfaces do not cross.
std::optional<physics::Intersection> insideOf(const CollisionSurface& inner, const CollisionSurface& outer)
{
    if (!outer.shape->closed || !outer.shape->triangleFaces) return std::nullopt;
    const Vec3 point = inner.x[static_cast<std::size_t>(inner.shape->elements.front().vertices[0])];
    const Bounds at = inner.vertexBounds[static_cast<std::size_t>(inner.shape->elements.front().vertices[0])];
    if (damaged(at) || !meet(at, outer.whole)) return std::nullopt;
    const double depth = depthInside(outer, point);
    if (!(depth > 0.0)) return std::nullopt;
    return physics::Intersection{.first = {}, .second = {}, .depth = depth, .place = point};
}

/// A place in both of two closed surfaces, whose faces coincide so that no edge passes deeply through a triangle: cubes
/// at one place. It is `below` [m] a face of the one, or less if that is thin.
std::optional<physics::Intersection> insideBoth(const CollisionSurface& one, const CollisionSurface& two, double below)
{
    for (const CollisionSurface* each : {&one, &two})
        if (!each->shape->closed || !each->shape->triangleFaces) return std::nullopt;
    const geometry::Triangle& face = one.shape->elements.front().vertices;
    const Vec3 a = one.x[static_cast<std::size_t>(face[0])], b = one.x[static_cast<std::size_t>(face[1])],
               c = one.x[static_cast<std::size_t>(face[2])];
    const Vec3 inwards = -normalized(cross(b - a, c - a));
    for (int halved = 0; halved < kHalvings; ++halved, below *= 0.5) {
        const Vec3 place = 1.0 / 3.0 * (a + b + c) + below * inwards;
        if (!isFinite(place)) break;
        if (!(depthInside(one, place) > 0.0)) continue;
        const double depth = depthInside(two, place);
        if (!(depth > 0.5 * below)) break;
        return physics::Intersection{.first = {}, .second = {}, .depth = depth, .place = place};
    }
    return std::nullopt;
}

class Finder {
public:
    Finder(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners, Coupling& coupling)
        : context_(context), scene_(scene), owners_(owners), plan_(coupling.rigid), detection_(coupling.detection)
    {
    }
    /// What was found of a body against itself stays until it is tested again: now, if surfaces were added. Returns the
    /// pairs of these that pass through something.
    std::vector<std::array<int, 2>> run(const std::vector<bool>& added)
    {
        const bool all = !added.empty();
        const bool cut = all || isDue(kCutInterval, scene_.time, context_.dt);
        const bool whole = all || isDue(kWholeInterval, scene_.time, context_.dt);
        noteMoves();
        const std::vector<physics::Intersection> toldBefore = watch_.told;
        std::vector<physics::Intersection>& folded = watch_.folded;
        const auto isTested = [&](const SurfaceOwner& owner) {
            return owner.soft && (scene_.soft[owner.body].model.opened ? cut : whole);
        };
        std::erase_if(folded, [&](const physics::Intersection& each) {
            return all || std::ranges::any_of(owners_, [&](const SurfaceOwner& owner) {
                       return owner.name.body == each.first && isTested(owner);
                   });
        });
        for (std::size_t s = 0; s < owners_.size(); ++s)
            if (isTested(owners_[s])) testFolds(static_cast<int>(s));
        watch_.told = folded;
        lostBefore_ = std::exchange(watch_.lost, {});
        const std::vector<IntersectionWatch::Unseen> before = std::exchange(watch_.unseen, {});
        std::vector<std::array<int, 2>> starts;
        for (const std::array<int, 2>& pair : detection_.scratch.surfacePairs)
            if (const bool passes = test(pair, before); passes && all)
                if (added[static_cast<std::size_t>(pair[0])] || added[static_cast<std::size_t>(pair[1])])
                    starts.push_back(pair);
        const auto bodies = [](const physics::Intersection& each) { return std::pair(each.first, each.second); };
        std::ranges::sort(watch_.told, {}, bodies);
        for (physics::Intersection& each : watch_.told) {
            const auto then = std::ranges::find(toldBefore, bodies(each), bodies);
            each.cause = then != toldBefore.end() ? then->cause : causeOf(each, added);
        }
        return starts;
    }

private:
    /// Notes which surfaces that are told where to be have moved since the last test: also by a jump.
    void noteMoves()
    {
        const std::vector<IntersectionWatch::Told> before = std::exchange(watch_.tools, {});
        for (std::size_t s = 0; s < owners_.size(); ++s) {
            const std::vector<Vec3>& x = detection_.surfaces[s].x;
            if (owners_[s].soft || plan_[owners_[s].plan].dynamic || x.empty()) continue;
            IntersectionWatch::Told now{owners_[s].name, {x.front(), x.back()}, -kMoved};
            const auto then = std::ranges::find(before, now.surface, &IntersectionWatch::Told::surface);
            if (then != before.end()) now.moved = then->ends == now.ends ? then->moved : scene_.time;
            watch_.tools.push_back(now);
        }
    }

    [[nodiscard]] bool isSpared(const SurfaceOwner& owner) const
    {
        return owner.soft && engine::isSpared(scene_.soft[owner.body].model, *owner.collision);
    }

    /// Whether all surfaces of a body collide with it, so that contacts should have held it apart.
    [[nodiscard]] bool meetsItself(BodyId body) const
    {
        for (std::size_t s = 0; s < owners_.size(); ++s)
            if (owners_[s].name.body == body && !detection_.surfaces[s].self && !isSpared(owners_[s])) return false;
        return true;
    }

    [[nodiscard]] physics::IntersectionCause causeOf(const physics::Intersection& found,
                                                     const std::vector<bool>& added) const
    {
        using enum physics::IntersectionCause;
        if (found.first == found.second && !meetsItself(found.first)) return Own;
        const auto isOne = [&](BodyId id) { return id == found.first || id == found.second; };
        for (std::size_t s = 0; s < added.size(); ++s)
            if (added[s] && isOne(owners_[s].name.body)) return Start;
        for (const auto& [one, two] : detection_.startedInside)
            if (std::pair<BodyId, BodyId>(std::minmax(one.body, two.body)) == std::pair(found.first, found.second))
                return Start;
        const auto hasMoved = [&](const IntersectionWatch::Told& each) {
            return isOne(each.surface.body) && scene_.time - each.moved < kMoved;
        };
        return std::ranges::any_of(watch_.tools, hasMoved) ? Told : Lost;
    }

    /// Whether the two pass through each other, deeper than contacts are followed. What may be over soon is not told
    /// yet.
    bool test(std::array<int, 2> pair, std::span<const IntersectionWatch::Unseen> before)
    {
        const SurfaceOwner &one = ownerOf(pair[0]), &two = ownerOf(pair[1]);
        if (!movable(one, plan_) && !movable(two, plan_)) return false; // scenery
        const CollisionSurface &a = surfaceOf(pair[0]), &b = surfaceOf(pair[1]);
        const SurfacePair meeting{{&a, &b}, pair, 0.0};
        const bool held = areAttached(scene_, one.name.body, two.name.body);
        cross(pair);
        eraseHeld(scene_, one, two, pair, crossings_);
        if (const auto channels = channelsBetween(scene_, one.name.body, two.name.body); !channels.empty())
            return testBesideChannels(channels, meeting, one, two);
        if (meeting.self()) eraseClipped(one);
        const bool unseen = !meeting.self() && !crossings_.empty() && isUnseen(meeting, before);
        bool passes = false;
        const auto tell = [&](const physics::Intersection& found) {
            add(one, two, found, watch_.told);
            keepLost(one, two, scene_.time);
            passes = true;
        };
        for (const SurfaceCrossing& each : crossings_)
            if (unseen || isLost(each, meeting)) tell({.crossings = 1, .depth = each.depth, .place = each.place});
        if (!crossings_.empty() && one.soft == two.soft) keepLost(one, two, {});
        if (!unseen && !held) passes = tellDeepInRound(meeting, one, two, before, tell) || passes;
        if (passes || meeting.self() || held) return passes;
        const bool touch = !crossings_.empty();
        if (const auto within = touch ? std::nullopt : insideOf(a, b))
            tell(*within);
        else if (const auto around = touch ? std::nullopt : insideOf(b, a))
            tell(*around);
        else if (const auto both = insideBoth(a, b, meeting.depths());
                 both && (!touch || both->depth > 0.5 * meeting.depths())) // where they cross, contacts bear less
            add(one, two, *both, watch_.told); // only told: parted by lines of intersection, cubes fly at 18 m/s
        return passes;
    }

    /// A line may cross tissue where it runs through it, and nowhere else. Nothing parts them: it would be drawn out of
    /// its channel.
    bool testBesideChannels(std::span<const WideChannel> channels, const SurfacePair& meeting, const SurfaceOwner& one,
                            const SurfaceOwner& two)
    {
        bool passes = false;
        for (const SurfaceCrossing& each : crossings_) {
            const auto isHere = [&](const WideChannel& channel) {
                return isIn(channel, each.place, meeting.proximities(), scene_);
            };
            if (std::ranges::any_of(channels, isHere) || !isLost(each, meeting)) continue;
            add(one, two, {.crossings = 1, .depth = each.depth, .place = each.place}, watch_.told);
            passes = true;
        }
        return passes;
    }

    /// A ball has no edge that passes through a triangle, and a capsule one in its middle: what is deeper in them than
    /// contacts follow a mesh counts as passing through. Returns whether something is, also if that is not told yet.
    template <class Tell> bool tellDeepInRound(const SurfacePair& meeting, const SurfaceOwner& one,
                                               const SurfaceOwner& two,
                                               std::span<const IntersectionWatch::Unseen> before, const Tell& tell)
    {
        const CollisionModel &a = *one.collision, &b = *two.collision;
        if (one.soft || two.soft || a.round + b.round == 0.0) return false;
        const double followed = a.proximity + insetDepth(a.proximity) + b.proximity + insetDepth(b.proximity);
        physics::Intersection deep;
        for (const Proximity& each : detection_.proximities) {
            if (each.surfaces != meeting.places) continue;
            const double depth = insetAt(a, each, 0) + insetAt(b, each, 1) - each.gap;
            if (!(depth > followed)) continue;
            ++deep.crossings;
            if (!(depth > deep.depth)) continue;
            deep.depth = depth;
            deep.place = {};
            const std::size_t round = a.round > 0.0 ? 0 : 1;
            for (std::size_t k = 0; k < 3; ++k)
                if (const int vertex = each.vertices[round][k]; vertex >= 0)
                    deep.place += each.weights[round][k] * meeting.sides[round]->x[static_cast<std::size_t>(vertex)];
        }
        if (deep.crossings == 0) return false;
        if (hasLasted(meeting, before)) tell(deep);
        return true;
    }

    /// Whether edges have been inside by more than the contacts between these surfaces know, for long enough.
    bool isUnseen(const SurfacePair& meeting, std::span<const IntersectionWatch::Unseen> before)
    {
        double known = 0.0, deepest = 0.0; // [m] between the inset surfaces
        for (std::size_t i = 0; i < detection_.proximities.size(); ++i) {
            const Proximity& each = detection_.proximities[i];
            if (detection_.followed[i] != 0 && !each.parting && each.surfaces == meeting.places)
                known = std::max(known, -each.gap);
        }
        for (const SurfaceCrossing& each : crossings_) deepest = std::max(deepest, each.depth);
        // A contact that finds such a place in one step loses it in the next: only parting ends it.
        if (lostBefore(meeting, before) != before.end()) known = 0.0;
        return deepest > known + kShallow * meeting.proximities() && hasLasted(meeting, before);
    }

    static std::array<SurfaceName, 2> namesOf(const SurfacePair& meeting)
    {
        std::array<SurfaceName, 2> names{meeting.sides[0]->name, meeting.sides[1]->name};
        std::ranges::sort(names);
        return names;
    }
    static std::span<const IntersectionWatch::Unseen>::iterator
    lostBefore(const SurfacePair& meeting, std::span<const IntersectionWatch::Unseen> before)
    {
        return std::ranges::find(before, namesOf(meeting), &IntersectionWatch::Unseen::surfaces);
    }

    /// Notes that two surfaces have lost each other; whether they have for long enough to be told.
    bool hasLasted(const SurfacePair& meeting, std::span<const IntersectionWatch::Unseen> before)
    {
        const auto then = lostBefore(meeting, before);
        const double since = then != before.end() ? then->since : scene_.time;
        watch_.unseen.push_back({namesOf(meeting), since});
        return scene_.time - since >= kUnseenFor;
    }

    void cross(std::array<int, 2> pair) { findCrossings(context_, pair, detection_, crossings_); }

    void eraseClipped(const SurfaceOwner& owner)
    {
        std::erase_if(crossings_, [&](const SurfaceCrossing& each) { return isClipped(scene_, owner, each.place); });
    }

    void testFolds(int place)
    {
        CollisionSurface& surface = detection_.surfaces[static_cast<std::size_t>(place)];
        const SurfaceOwner& owner = ownerOf(place);
        if (surface.self || isSpared(owner) || surface.shape->nodes.empty()) return;
        findPieces(scene_.soft[owner.body].model, *owner.collision, surface.pieceOf);
        cross({place, place});
        eraseClipped(owner);
        for (const SurfaceCrossing& each : crossings_)
            if (isLost(each, {{&surface, &surface}, {place, place}}))
                add(owner, owner, {.crossings = 1, .depth = each.depth, .place = each.place}, watch_.folded);
    }

    /// Notes a pair as lost: since when it was before, or else since `now`; without that, only if it was before.
    void keepLost(const SurfaceOwner& one, const SurfaceOwner& two, std::optional<double> now)
    {
        const std::array names{one.name, two.name};
        if (!watch_.lost.empty() && watch_.lost.back().surfaces == names) return;
        const auto then = std::ranges::find(lostBefore_, names, &IntersectionWatch::Unseen::surfaces);
        if (then != lostBefore_.end())
            watch_.lost.push_back(*then);
        else if (now)
            watch_.lost.push_back({names, *now});
    }

    static void add(const SurfaceOwner& one, const SurfaceOwner& two, physics::Intersection found,
                    std::vector<physics::Intersection>& to)
    {
        std::tie(found.first, found.second) = std::minmax(one.name.body, two.name.body);
        for (physics::Intersection& each : to) {
            if (each.first != found.first || each.second != found.second) continue;
            found.crossings += each.crossings;
            if (each.depth > found.depth) found.depth = each.depth, found.place = each.place;
            each = found;
            return;
        }
        to.push_back(found);
    }

    const SurfaceOwner& ownerOf(int surface) const { return owners_[static_cast<std::size_t>(surface)]; }
    const CollisionSurface& surfaceOf(int surface) const
    {
        return detection_.surfaces[static_cast<std::size_t>(surface)];
    }

    const StepContext& context_;
    const Scene& scene_;
    const std::vector<SurfaceOwner>& owners_;
    const RigidPlan& plan_;
    ContactDetection& detection_;
    IntersectionWatch& watch_ = detection_.intersections;
    std::vector<IntersectionWatch::Unseen> lostBefore_;
    std::vector<SurfaceCrossing> crossings_;
};

} // namespace

void findCrossings(const StepContext& context, std::array<int, 2> pair, ContactDetection& detection,
                   std::vector<SurfaceCrossing>& crossings)
{
    CollisionSurface &one = detection.surfaces[static_cast<std::size_t>(pair[0])],
                     &two = detection.surfaces[static_cast<std::size_t>(pair[1])];
    const SurfacePair meeting{{&one, &two}, pair, 0.0};
    // With boxes around the surface as it is now: nearly all of those around its motion overlap, if it is fast.
    if (meeting.self()) boundSurface(one, 0.0);
    crossings.clear();
    findSurfaceCrossings(meeting, context.pool, detection.scratch, crossings);
    if (meeting.self()) boundSurface(one, kStepsAhead * context.dt);
}

std::vector<std::array<int, 2>> reportIntersections(const StepContext& context, const Scene& scene,
                                                    const std::vector<SurfaceOwner>& owners,
                                                    const std::vector<bool>& added, Coupling& coupling)
{
    std::vector<std::array<int, 2>> starts;
    if (!added.empty() || isDue(intervalNow(coupling.detection), scene.time, context.dt))
        starts = Finder(context, scene, owners, coupling).run(added);
    context.report.intersections = coupling.detection.intersections.told;
    if (!context.report.intersections.empty()) context.report.set(physics::StepFlag::Intersecting);
    return starts;
}

} // namespace filasofia::engine

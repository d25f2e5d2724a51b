#include "filasofia/engine/contact/starts_inside.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/collision/deep_points.h"
#include "filasofia/engine/contact/part_crossings.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

/// Points of either surface that are deeper in the other one than contacts are followed. A rigid surface determines the
/// way out at any depth, tissue does not: points in tissue are only counted.
struct DeepPoints {
    std::vector<Proximity> inRigid, inTissue;
};

SurfacePair meetingOf(const ContactDetection& detection, std::array<int, 2> pair)
{
    const auto i = static_cast<std::size_t>(pair[0]), k = static_cast<std::size_t>(pair[1]);
    return {{&detection.surfaces[i], &detection.surfaces[k]}, pair, 0.0};
}

DeepPoints deepPointsOf(const std::vector<SurfaceOwner>& owners, const ContactDetection& detection,
                        std::array<int, 2> pair)
{
    const SurfacePair meeting = meetingOf(detection, pair);
    DeepPoints deep;
    findDeepPoints(meeting, 0, owners[static_cast<std::size_t>(pair[1])].soft ? deep.inTissue : deep.inRigid);
    findDeepPoints(meeting, 1, owners[static_cast<std::size_t>(pair[0])].soft ? deep.inTissue : deep.inRigid);
    return deep;
}

/// Whether one of two different surfaces is new, and one of them can move.
bool isStart(const std::vector<SurfaceOwner>& owners, const std::vector<bool>& added, std::array<int, 2> pair,
             const RigidPlan& plan)
{
    const auto i = static_cast<std::size_t>(pair[0]), k = static_cast<std::size_t>(pair[1]);
    return i != k && (added[i] || added[k]) && (movable(owners[i], plan) || movable(owners[k], plan));
}

/// [m] How deep the tubes, or insets, of two surfaces are in each other by their contacts; 0: not at all.
double depthOf(const SurfaceOwner& one, const SurfaceOwner& two, const ContactDetection& detection,
               std::array<int, 2> pair)
{
    double depth = 0.0;
    for (const Proximity& each : detection.proximities)
        if (each.surfaces == pair)
            depth = std::max(depth, insetAt(*one.collision, each, 0) + insetAt(*two.collision, each, 1) - each.gap);
    return depth;
}

/// The rod, of two, whose tube is in the other body by more than half of its radius, and than that body's contacts are
/// found from; nullptr: neither is. Contacts follow it up to its centre line, so nothing is lost, but a tube so deep is
/// pushed out by whatever force that takes: with a radius in the wrong unit by meganewtons.
const SurfaceOwner* deepTube(const Scene& scene, const SurfaceOwner& one, const SurfaceOwner& two,
                             const ContactDetection& detection, std::array<int, 2> pair)
{
    const double depth = depthOf(one, two, detection, pair);
    const auto isDeep = [&](const SurfaceOwner& rod, const SurfaceOwner& other) {
        return isLine(scene, rod) && depth > std::max(0.5 * rod.collision->round, other.collision->proximity);
    };
    return isDeep(one, two) ? &one : isDeep(two, one) ? &two : nullptr;
}

/// Warns of a rod that starts in itself by more than half of its radius.
void warnOfRodsInThemselves(const Scene& scene, const std::vector<SurfaceOwner>& owners, const std::vector<bool>& added,
                            const ContactDetection& detection)
{
    for (const std::array<int, 2>& pair : detection.scratch.surfacePairs) {
        const auto i = static_cast<std::size_t>(pair[0]);
        if (pair[0] != pair[1] || !added[i] || !isLine(scene, owners[i])) continue;
        const SurfaceOwner& rod = owners[i];
        const double depth = depthOf(rod, rod, detection, pair);
        if (depth > 0.5 * rod.collision->round)
            logWarning("body '", nameOf(scene, rod), "' starts inside itself, by ", std::round(1e5 * depth) / 100.0,
                       " mm: it is pushed apart, as its radius is ", 1e3 * rod.collision->round, " mm");
    }
}

/// What becomes of them.
std::string prospectOf(const Scene& scene, const SurfaceOwner& one, const SurfaceOwner& two, const DeepPoints& deep,
                       const SurfaceOwner* tube, bool crosses)
{
    if (tube != nullptr)
        return text("they are pushed apart, as the radius of '", nameOf(scene, *tube), "' is ",
                    1e3 * tube->collision->round, " mm");
    if (partsFrom(one, two, scene) && (crosses || one.soft)) return "they part where their surfaces cross";
    const bool round = one.collision->round + two.collision->round > 0.0;
    if (!deep.inRigid.empty() || (round && !one.soft && !two.soft)) return "they are pushed apart";
    if (one.soft || two.soft) return deep.inTissue.empty() ? "they may stay so" : "points inside tissue stay there";
    return "they may stay so: no point of one is deep inside the other";
}

} // namespace

void noteStartsInside(const std::vector<SurfaceOwner>& owners, const std::vector<bool>& added, Coupling& coupling)
{
    ContactDetection& detection = coupling.detection;
    for (const std::array<int, 2>& pair : detection.scratch.surfacePairs) {
        if (!isStart(owners, added, pair, coupling.rigid)) continue;
        const DeepPoints deep = deepPointsOf(owners, detection, pair);
        if (deep.inRigid.empty() && deep.inTissue.empty()) continue;
        detection.startedInside.push_back(
            {owners[static_cast<std::size_t>(pair[0])].name, owners[static_cast<std::size_t>(pair[1])].name});
    }
}

void addDeepPoints(const std::vector<SurfaceOwner>& owners, ContactDetection& detection)
{
    const std::vector<std::array<SurfaceName, 2>>& started = detection.startedInside;
    const std::vector<IntersectionWatch::Unseen>& lost = detection.intersections.lost;
    if (started.empty() && lost.empty()) return;
    for (const std::array<int, 2>& pair : detection.scratch.surfacePairs) {
        const SurfaceOwner &one = owners[static_cast<std::size_t>(pair[0])],
                           &two = owners[static_cast<std::size_t>(pair[1])];
        const std::array names{one.name, two.name};
        const bool isLost =
            one.soft != two.soft && std::ranges::find(lost, names, &IntersectionWatch::Unseen::surfaces) != lost.end();
        if (!isLost && std::ranges::find(started, names) == started.end()) continue;
        const DeepPoints deep = deepPointsOf(owners, detection, pair);
        detection.proximities.insert(detection.proximities.end(), deep.inRigid.begin(), deep.inRigid.end());
    }
}

void warnOfStartsInside(const Scene& scene, const std::vector<SurfaceOwner>& owners, const std::vector<bool>& added,
                        std::span<const std::array<int, 2>> crossing, const Coupling& coupling)
{
    const ContactDetection& detection = coupling.detection;
    warnOfRodsInThemselves(scene, owners, added, detection);
    std::vector<std::array<BodyId, 2>> told;
    for (const std::array<int, 2>& pair : detection.scratch.surfacePairs) {
        if (!isStart(owners, added, pair, coupling.rigid)) continue;
        const SurfaceOwner &one = owners[static_cast<std::size_t>(pair[0])],
                           &two = owners[static_cast<std::size_t>(pair[1])];
        const std::array bodies{std::min(one.name.body, two.name.body), std::max(one.name.body, two.name.body)};
        if (std::ranges::find(told, bodies) != told.end()) continue;
        const std::array names{one.name, two.name};
        const std::vector<std::array<SurfaceName, 2>>& noted = detection.startedInside;
        const bool crosses = std::ranges::find(crossing, pair) != crossing.end();
        const bool meet = crosses || overlapDeep(meetingOf(detection, pair));
        const SurfaceOwner* tube = deepTube(scene, one, two, detection, pair);
        const bool tied = std::ranges::any_of(scene.attachments, [&](const Attachment& each) {
            return std::array{std::min(each.body, each.to), std::max(each.body, each.to)} == bodies;
        });
        if (std::ranges::find(noted, names) == noted.end() && (!(meet || tube != nullptr) || tied)) continue;
        told.push_back(bodies);
        logWarning("body '", nameOf(scene, one), "' and body '", nameOf(scene, two), "' start inside each other: ",
                   prospectOf(scene, one, two, deepPointsOf(owners, detection, pair), tube, crosses));
    }
}

} // namespace filasofia::engine

#pragma once

#include "filasofia/engine/collision/surface_crossings.h"
#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/scene/scene.h"

#include <array>
#include <span>
#include <vector>

/// Where surfaces may pass through each other: at attachments, along channels, between the legs of clips.
namespace filasofia::engine {

/// A place on a surface: some of its vertices.
struct SurfacePlace {
    const SurfaceOwner& owner;
    std::span<const int> vertices; ///< -1: unused
};
/// Whether an attachment between the bodies of two places holds one of them: attached bodies may overlap there.
bool holdsTogether(const Scene& scene, const SurfacePlace& one, const SurfacePlace& two);
/// Whether an attachment to the other body holds this place.
bool isHeldBy(const Scene& scene, const SurfacePlace& place, BodyId other);
/// Whether two bodies are attached to each other anywhere.
bool areAttached(const Scene& scene, BodyId a, BodyId b);

/// Erases the crossings of a pair of surfaces, at these places in the list, at what attaches their bodies to each
/// other.
void eraseHeld(const Scene& scene, const SurfaceOwner& one, const SurfaceOwner& two, std::array<int, 2> places,
               std::vector<SurfaceCrossing>& crossings);

/// A channel with the radius of the thickest line in it. Valid until the scene's channels change.
struct WideChannel {
    const Channel* channel = nullptr;
    double radius = 0.0; ///< [m]
};
/// The channels in which one of two bodies runs through the other.
std::vector<WideChannel> channelsBetween(const Scene& scene, BodyId a, BodyId b);
/// Whether a line that crosses the surface of tissue does so in its channel, or beside it by as little as contacts of
/// the line are left to the channel. `proximities` [m]: the sum of both surfaces.
bool isIn(const WideChannel& wide, Vec3 place, double proximities, const Scene& scene);

/// Whether a place lies between the legs of a clip on this body, or beside them by less than half its opening. Walls of
/// a lumen are through each other there: that is what shut means. Other walls there are not told either.
bool isClipped(const Scene& scene, const SurfaceOwner& owner, Vec3 place);

} // namespace filasofia::engine

#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/body/attachment.h"

#include <cstddef>
#include <vector>

namespace filasofia::engine {

/// A line of a rigid body's element with a sharp front: a needle.
struct Needle {
    std::size_t element = 0;
    double radius = 0.0;      ///< [m]
    double spacing = 0.0;     ///< [m] distance of the points at which tissue holds it
    std::vector<Vec3> points; ///< [m] from the tip to the tail, in the element's coordinates
};

/// How tissue resists needles.
struct PunctureModel {
    double force = 0.0;                          ///< [N] on the tip, breaks the surface
    double cutting = 0.0;                        ///< [N] on the tip while it advances
    double friction = 0.0, staticFriction = 0.0; ///< [N/m] per length of shaft
    double stiffness = 0.0;                      ///< [Pa] force per length and distance
    bool ofMaterial = false;                     ///< the stiffness follows the tissue's Young's modulus
};

/// A line that runs through a channel: a needle, or the rod that follows it.
struct ThreadedLine {
    BodyId body;
    bool reversed = false; ///< rods: the last node goes first
    double start = 0.0;    ///< [m] how far its front is behind the needle's tip, along all lines
    std::size_t first = 0; ///< rods: how many nodes at that end do not belong to it, since they were cut off
};

/// A point of a channel: it is fixed in the tissue.
struct ChannelPoint {
    std::vector<NodeWeight> nodes; ///< the corners of one tetrahedron
    double before = 0.0;           ///< [m] how far the tip cut from the point before to this one
    double held = 0.0;             ///< [m] the place on the lines that sticks to it, behind the needle's tip
    bool slides = false;           ///< the lines slid through it in the last step
    double pressed = 0.0;          ///< [N] the force across the line in the last step
};

/// The channel of a needle in a tissue. A topology edit updates the points: their nodes are stored nowhere else.
struct Channel {
    BodyId tissue;
    double spacing = 0.0;             ///< [m] distance of its points: that of the needle that pierced it
    std::vector<ThreadedLine> lines;  ///< the needle first, then what follows it; each is tied to the next
    std::vector<ChannelPoint> points; ///< from where the needle went in
    std::vector<NodeWeight> end;      ///< the deepest place that the tip has reached
    double travelled = 0.0;           ///< [m] how far the tip has come since the last point
    bool through = false;             ///< the tip has left the tissue; the last point is where
};

/// Parts a channel: its lines from number `line` on and its first `points` points, those at the entry, go into the
/// channel that is returned.
Channel takeBehind(std::ptrdiff_t line, std::ptrdiff_t points, Channel& channel);

/// [m] How far a place is from the path that was cut, from point `first` on to the deepest place. x: the tissue's
/// nodes.
double distanceToPath(const Channel& channel, Vec3 place, const std::vector<Vec3>& x, std::size_t first = 0);

} // namespace filasofia::engine

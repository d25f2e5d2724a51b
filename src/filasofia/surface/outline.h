#pragma once

#include <array>
#include <vector>

/// Closed outlines in a plane, of a few points each, which may cross themselves.
namespace filasofia::surface {

/// [m] Corners, in their order; the last is followed by the first.
using Outline = std::vector<std::array<double, 2>>;

/// Whether two of its edges that do not follow each other cross.
bool crossesItself(const Outline& outline);

/// The outline cut where it crosses itself: loops that do not, each traversed in the outline's sense.
std::vector<Outline> lobesOf(const Outline& outline);

/// Area [m^2], negative if it is traversed clockwise, and the area's second moments [m^4] about its own centre.
struct AreaMoments {
    double area = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
};
AreaMoments momentsOf(const Outline& outline);

} // namespace filasofia::surface

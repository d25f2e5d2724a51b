#include "filasofia/engine/collision/plates.h"

#include "filasofia/engine/collision/collision_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

constexpr float kRounding = 0x1p-20f; // [-] sixteen roundings of the largest coordinate

FourFloats smaller(FourFloats a, FourFloats b) { return a < b ? a : b; }
float least(FourFloats a)
{
    const FourFloats pairs = smaller(a, FourFloats{a[2], a[3], a[0], a[1]});
    return std::min(pairs[0], pairs[1]);
}

/// [m] times the length of the axis: how far along it the corners are, from `centre` on.
FourFloats along(FourFloats axis, const Plate& plate, FourFloats centre)
{
    return axis[0] * (plate.x - centre[0]) + axis[1] * (plate.y - centre[1]) + axis[2] * (plate.z - centre[2]);
}

/// Whether all corners of `b` are on one side of the plane of `a`, and farther away.
bool planeSeparates(const Plate& a, const Plate& b, float far)
{
    const FourFloats heights = along(a.normal, b, a.centre);
    return least(heights) > far || least(-heights) > far;
}

void writePlates(const CollisionShape& shape, const std::vector<Vec3>& x, std::vector<Plate>& plates)
{
    const std::vector<CollisionShape::Element>& elements = shape.elements;
    plates.resize(elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const std::array<int, 3>& corners = elements[i].vertices;
        const Vec3 a = x[corners[0]], b = corners[1] >= 0 ? x[corners[1]] : a, c = corners[2] >= 0 ? x[corners[2]] : b;
        const auto row = [&](int k) {
            const auto last = static_cast<float>(c[k]);
            return FourFloats{static_cast<float>(a[k]), static_cast<float>(b[k]), last, last};
        };
        Plate& plate = plates[i];
        plate.x = row(0), plate.y = row(1), plate.z = row(2);
        float largest = 0.0f;
        for (const FourFloats& each : {plate.x, plate.y, plate.z})
            for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(each[k]));
        const Vec3 centre = 1.0 / 3.0 * (a + b + c), normal = cross(b - a, c - a);
        // With an infinite allowance, an element that is not finite is never told to be far from anything.
        const float allowance = isFinite(centre) ? kRounding * largest : std::numeric_limits<float>::infinity();
        plate.centre = FourFloats{static_cast<float>(centre.x), static_cast<float>(centre.y),
                                  static_cast<float>(centre.z), allowance};
        const double area = length(normal), longest = std::max(lengthSquared(b - a), lengthSquared(c - a));
        const Vec3 unit =
            area * area > kSliver * longest * longest ? 1.0 / area * normal : Vec3{}; // else it is rounding
        plate.normal =
            FourFloats{static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z), 0.0f};
    }
}

} // namespace

void makePlates(CollisionSurface& surface) { writePlates(*surface.shape, surface.x, surface.plates); }

void makeRestPlates(CollisionSurface& surface)
{
    if (surface.restPlatesOf == surface.shape) return;
    writePlates(*surface.shape, surface.shape->rest, surface.restPlates);
    surface.restPlatesOf = surface.shape;
}

bool farApart(const Plate& a, const Plate& b, float far)
{
    const float apart = far + a.centre[3] + b.centre[3];
    const FourFloats axis = b.centre - a.centre;
    const float gap = least(along(axis, b, a.centre)) + least(-along(axis, a, a.centre));
    const float squared = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    return (gap > 0.0f && gap * gap > apart * apart * squared) || planeSeparates(a, b, apart) ||
           planeSeparates(b, a, apart);
}

float wallBetween(const Plate& a, const Plate& b)
{
    const float behind = std::min(least(-along(a.normal, b, a.centre)), least(-along(b.normal, a, b.centre)));
    const float thickness = behind - a.centre[3] - b.centre[3];
    return thickness > 0.0f ? thickness : 0.0f; // not NaN either
}

} // namespace filasofia::engine

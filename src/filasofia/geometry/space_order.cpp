#include "filasofia/geometry/space_order.h"

#include "filasofia/geometry/box.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace filasofia::geometry {
namespace {

/// Moves bit i of `value` to bit 3 i.
std::uint64_t spread(std::uint64_t value)
{
    std::uint64_t out = 0;
    for (int bit = 0; bit < 21; ++bit) out |= (value >> bit & 1u) << (3 * bit);
    return out;
}

} // namespace

std::vector<int> orderAlongCurve(std::span<const Vec3> points)
{
    Box box;
    for (const Vec3& p : points) box = merged(box, p);
    const Vec3 size = box.high - box.low;
    const double largest = std::max({size.x, size.y, size.z});
    const auto step = [&](double along) { // in [0, 2^20); one scale for all axes, so that cells are cubes
        return largest > 0.0 ? static_cast<std::uint64_t>(along / largest * 1048575.0) : 0u;
    };
    std::vector<std::uint64_t> codes;
    codes.reserve(points.size());
    for (const Vec3& p : points)
        codes.push_back(spread(step(p.x - box.low.x)) | spread(step(p.y - box.low.y)) << 1 |
                        spread(step(p.z - box.low.z)) << 2);
    std::vector<int> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return codes[a] < codes[b]; });
    return order;
}

} // namespace filasofia::geometry

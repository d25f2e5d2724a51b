#include "filasofia/runtime/strands.h"

#include "filasofia/core/hash.h"

#include <array>
#include <cmath>
#include <numbers>

namespace filasofia::runtime {
namespace {

constexpr int kSides = 4;
// [-] In radii, from end to end: a strand spreads where it grows into the organ.
constexpr std::array<double, 5> kThickness = {1.8, 1.0, 0.7, 1.0, 1.8};
constexpr int kRings = static_cast<int>(kThickness.size());
constexpr double kShort = 4.0; // [radii] shorter strands are thinner: between organs that touch there is nothing to see

/// [-], in [-1, 1): two numbers that belong to a strand.
std::array<double, 2> scatterOf(int node, int strand)
{
    Hasher hash;
    hash.add(static_cast<std::uint64_t>(node));
    hash.add(static_cast<std::uint64_t>(strand));
    const auto part = [&](int shift) { return static_cast<double>(hash.value() >> shift & 0xffff) / 32768.0 - 1.0; };
    return {part(0), part(16)};
}

/// Two unit vectors across a direction.
std::array<Vec3, 2> acrossTo(Vec3 along)
{
    const Vec3 first = normalized(cross(along, std::abs(along.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    return {first, cross(along, first)};
}

void writeStrand(Vec3 from, Vec3 to, double radius, std::vector<Vec3>& vertices)
{
    const double span = distance(from, to);
    const auto [one, two] = acrossTo(normalized(to - from, {0, 0, 1}));
    const double thick = radius * std::min(1.0, span / (kShort * radius));
    for (int ring = 0; ring < kRings; ++ring) {
        const double at = static_cast<double>(ring) / (kRings - 1);
        const Vec3 centre = from + at * (to - from);
        for (int side = 0; side < kSides; ++side) {
            const double turn = 2.0 * std::numbers::pi * side / kSides;
            vertices.push_back(centre + thick * kThickness[static_cast<std::size_t>(ring)] *
                                            (std::cos(turn) * one + std::sin(turn) * two));
        }
    }
}

} // namespace

geometry::TriangleMesh strandMesh(int count, Vec3 place)
{
    geometry::TriangleMesh mesh;
    mesh.vertices.assign(static_cast<std::size_t>(count * kRings * kSides), place);
    for (int strand = 0; strand < count; ++strand)
        for (int ring = 0; ring + 1 < kRings; ++ring)
            for (int side = 0; side < kSides; ++side) {
                const int low = (strand * kRings + ring) * kSides, next = (side + 1) % kSides;
                mesh.triangles.push_back({low + side, low + next, low + kSides + next});
                mesh.triangles.push_back({low + side, low + kSides + next, low + kSides + side});
            }
    return mesh;
}

int writeStrands(const std::vector<frame::AttachedPoint>& points, AttachmentId attachment, const StrandsDef& def,
                 std::vector<Vec3>& vertices)
{
    int count = 0;
    for (const frame::AttachedPoint& each : points) {
        if (each.attachment != attachment) continue;
        const auto [one, two] = acrossTo(normalized(each.toPlace - each.place, {0, 0, 1}));
        for (int strand = 0; strand < def.perPoint; ++strand, ++count) {
            const auto [a, b] = scatterOf(each.node, strand);
            const auto [c, d] = scatterOf(each.node, strand + def.perPoint);
            writeStrand(each.place + def.spread * (a * one + b * two), each.toPlace + def.spread * (c * one + d * two),
                        def.radius, vertices);
        }
    }
    return count;
}

} // namespace filasofia::runtime

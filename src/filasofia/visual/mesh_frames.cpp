#include "filasofia/visual/mesh_frames.h"

#include <algorithm>
#include <cmath>

namespace filasofia::visual {
namespace {

Float3 scaled(Float3 v, float by) { return {by * v.x, by * v.y, by * v.z}; }

} // namespace

void vertexNormals(std::span<const Float3> positions, std::span<const std::uint32_t> indices,
                   std::vector<Float3>& normals)
{
    normals.assign(positions.size(), {});
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::array<std::uint32_t, 3> corners{indices[i], indices[i + 1], indices[i + 2]};
        const auto [a, b, c] = corners;
        const std::array<Float3, 3> edges{positions[c] - positions[b], positions[a] - positions[c],
                                          positions[b] - positions[a]};
        const Float3 normal = cross(edges[2], positions[c] - positions[a]);
        const float area = std::sqrt(dot(normal, normal)); // twice
        std::array<float, 3> share{};                      // 1 / length^2 of the edge opposite each corner
        for (std::size_t k = 0; k < 3; ++k) share[k] = 1.0F / std::max(dot(edges[k], edges[k]), 1e-30F);
        // The unit normal by the squared sine of the corner's angle. By the area, the edge of a coarse block would tilt
        // to and fro with the diagonals that its vertices happen to have, and be lit in scallops. The two squares of a
        // divided right angle add up to that of the whole. Slivers count little.
        for (std::size_t k = 0; k < 3; ++k)
            normals[corners[k]] = normals[corners[k]] + scaled(normal, area * share[(k + 1) % 3] * share[(k + 2) % 3]);
    }
}

PackedFrame packFrame(Float3 normal)
{
    constexpr float kOne = 32767.0F;
    const float length = std::sqrt(dot(normal, normal));
    const Float3 n =
        length > 1e-30F ? Float3{normal.x / length, normal.y / length, normal.z / length} : Float3{0.0F, 0.0F, 1.0F};
    // The shortest rotation from +Z to n; if n is -Z, half a turn about X.
    const float size = std::sqrt(n.x * n.x + n.y * n.y + (1.0F + n.z) * (1.0F + n.z));
    if (size < 1e-4F) return {32767, 0, 0, 1};
    const auto pack = [&](float v) { return static_cast<std::int16_t>(std::lrint(v / size * kOne)); };
    // w = 0 would lose the sign that gives Filament the handedness of the frame, so w is at least 1.
    return {pack(-n.y), pack(n.x), 0, std::max<std::int16_t>(pack(1.0F + n.z), 1)};
}

VertexData vertexData(std::vector<Float3> positions, std::span<const std::uint32_t> indices,
                      std::vector<Float3>& normals)
{
    VertexData data;
    data.positions = std::move(positions);
    vertexNormals(data.positions, indices, normals);
    data.frames.resize(normals.size());
    std::transform(normals.begin(), normals.end(), data.frames.begin(), packFrame);

    data.low = data.high = data.positions.empty() ? Float3{} : data.positions.front();
    for (Float3 p : data.positions) {
        data.low = {std::min(data.low.x, p.x), std::min(data.low.y, p.y), std::min(data.low.z, p.z)};
        data.high = {std::max(data.high.x, p.x), std::max(data.high.y, p.y), std::max(data.high.z, p.z)};
    }
    return data;
}

PackedFrame packAlignedFrame(Float3 normal, const TangentSum& sum)
{
    const float length = std::sqrt(dot(normal, normal));
    if (!(length > 1e-30F)) return packFrame(normal);
    const Float3 n = scaled(normal, 1.0F / length);
    const Float3 along = sum.alongU - scaled(n, dot(n, sum.alongU));
    const float tangentLength = std::sqrt(dot(along, along));
    // Directions that cancel, or that stand upright on the surface, are rounding and no direction.
    if (!(tangentLength > 1e-3F * std::sqrt(dot(sum.alongU, sum.alongU)))) return packFrame(normal);
    const Float3 t = scaled(along, 1.0F / tangentLength);
    const Float3 b = cross(n, t);

    // The quaternion of the rotation with columns t, b, n, by its largest component (Shepperd, "Quaternion from
    // rotation matrix", 1978).
    std::array<float, 4> q{}; // x, y, z, w, times four times the largest
    if (t.x + b.y + n.z > 0.0F)
        q = {b.z - n.y, n.x - t.z, t.y - b.x, 1.0F + t.x + b.y + n.z};
    else if (t.x > b.y && t.x > n.z)
        q = {1.0F + t.x - b.y - n.z, b.x + t.y, n.x + t.z, b.z - n.y};
    else if (b.y > n.z)
        q = {b.x + t.y, 1.0F + b.y - t.x - n.z, n.y + b.z, n.x - t.z};
    else
        q = {n.x + t.z, n.y + b.z, 1.0F + n.z - t.x - b.y, t.y - b.x};
    const float size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    // q and -q are the same rotation: the sign is free to tell the handedness.
    const bool mirrored = dot(b, sum.alongV) < 0.0F;
    const float sign = (q[3] < 0.0F) != mirrored ? -1.0F : 1.0F;
    std::array<std::int16_t, 4> packed{};
    for (std::size_t k = 0; k < 4; ++k)
        packed[k] = static_cast<std::int16_t>(std::lrint(sign * q[k] / size * 32767.0F));
    if (packed[3] == 0) packed[3] = mirrored ? -1 : 1; // 0 would lose it
    return {packed[0], packed[1], packed[2], packed[3]};
}

void alignFrames(VertexData& data, std::span<const std::uint32_t> indices, std::span<const std::array<float, 2>> uv,
                 std::span<const Float3> normals, std::vector<TangentSum>& sums)
{
    sums.assign(data.positions.size(), {});
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
        const Float3 ab = data.positions[b] - data.positions[a], ac = data.positions[c] - data.positions[a];
        const float bu = uv[b][0] - uv[a][0], bv = uv[b][1] - uv[a][1];
        const float cu = uv[c][0] - uv[a][0], cv = uv[c][1] - uv[a][1];
        const float area = bu * cv - bv * cu;
        // The wall of a cut has the uv of its rim: a line, whose area is rounding.
        if (!(std::abs(area) > 1e-4F * std::sqrt((bu * bu + bv * bv) * (cu * cu + cv * cv)))) continue;
        // Not divided by the area: a triangle counts as much as the picture shows of it.
        const float sign = area < 0.0F ? -1.0F : 1.0F;
        const Float3 alongU = scaled(ab, sign * cv) - scaled(ac, sign * bv);
        const Float3 alongV = scaled(ac, sign * bu) - scaled(ab, sign * cu);
        for (std::uint32_t corner : {a, b, c}) {
            sums[corner].alongU = sums[corner].alongU + alongU;
            sums[corner].alongV = sums[corner].alongV + alongV;
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) data.frames[i] = packAlignedFrame(normals[i], sums[i]);
}

} // namespace filasofia::visual

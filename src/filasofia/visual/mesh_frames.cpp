#include "filasofia/visual/mesh_frames.h"

#include <algorithm>
#include <cmath>

namespace filasofia::visual {

void vertexNormals(std::span<const Float3> positions, std::span<const std::uint32_t> indices,
                   std::vector<Float3>& normals)
{
    normals.assign(positions.size(), {});
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
        // The length of the cross product is twice the area, so large triangles count more.
        const Float3 normal = cross(positions[b] - positions[a], positions[c] - positions[a]);
        for (std::uint32_t corner : {a, b, c}) normals[corner] = normals[corner] + normal;
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

} // namespace filasofia::visual

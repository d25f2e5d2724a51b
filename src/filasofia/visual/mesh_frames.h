#pragma once

#include "filasofia/visual/float3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace filasofia::visual {

/// A tangent frame as a quaternion of four normalised 16-bit numbers x, y, z, w: its axes are the tangent, the
/// bitangent and the normal. w is never 0; if it is negative, the bitangent is -cross(normal, tangent), as on
/// mirrored uv.
struct PackedFrame {
    std::int16_t x, y, z, w;
};

/// The data that change when a surface deforms.
struct VertexData {
    std::vector<Float3> positions; ///< [m]
    std::vector<PackedFrame> frames;
    Float3 low;  ///< [m], corner of the box around the positions
    Float3 high; ///< [m], the other corner
};

/// Area-weighted normals, not of unit length (zero if a vertex has no area around it).
void vertexNormals(std::span<const Float3> positions, std::span<const std::uint32_t> indices,
                   std::vector<Float3>& normals);

/// The frame whose third axis is `normal` (any length; +Z if it is zero).
PackedFrame packFrame(Float3 normal);

/// Normals, frames and box of `positions`; `indices` are three vertices per triangle. `normals` is scratch memory, for
/// callers that come every frame.
VertexData vertexData(std::vector<Float3> positions, std::span<const std::uint32_t> indices,
                      std::vector<Float3>& normals);

/// Directions on the surface along growing u and v around a vertex, summed over its triangles.
struct TangentSum {
    Float3 alongU;
    Float3 alongV;
};

/// The frame whose third axis is `normal` and whose first is `alongU`, made perpendicular; mirrored if `alongV` is on
/// the other side. packFrame(normal) if the uv have no direction.
PackedFrame packAlignedFrame(Float3 normal, const TangentSum& sum);

/// Turns the frames of `data`, about their normals, along the uv of the vertices: what a normal map needs (Lengyel,
/// "Computing tangent space basis vectors for an arbitrary mesh", 2001). A triangle without an area of uv says nothing.
/// `normals` are those of vertexData(); `sums` is room to compute in.
void alignFrames(VertexData& data, std::span<const std::uint32_t> indices, std::span<const std::array<float, 2>> uv,
                 std::span<const Float3> normals, std::vector<TangentSum>& sums);

} // namespace filasofia::visual

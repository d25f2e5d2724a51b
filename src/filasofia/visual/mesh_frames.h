#pragma once

#include "filasofia/visual/float3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace filasofia::visual {

/// A tangent frame as a quaternion of four normalised 16-bit numbers x, y, z, w with w > 0 (no mirrored frames).
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

} // namespace filasofia::visual

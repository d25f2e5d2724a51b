#pragma once

#include "filasofia/math/vec3.h"

namespace filasofia::visual {

/// Three floats without padding, as the graphics card takes them. OpenSubdiv needs the two methods to average values.
struct Float3 {
    float x = 0.0F;
    float y = 0.0F;
    float z = 0.0F;

    void Clear(void* = nullptr) { x = y = z = 0.0F; }
    void AddWithWeight(const Float3& v, float weight)
    {
        x += weight * v.x;
        y += weight * v.y;
        z += weight * v.z;
    }
    friend constexpr bool operator==(const Float3&, const Float3&) = default;
};

constexpr Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Float3 cross(Float3 a, Float3 b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr Float3 toFloat3(Vec3 v)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

} // namespace filasofia::visual

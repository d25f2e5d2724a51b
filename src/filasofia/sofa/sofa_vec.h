#pragma once

#include "filasofia/math/pose.h"

#include <sofa/defaulttype/RigidTypes.h>
#include <sofa/defaulttype/VecTypes.h>

/// Our vectors and poses as SOFA's, and back.
namespace filasofia::sofaengine {

using Vec3Types = ::sofa::defaulttype::Vec3Types;
using RigidTypes = ::sofa::defaulttype::Rigid3Types;

/// An index of ours, into a list.
constexpr std::size_t at(int index) { return static_cast<std::size_t>(index); }

inline ::sofa::type::Vec3 toSofa(Vec3 v) { return {v.x, v.y, v.z}; }
inline Vec3 fromSofa(const ::sofa::type::Vec3& v) { return {v[0], v[1], v[2]}; }
inline ::sofa::type::Quat<SReal> toSofa(const Quat& q) { return {q.x, q.y, q.z, q.w}; }
inline Quat fromSofa(const ::sofa::type::Quat<SReal>& q) { return {q[3], q[0], q[1], q[2]}; }

} // namespace filasofia::sofaengine

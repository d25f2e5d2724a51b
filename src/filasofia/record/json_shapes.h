#pragma once

#include "filasofia/core/error.h"
#include "filasofia/physics/step_record.h"

#include <nlohmann/json.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The JSON form of values in a recording, for the writer and the reader alike. A Def is an object with the fields of
/// its list, a variant an object with one member named after its alternative, an enumeration its value's name, a vector
/// in space or a pose an array, an infinity a word.
namespace filasofia::record {

using Json = nlohmann::ordered_json; ///< keeps members in the order in which they were written

using TetMesh = std::shared_ptr<const geometry::TetMesh>;
using TriangleMesh = std::shared_ptr<const geometry::TriangleMesh>;
using Mesh = std::variant<TetMesh, TriangleMesh>; ///< on a line of its own, referred to by number
template <class T>
concept IsMeshSource = std::is_same_v<T, physics::SoftMeshSource> || std::is_same_v<T, physics::TriangleMeshSource>;

inline constexpr int kVersion = 6;
inline constexpr const char* kInfinite = "infinite";
inline constexpr const char* kMinusInfinite = "-infinite";

/// Small types that are written as an array of their fields.
template <class T>
concept IsPlaces =
    std::is_same_v<T, Vec3> || std::is_same_v<T, Quat> || std::is_same_v<T, Pose> || std::is_same_v<T, geometry::Box>;

template <class T> inline constexpr bool kIsOptional = false;
template <class T> inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T> inline constexpr bool kIsShared = false;
template <class T> inline constexpr bool kIsShared<std::shared_ptr<const T>> = true;
template <class T> inline constexpr bool kIsVariant = false;
template <class... T> inline constexpr bool kIsVariant<std::variant<T...>> = true;
template <class T> inline constexpr bool kIsVector = false;
template <class T> inline constexpr bool kIsVector<std::vector<T>> = true;
template <class T> inline constexpr bool kIsArray = false;
template <class T, std::size_t n> inline constexpr bool kIsArray<std::array<T, n>> = true;

/// The name of an alternative of a variant.
template <class T> constexpr std::string_view typeName()
{
    if constexpr (std::is_same_v<T, double>)
        return "number";
    else if constexpr (std::is_same_v<T, int>)
        return "integer";
    else if constexpr (std::is_same_v<T, bool>)
        return "flag";
    else if constexpr (kIsArray<T>)
        return "numbers";
    else if constexpr (kIsVariant<T>)
        return "either";
    else
        return fields(static_cast<const T*>(nullptr)).typeName;
}
template <class T> constexpr std::size_t fieldCount()
{
    std::size_t count = 0;
    forEachField<T>([&](const auto&) { ++count; });
    return count;
}
/// A type whose last fields are younger than the first recordings says how many those are: `addedFields(const T*)`.
/// They are not written while they have their defaults, and may be missing.
template <class T>
concept HasAddedFields = requires(const T* type)
{
    addedFields(type);
};
/// How many of the first fields every recording has.
template <class T> constexpr std::size_t firstFields()
{
    if constexpr (HasAddedFields<T>)
        return fieldCount<T>() - addedFields(static_cast<const T*>(nullptr));
    else
        return fieldCount<T>();
}

} // namespace filasofia::record

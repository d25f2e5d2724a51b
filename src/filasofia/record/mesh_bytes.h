#pragma once

#include "filasofia/record/json_shapes.h"

#include "filasofia/core/hash.h"

#include <bit>
#include <cstring>

/// Meshes in a recording: their numbers as they are in memory, lowest byte first, after the line that announces them.
namespace filasofia::record {

static_assert(std::endian::native == std::endian::little && sizeof(int) == 4,
              "a recording's meshes are written as they lie in memory");

template <class T> std::string_view bytesOf(const std::vector<T>& list)
{
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T)};
}

/// A list that is younger than the first recordings: if it is missing, it is empty, and it does not change the digest.
inline constexpr std::string_view kLabels = "labels";

/// Calls visit(name, list) for every list of a mesh, in the order of the file.
template <class Visit> void forEachList(auto& mesh, Visit&& visit)
{
    if constexpr (requires { mesh.tetrahedra; }) {
        visit("nodes", mesh.nodes);
        visit("tetrahedra", mesh.tetrahedra);
        visit("labels", mesh.labels);
    } else {
        visit("vertices", mesh.vertices);
        visit("triangles", mesh.triangles);
        visit("uv", mesh.uv);
    }
}

/// A hash of all bytes of a mesh, which identifies it in other sessions.
template <class T> std::uint64_t digestOf(const T& mesh)
{
    Hasher hasher;
    forEachList(mesh, [&](const char* name, const auto& list) {
        if (kLabels == name && list.empty()) return;
        const std::string_view bytes = bytesOf(list);
        hasher.add(static_cast<std::uint64_t>(bytes.size()));
        for (std::size_t at = 0; at < bytes.size(); at += 8) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
            hasher.add(word);
        }
    });
    return hasher.value();
}

} // namespace filasofia::record

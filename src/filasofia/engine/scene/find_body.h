#pragma once

#include "filasofia/engine/scene/scene.h"

#include <algorithm>
#include <optional>

namespace filasofia::engine {

/// The place of a body: which list of the scene, and its index there.
struct BodyPlace {
    bool soft = false;
    std::size_t index = 0;
};

/// The index of a body in a list sorted by ascending id; none if there is no such body.
template <class Bodies> std::optional<std::size_t> findIn(const Bodies& bodies, BodyId id)
{
    const auto found = std::ranges::lower_bound(bodies, id, {}, [](const auto& body) { return body.model.id; });
    if (found == bodies.end() || found->model.id != id) return std::nullopt;
    return static_cast<std::size_t>(found - bodies.begin());
}

/// The same for all bodies of a scene.
inline std::optional<BodyPlace> findBody(const Scene& scene, BodyId id)
{
    if (const auto index = findIn(scene.soft, id)) return BodyPlace{true, *index};
    if (const auto index = findIn(scene.rigid, id)) return BodyPlace{false, *index};
    return std::nullopt;
}

} // namespace filasofia::engine

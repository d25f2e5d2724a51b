#pragma once

#include "filasofia/engine/body/model.h"

#include <algorithm>

namespace filasofia::engine {

/// Where a body is among its kind.
struct BodyPlace {
    bool soft = false;
    std::size_t index = 0;
};

/// The place of a body in a list by rising id; none where there is no such body.
template <class Bodies> std::optional<std::size_t> findIn(const Bodies& bodies, BodyId id)
{
    const auto found = std::lower_bound(bodies.begin(), bodies.end(), id,
                                        [](const auto& body, BodyId wanted) { return body.id < wanted; });
    if (found == bodies.end() || found->id != id) return std::nullopt;
    return static_cast<std::size_t>(found - bodies.begin());
}

/// The same among all bodies.
inline std::optional<BodyPlace> findBody(const Model& model, BodyId id)
{
    if (const auto index = findIn(model.softBodies, id)) return BodyPlace{true, *index};
    if (const auto index = findIn(model.rigidBodies, id)) return BodyPlace{false, *index};
    return std::nullopt;
}

} // namespace filasofia::engine

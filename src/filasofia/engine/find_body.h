#pragma once

#include "filasofia/engine/model.h"

#include <algorithm>

namespace filasofia::engine {

/// Where a body is among its kind.
struct BodyPlace {
    bool soft = false;
    std::size_t index = 0;
};

/// The place of a body by its id; none where there is no such body.
inline std::optional<BodyPlace> findBody(const Model& model, BodyId id)
{
    const auto in = [&](const auto& bodies, bool soft) -> std::optional<BodyPlace> {
        const auto found = std::lower_bound(bodies.begin(), bodies.end(), id,
                                            [](const auto& body, BodyId wanted) { return body.id < wanted; });
        if (found == bodies.end() || found->id != id) return std::nullopt;
        return BodyPlace{soft, static_cast<std::size_t>(found - bodies.begin())};
    };
    if (const auto place = in(model.softBodies, true)) return place;
    return in(model.rigidBodies, false);
}

} // namespace filasofia::engine

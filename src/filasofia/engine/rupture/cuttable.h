#pragma once

#include <algorithm>

namespace filasofia::engine {

/// What a collision model of a soft body says to blades.
struct BladeTag {
    int group = 0;
    bool forBlades = false; ///< it only says which blades may cut the body (CollisionDef::cutting)
};

/// Whether blades of a collision group cut a body that may be cut: if some of its models are for blades, those of their
/// groups, else those of all its models' groups, or of group 0 if it has none. `tagOf` gives a model's BladeTag.
template <class Models, class TagOf> bool mayBeCutBy(int group, const Models& models, const TagOf& tagOf)
{
    const auto forBlades = [&](const auto& each) { return tagOf(each).forBlades; };
    const bool any = std::ranges::any_of(models, forBlades);
    const auto counts = [&](const auto& each) { return tagOf(each).group == group && (!any || forBlades(each)); };
    return models.empty() ? group == 0 : std::ranges::any_of(models, counts);
}

} // namespace filasofia::engine

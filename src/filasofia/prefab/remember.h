#pragma once

#include "filasofia/runtime/simulation.h"

#include <any>
#include <memory>
#include <string>

namespace filasofia::prefab {

/// Lets saved states have the members of a part that `kept()` ties together, as the tuple `Kept`. If the part has
/// turns, they guard it; if it has publish(), other threads see what was restored.
template <class Part>
void remember(runtime::Simulation& simulation, const std::string& of, const std::shared_ptr<Part>& part)
{
    using Kept = typename Part::Kept;
    const auto inTurn = [](Part& its, const auto& act) {
        if constexpr (requires { its.turns; })
            its.turns.wait(act); // between two steps the stepping thread may wait
        else
            act();
    };
    simulation.remember({.of = of,
                         .save =
                             [weak = std::weak_ptr(part), inTurn] {
                                 std::any copy;
                                 if (const auto its = weak.lock()) inTurn(*its, [&] { copy = Kept(its->kept()); });
                                 return copy;
                             },
                         .restore =
                             [weak = std::weak_ptr(part), inTurn](const std::any& copy) {
                                 const auto its = weak.lock();
                                 if (!its) return;
                                 inTurn(*its, [&] {
                                     its->kept() = std::any_cast<const Kept&>(copy);
                                     if constexpr (requires { its->publish(); }) its->publish();
                                 });
                             }});
}

} // namespace filasofia::prefab

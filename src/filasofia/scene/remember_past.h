#pragma once

#include "filasofia/runtime/simulation.h"

#include <memory>
#include <string>
#include <type_traits>

namespace filasofia::scene {

/// Lets saved states have the past() of a part that lives as long as the simulation; goBack() returns to it.
template <class Part>
void rememberPast(runtime::Simulation& simulation, const std::string& of, const std::shared_ptr<Part>& part)
{
    using Past = std::remove_cvref_t<decltype(part->past())>;
    simulation.remember({.of = of,
                         .save = [part] { return std::any(part->past()); },
                         .restore = [part](const std::any& copy) { part->goBack(std::any_cast<const Past&>(copy)); }});
}

} // namespace filasofia::scene

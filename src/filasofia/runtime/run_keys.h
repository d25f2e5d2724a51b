#pragma once

#include "filasofia/runtime/keys.h"

#include "filasofia/event/input_events.h"

#include <optional>

namespace filasofia::runtime {

/// What a key does to the run.
enum class RunAction { Pause, Step, Reset, Screenshot, Help, Quit };

/// Nothing if the key is not one of the run's, if it repeats, or if it comes with Control, Alt or Super.
std::optional<RunAction> actionOf(const event::KeyEvent& key);

} // namespace filasofia::runtime

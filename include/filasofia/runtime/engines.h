#pragma once

#include "filasofia/physics/collision_def.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

/// The physics engines that a simulation may have, by name.
namespace filasofia::runtime {

/// What every engine is made with; one without a use for a field leaves it.
struct EngineDef {
    double period = 1e-3;            ///< [s], in (0, 10]: the step that solvers prepare for
    std::optional<int> threads = {}; ///< [-], in [1, 256]: threads within one step; not given: the engine's choice
    physics::ContactMethod contact = physics::ExactContact{}; ///< how contacts are solved
};

/// Their names; "native", the default, is the first.
std::vector<std::string> engineNames();

/// Throws an Error that lists the names if there is none of this name, or that says how to get it if this program was
/// built without it.
std::unique_ptr<physics::PhysicsEngine> makeEngine(const std::string& name, const EngineDef& def);

/// The engine that replays a recording. Throws an Error that begins with `file` if the recording cannot be replayed,
/// because the engine that made it does not repeat its steps.
std::unique_ptr<physics::PhysicsEngine> makeReplayEngine(const record::RecordingHeader& header, const std::string& file,
                                                         std::optional<int> threads);

} // namespace filasofia::runtime

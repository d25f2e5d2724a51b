// How far the task of a scene file is.
#include "convert.h"
#include "properties.h"
#include "simulation.h"

#include "filasofia/prefab/task.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace filasofia::python {
namespace {

/// The progress, and the names that belong to it.
struct SceneTaskProgress {
    std::string name;
    std::vector<std::string> steps;
    std::string instruction;
    prefab::TaskProgress progress;
};

const char* stateOf(const SceneTaskProgress& self)
{
    switch (self.progress.state) {
    case prefab::TaskProgress::State::Running:
        return "running";
    case prefab::TaskProgress::State::Done:
        return "done";
    case prefab::TaskProgress::State::Failed:
        break;
    }
    return "failed";
}

std::optional<SceneTaskProgress> progressOf(HeldSimulation& self)
{
    const prefab::Task* task = self.session->task();
    if (task == nullptr) return {};
    const prefab::TaskDef& def = task->def();
    SceneTaskProgress out{.name = def.name, .steps = {}, .instruction = {}, .progress = task->progress()};
    for (const prefab::TaskStep& each : def.steps) out.steps.push_back(each.name);
    if (const auto next = static_cast<std::size_t>(out.progress.step); next < def.steps.size())
        out.instruction = def.steps[next].instruction;
    return out;
}

} // namespace

void addTasks(nb::module_& module, nb::class_<HeldSimulation>& sim)
{
    nb::class_<SceneTaskProgress>(module, "TaskProgress", "How far the task of a scene file is.")
        .def_ro("name", &SceneTaskProgress::name)
        .def_prop_ro("state", &stateOf, "running, done or failed: its time is over")
        .def_ro("steps", &SceneTaskProgress::steps, "their names, in order")
        .def_prop_ro(
            "step", [](const SceneTaskProgress& self) { return self.progress.step; },
            "index of the next step; the number of steps if all are done")
        .def_ro("instruction", &SceneTaskProgress::instruction, "the next step's; empty if there is none")
        .def_prop_ro(
            "time", [](const SceneTaskProgress& self) { return self.progress.time; }, "[s], simulated, since it began")
        .def_prop_ro(
            "done_at", [](const SceneTaskProgress& self) { return self.progress.doneAt; },
            "[s] since it began, for each step that is done")
        .def_prop_ro(
            "target",
            [](const SceneTaskProgress& self) -> nb::object {
                return self.progress.target ? nb::cast(vectorOf(*self.progress.target)) : nb::none();
            },
            nb::for_getter(nb::sig("def target(self) -> numpy.typing.NDArray[numpy.float64] | None")),
            "(3,) [m], where the next step is done, in the world; None if there is no such place")
        .def("__repr__", [](const SceneTaskProgress& self) {
            return text("TaskProgress(name='", self.name, "', state='", stateOf(self), "', step=", self.progress.step,
                        " of ", self.steps.size(), ", time=", self.progress.time, ")");
        });
    sim.def_prop_ro("task", &progressOf,
                    "How far the task of the scene file is, a TaskProgress, as the last step that was not paused found "
                    "it; None if it has no task. It stays readable after close().");
}

} // namespace filasofia::python

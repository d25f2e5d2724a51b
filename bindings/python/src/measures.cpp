#include "convert.h"
#include "defs.h"
#include "simulation.h"

#include "filasofia/core/error.h"
#include "filasofia/metric/catalog.h"
#include "filasofia/metric/session_file.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

namespace filasofia::python {
namespace {

metric::EventKind kindOf(const std::string& word, const char* what)
{
    if (const std::optional<metric::EventKind> kind = metric::eventKind(word)) return *kind;
    fail(what,
         " must be one of grasp, release, tear, cut, perforation, blood, energy, activation, in_air, burn, removed, "
         "seen, residual, step, mistake, unfinished, note, "
         "got '",
         word, "'");
}

void measure(HeldSimulation& self, nb::handle given, const metric::Session& session)
{
    auto def = readDef<prefab::MetricTrackerDef>(given, "measure: definition");
    if (def.file.empty()) fail("measure: file must name a .jsonl or .csv file, got ''");
    def.session = session;
    const Session::Turn turn(*self.session, "measure");
    const nb::gil_scoped_release free;
    self.session->measure(std::move(def));
}

void mark(HeldSimulation& self, const std::string& kind, const std::string& what, std::optional<double> amount)
{
    usable(self, "mark").mark(kindOf(kind, "mark: kind"), what, amount);
}

nb::dict measuresOf(nb::handle file)
{
    const std::string name = readText(file, {.name = "measures: file"});
    std::vector<metric::Value> values;
    {
        const nb::gil_scoped_release free;
        values = metric::measure(metric::readSession(name));
    }
    nb::dict out;
    for (std::size_t i = 0; i < values.size(); ++i)
        out[nb::str(metric::catalog()[i].id.data(), metric::catalog()[i].id.size())] =
            values[i].value ? nb::object(nb::float_(*values[i].value)) : nb::none();
    return out;
}

} // namespace

void addMeasures(nb::module_& module, nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "_measure",
        [](HeldSimulation& self, nb::handle definition, const std::string& trainee, const std::string& task,
           const std::vector<std::string>& steps, const std::vector<std::string>& targets,
           const std::vector<std::string>& watched, std::optional<double> forceLimit) {
            metric::Session session{
                .trainee = trainee, .task = task, .forceLimit = forceLimit, .targets = targets, .steps = steps};
            if (forceLimit && !(*forceLimit > 0.0 && std::isfinite(*forceLimit)))
                fail("measure: force_limit must be > 0 N, got ", *forceLimit);
            for (const std::string& each : watched) session.watched.push_back(kindOf(each, "measure: watched"));
            if (!steps.empty())
                session.watched.insert(session.watched.end(), {metric::EventKind::Step, metric::EventKind::Mistake});
            measure(self, definition, session);
        },
        nb::arg("definition").none(), nb::arg("trainee"), nb::arg("task"), nb::arg("steps"), nb::arg("targets"),
        nb::arg("watched"), nb::arg("force_limit").none());
    sim.def("mark", &mark, nb::arg("kind"), nb::arg("what") = "", nb::arg("amount").none() = nb::none(),
            "Notes an event at the present time in the session that measure() writes: kind is grasp, release, tear, "
            "cut, perforation, blood, energy, activation, in_air, burn, removed, seen, residual, step, mistake, "
            "unfinished or note. Error if nothing is measured.");
    module.def("measures", &measuresOf, nb::arg("file").none(),
               nb::sig("def measures(file: str | os.PathLike[str]) -> dict[str, float | None]"),
               "The measures of a session file by their names (docs/guide/metrics.md), in SI units; None if the "
               "session has no such number.");
}

} // namespace filasofia::python

// What the sensors of a scene file read.
#include "arrays.h"
#include "simulation.h"

#include "filasofia/prefab/sensors.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace filasofia::python {
namespace {

std::vector<prefab::SensorReading> readingsOf(HeldSimulation& self)
{
    const Session::Turn turn(*self.session, "sensors", Session::Turn::Of::OpenOrClosed);
    const prefab::Sensors* sensors = self.session->sensors();
    return sensors ? sensors->read() : std::vector<prefab::SensorReading>{};
}

} // namespace

void addSensors(nb::class_<HeldSimulation>& sim)
{
    sim.def_prop_ro(
        "sensors",
        [](HeldSimulation& self) {
            nb::dict out;
            for (prefab::SensorReading& each : readingsOf(self)) {
                const std::size_t count = each.values.size();
                out[each.name.c_str()] = arrayOf(std::move(each.values), {count});
            }
            return out;
        },
        nb::for_getter(nb::sig("def sensors(self) -> dict[str, numpy.typing.NDArray[numpy.float64]]")),
        "What the sensors of the scene file read after the last step, by their names, in SI units; see sensor_columns. "
        "NaN before the first step, and of a body that was removed. Empty if the scene has none.");
    sim.def_prop_ro(
        "sensor_columns",
        [](HeldSimulation& self) {
            nb::dict out;
            for (const prefab::SensorReading& each : readingsOf(self)) out[each.name.c_str()] = nb::cast(each.columns);
            return out;
        },
        nb::for_getter(nb::sig("def sensor_columns(self) -> dict[str, list[str]]")),
        "What the numbers of each sensor are: ['x [m]', 'y [m]', 'z [m]'].");
}

} // namespace filasofia::python

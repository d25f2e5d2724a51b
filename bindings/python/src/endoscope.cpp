#include "scope.h"

#include "filasofia/prefab/endoscope.h"

namespace filasofia::python {
namespace {

using HeldEndoscope = HeldPrefab<prefab::Endoscope>;

/// A turn by an angle [rad].
template <class Act> auto byAngle(const char* name, const Act& act)
{
    return [name, act](HeldEndoscope& self, nb::handle angle) {
        (self.open(name).*act)(readArgument<double>(angle, name, "angle"));
    };
}

} // namespace

void addEndoscope(nb::module_& module)
{
    nb::class_<prefab::LensState>(module, "LensState", "How dirty a lens is.")
        .def_ro("mist", &prefab::LensState::mist, "[-], in [0, 1], how fogged it is")
        .def_ro("smear", &prefab::LensState::smear, "[-], in [0, 1], share of it that is smeared");
    nb::class_<HeldEndoscope> scope(module, "Endoscope",
                                    "A kinematic shaft with a camera and a light at its tip, as a hysteroscope. "
                                    "Pictures and the viewer show what it sees, unless they are told another pose. "
                                    "Make it before the first step.");
    scope
        .def(
            "__init__",
            [](HeldEndoscope* self, HeldSimulation& sim, nb::handle given) {
                makeScope<prefab::Endoscope, prefab::EndoscopeDef>(self, sim, given, "Endoscope");
            },
            nb::arg("sim"), nb::arg("definition").none() = nb::none(),
            nb::sig("def __init__(self, sim: filasofia.Simulation, definition: filasofia.EndoscopeDef | None = None) "
                    "-> None"),
            "Adds its body.")
        .def(
            "move",
            [](HeldEndoscope& self, nb::handle pose) {
                self.open("move").move(readArgument<Pose>(pose, "move", "pose"));
            },
            nb::arg("pose").none(),
            nb::sig("def move(self, pose: filasofia.Pose | collections.abc.Sequence[float]) -> None"),
            "The pose of its tip in the world at the end of the next step, without the roll; the shaft lies at +z.")
        .def("roll", byAngle("roll", &prefab::Endoscope::roll), nb::arg("angle").none(),
             nb::sig("def roll(self, angle: float) -> None"),
             "[rad], rotates the whole scope about its shaft from its start; an inclined view sweeps a cone.")
        .def("camera_roll", byAngle("camera_roll", &prefab::Endoscope::cameraRoll), nb::arg("angle").none(),
             nb::sig("def camera_roll(self, angle: float) -> None"),
             "[rad], rotates only the camera about its view: the view stays, the picture rotates.")
        .def_prop_ro(
            "tip", [](HeldEndoscope& self) { return Convert<Pose>::make(self.open("tip").tip()); },
            nb::for_getter(nb::sig("def tip(self) -> filasofia.Pose")), "as last told, with the roll")
        .def_prop_ro(
            "channel", [](HeldEndoscope& self) { return Convert<Pose>::make(self.open("channel").channel()); },
            nb::for_getter(nb::sig("def channel(self) -> filasofia.Pose")),
            "the mouth of its working channel; instruments leave it along its -z")
        .def_prop_ro(
            "body", [](HeldEndoscope& self) { return Convert<BodyId>::make(self.open("body").body()); },
            nb::for_getter(nb::sig("def body(self) -> filasofia.BodyId")), "its rigid body");
    addLens(scope);
}

} // namespace filasofia::python

#include "results.h"

#include "convert.h"
#include "defs.h"

#include "filasofia/core/hash.h"
#include "filasofia/physics/tissue.h"
#include "filasofia/runtime/replay.h"
#include "filasofia/scene/scene_file.h"
#include "filasofia/visual/transform.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace filasofia::python {
namespace {

using physics::Tissue;
using runtime::ReplayReport;

void bindTissues(nb::module_& module)
{
    const auto words = [](std::string_view word) { return std::string(word); };
    nb::class_<Tissue>(module, "Tissue", "A tissue of the library: constants that were measured, and their source.")
        .def_prop_ro("name", [words](const Tissue& self) { return words(self.name); })
        .def_prop_ro("title", [words](const Tissue& self) { return words(self.title); })
        .def_prop_ro("source", [words](const Tissue& self) { return words(self.source); })
        .def_prop_ro("caveat", [words](const Tissue& self) { return words(self.caveat); })
        .def_prop_ro(
            "material", [](const Tissue& self) { return Convert<physics::FemMaterial>::make(self.material); },
            nb::for_getter(nb::sig("def material(self) -> filasofia.FemMaterial")), "A new FemMaterial.")
        .def_ro("density", &Tissue::density, "[kg/m^3]")
        .def_ro("lowest", &Tissue::lowest, "[Pa] of Young's modulus in the literature")
        .def_ro("highest", &Tissue::highest, "[Pa]")
        .def_ro("strength", &Tissue::strength, "[Pa] as published; 0: unknown");
    module.def(
        "tissue", [](const std::string& name) { return physics::tissue(name); }, nb::arg("name"),
        "A tissue of the library by its name.");
    module.def("tissues", &physics::tissues, "The whole library.");
}

void bindReplay(nb::module_& module)
{
    module.def(
        "save_scene",
        [](nb::handle recording, nb::handle scene, bool overwrite) {
            const std::string from = readText(recording, {.name = "save_scene: recording"});
            const std::string to = readText(scene, {.name = "save_scene: scene"});
            const nb::gil_scoped_release free;
            const scene::RecordedScene made = scene::sceneOf(from);
            scene::saveScene(made.scene, to, {.overwrite = overwrite});
            return made.notes;
        },
        nb::arg("recording").none(), nb::arg("scene").none(), nb::kw_only(), nb::arg("overwrite") = false,
        nb::sig("def save_scene(recording: str | os.PathLike[str], scene: str | os.PathLike[str], *, "
                "overwrite: bool = False) -> list[str]"),
        "Writes what a recorded run was made from as a scene file: bodies, motions, commands at their times, picture. "
        "Meshes come into a folder beside it; if one is there already, it is an Error, or replaced. Returns what a "
        "scene cannot hold, a sentence each.");
    nb::class_<ReplayReport>(module, "ReplayReport", "How a replay went.")
        .def_ro("made", &ReplayReport::made, "number of replayed steps")
        .def_ro("step", &ReplayReport::step)
        .def_ro("time", &ReplayReport::time, "[s], simulated")
        .def_ro("hash", &ReplayReport::hash)
        .def_ro("damage", &ReplayReport::damage, "what ended the file early; empty: nothing did")
        .def_ro("pictures", &ReplayReport::pictures)
        .def_ro("notes", &ReplayReport::notes)
        .def_prop_ro(
            "different_step",
            [](const ReplayReport& self) -> nb::object {
                return self.difference ? nb::object(nb::int_(self.difference->step)) : nb::none();
            },
            nb::for_getter(nb::sig("def different_step(self) -> int | None")),
            "The first step with another hash than the recorded one, if they were compared.")
        .def("__repr__", [](const ReplayReport& self) {
            return text("ReplayReport(made=", self.made, ", step=", self.step, ", time=", self.time, ", damage='",
                        self.damage, "', different_step=", self.difference ? text(self.difference->step) : "None", ")");
        });
    module.def(
        "replay",
        [](nb::handle def) {
            const auto asked = readDef<runtime::ReplayDef>(def, "replay: definition");
            const nb::gil_scoped_release free;
            return runtime::replay(asked);
        },
        nb::arg("definition").none(), nb::sig("def replay(definition: filasofia.ReplayDef) -> ReplayReport"),
        "Replays a recording as fast as possible.");
}

} // namespace

void bindLibrary(nb::module_& module)
{
    bindTissues(module);
    bindReplay(module);
    module.def(
        "look_at",
        [](nb::handle eye, nb::handle target, nb::handle up) {
            const Vec3 from = readArgument<Vec3>(eye, "look_at", "eye"),
                       to = readArgument<Vec3>(target, "look_at", "target");
            return Convert<Pose>::make(visual::lookAt(from, to, readArgument<Vec3>(up, "look_at", "up")));
        },
        nb::arg("eye").none(), nb::arg("target").none(), nb::arg("up").none() = nb::make_tuple(0.0, 1.0, 0.0),
        nb::sig("def look_at(eye: collections.abc.Sequence[float], target: collections.abc.Sequence[float], up: "
                "collections.abc.Sequence[float] = (0, 1, 0)) -> filasofia.Pose"),
        "The pose of a camera at `eye` that looks at `target`.");
    module.def(
        "axis_angle",
        [](nb::handle axis, nb::handle angle) {
            return Convert<Quat>::make(axisAngle(readArgument<Vec3>(axis, "axis_angle", "axis"),
                                                 readArgument<double>(angle, "axis_angle", "angle")));
        },
        nb::arg("axis").none(), nb::arg("angle").none(),
        nb::sig(
            "def axis_angle(axis: collections.abc.Sequence[float], angle: float) -> tuple[float, float, float, float]"),
        "The quaternion (w, x, y, z) of the rotation by `angle` [rad] about `axis`.");
    module.def("hexadecimal", &hexadecimal, nb::arg("hash"), "A hash as recordings and reports print it.");
}

} // namespace filasofia::python

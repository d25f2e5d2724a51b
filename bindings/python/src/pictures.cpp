// What is drawn of a simulation, its pictures and its viewer.
#include "arrays.h"
#include "defs.h"
#include "results.h"
#include "simulation.h"

#include <cstring>
#include <utility>

namespace filasofia::python {
namespace {

/// If the user chose nothing to be drawn, everything that has a surface is, but for what a library has shown.
void showAll(HeldSimulation& self)
{
    self.shownByUs.merge(std::exchange(self.shownByScene, {}));
    if (self.shown) return;
    Session& session = *self.session;
    for (const BodyId id : session.physics().bodies()) {
        const auto def = session.physics().def(id);
        if (self.shownByUs.contains(id) || self.shownBeside.contains(id) || !physics::hasSurface(*def)) continue;
        self.shownByUs[id] = session.simulation().show(id);
    }
}

/// What the user says of a body takes the place of what we showed of it. `beside`: others are drawn as before.
nb::object show(HeldSimulation& self, nb::handle body, nb::handle def, bool beside)
{
    const auto read = readDef<runtime::ShowDef>(def, "show");
    Session& session = usable(self, "show");
    const auto id = readArgument<BodyId>(body, "show", "body");
    const runtime::ShownId shown = session.simulation().show(id, read);
    if (beside) {
        self.shownBeside.insert(id);
    } else {
        self.shown = true;
        for (const auto& [other, ours] : std::exchange(self.shownByScene, {})) session.simulation().unshow(ours);
    }
    for (auto* list : {&self.shownByUs, &self.shownByScene})
        if (const auto ours = list->extract(id)) session.simulation().unshow(ours.mapped());
    return Convert<runtime::ShownId>::make(shown);
}

/// The picture without its alpha, as a new array (height, width, 3).
nb::object pixelsOf(const visual::Image& image)
{
    const auto height = static_cast<std::size_t>(image.height), width = static_cast<std::size_t>(image.width);
    std::vector<std::uint8_t> bytes(3 * height * width);
    for (std::size_t i = 0; i < height * width; ++i) std::memcpy(bytes.data() + 3 * i, image.rgba.data() + 4 * i, 3);
    return arrayOf(std::move(bytes), {height, width, 3});
}

/// What `take` captures of the present state, as `def` asks.
template <class Image> Image capture(HeldSimulation& self, nb::handle def, const char* what,
                                     Image (Session::*take)(const runtime::PictureDef&))
{
    const auto asked = readDef<runtime::PictureDef>(def, what);
    const Session::Turn turn(*self.session, what);
    showAll(self);
    const nb::gil_scoped_release free;
    return (*self.session.*take)(asked);
}

nb::object render(HeldSimulation& self, nb::handle def)
{
    return pixelsOf(capture(self, def, "render", &Session::picture));
}

/// Depth and bodies, two new arrays (height, width).
nb::object renderDepth(HeldSimulation& self, nb::handle def)
{
    visual::DepthImage image = capture(self, def, "render_depth", &Session::depth);
    const auto height = static_cast<std::size_t>(image.height), width = static_cast<std::size_t>(image.width);
    return nb::make_tuple(arrayOf(std::move(image.depth), {height, width}),
                          arrayOf(std::move(image.label), {height, width}));
}

void openViewer(HeldSimulation& self, nb::handle def)
{
    const auto asked = readDef<runtime::ViewerDef>(def, "viewer");
    const Session::Turn turn(*self.session, "viewer");
    showAll(self);
    const nb::gil_scoped_release free;
    self.session->openViewer(asked);
}

/// Does nothing without a viewer.
void withViewer(HeldSimulation& self, void (Session::*act)())
{
    if (!self.session->viewing()) return;
    const Session::Turn turn(*self.session, "viewer");
    const nb::gil_scoped_release free;
    (*self.session.*act)();
}

} // namespace

void addPictures(nb::class_<HeldSimulation>& sim)
{
    sim.def("_show", &show, nb::arg("body").none(), nb::arg("definition").none(), nb::arg("beside") = false);
    sim.def(
        "set_visible",
        [](HeldSimulation& self, nb::handle shown, bool visible) {
            usable(self, "set_visible")
                .simulation()
                .setVisible(readArgument<runtime::ShownId>(shown, "set_visible", "shown"), visible);
        },
        nb::arg("shown").none(), nb::arg("visible"),
        nb::sig("def set_visible(self, shown: filasofia.ShownId, visible: bool) -> None"));
    sim.def(
        "unshow",
        [](HeldSimulation& self, nb::handle shown) {
            usable(self, "unshow").simulation().unshow(readArgument<runtime::ShownId>(shown, "unshow", "shown"));
        },
        nb::arg("shown").none(), nb::sig("def unshow(self, shown: filasofia.ShownId) -> None"),
        "It is no longer drawn.");
    sim.def(
        "paint",
        [](HeldSimulation& self, nb::handle body, nb::handle def) {
            const auto read = readDef<runtime::PaintDef>(def, "paint: mark");
            return usable(self, "paint").simulation().paint(readArgument<BodyId>(body, "paint", "body"), read);
        },
        nb::arg("body").none(), nb::arg("mark").none(),
        nb::sig("def paint(self, body: filasofia.BodyId, mark: filasofia.PaintDef) -> int"),
        "Paints blood, a burn or wetness on a body; returns how many vertices it reached.");
    sim.def(
        "bleed",
        [](HeldSimulation& self, nb::handle body, nb::handle def) {
            const auto read =
                def.is_none() ? surface::BleedingDef{} : readDef<surface::BleedingDef>(def, "bleed: bleeding");
            usable(self, "bleed").simulation().bleed(readArgument<BodyId>(body, "bleed", "body"), read);
        },
        nb::arg("body").none(), nb::arg("bleeding").none() = nb::none(),
        nb::sig("def bleed(self, body: filasofia.BodyId, bleeding: filasofia.BleedingDef | None = None) -> None"),
        "Makes a soft body bleed where cuts and tears open it.");
    sim.def(
        "burn",
        [](HeldSimulation& self, nb::handle body, nb::handle def) {
            const auto read =
                def.is_none() ? surface::BurningDef{} : readDef<surface::BurningDef>(def, "burn: burning");
            usable(self, "burn").simulation().burn(readArgument<BodyId>(body, "burn", "body"), read);
        },
        nb::arg("body").none(), nb::arg("burning").none() = nb::none(),
        nb::sig("def burn(self, body: filasofia.BodyId, burning: filasofia.BurningDef | None = None) -> None"),
        "Makes a soft body warm and burn where it is heated.");
    sim.def(
        "treat",
        [](HeldSimulation& self, nb::handle body, nb::handle command) {
            const auto read = readArgument<surface::Treatment>(command, "treat", "command");
            usable(self, "treat").simulation().treat(readArgument<BodyId>(body, "treat", "body"), read);
        },
        nb::arg("body").none(), nb::arg("command").none(),
        nb::sig("def treat(self, body: filasofia.BodyId, command: filasofia.Perfuse | filasofia.Injure | "
                "filasofia.Seal | filasofia.Suck | filasofia.Rinse | filasofia.Pour | filasofia.Heat) -> None"),
        "Presses, injures, seals, sucks or rinses a body that bleeds, or heats one that burns.");
    sim.def(
        "blood",
        [](HeldSimulation& self, nb::handle body) {
            return usable(self, "blood").simulation().blood(readArgument<BodyId>(body, "blood", "body"));
        },
        nb::arg("body").none(), nb::sig("def blood(self, body: filasofia.BodyId) -> filasofia.BloodBalance"),
        "What has become of its blood.");
    sim.def(
        "heat",
        [](HeldSimulation& self, nb::handle body) {
            return usable(self, "heat").simulation().heat(readArgument<BodyId>(body, "heat", "body"));
        },
        nb::arg("body").none(), nb::sig("def heat(self, body: filasofia.BodyId) -> filasofia.HeatBalance"),
        "What has become of its heat, and how much of it is burnt.");
    sim.def(
        "damage",
        [](HeldSimulation& self, nb::handle body) -> nb::object {
            const auto damage =
                usable(self, "damage").simulation().damage(readArgument<BodyId>(body, "damage", "body"));
            if (!damage) return nb::none();
            return arrayOf(std::vector<float>(*damage), {damage->size()});
        },
        nb::arg("body").none(),
        nb::sig("def damage(self, body: filasofia.BodyId) -> numpy.typing.NDArray[numpy.float32] | None"),
        "(n,) Arrhenius' omega at each node, negative where there is no surface: from 1 on it is burnt. None before "
        "the "
        "first step of the heat.");
    sim.def(
        "add_electrode",
        [](HeldSimulation& self, nb::handle body, nb::handle def) {
            const auto read = def.is_none() ? surface::ElectrodeDef{}
                                            : readDef<surface::ElectrodeDef>(def, "add_electrode: electrode");
            return usable(self, "add_electrode")
                .simulation()
                .addElectrode(readArgument<BodyId>(body, "add_electrode", "body"), read);
        },
        nb::arg("body").none(), nb::arg("electrode").none() = nb::none(),
        nb::sig(
            "def add_electrode(self, body: filasofia.BodyId, electrode: filasofia.ElectrodeDef | None = None) -> int"),
        "Makes a rigid body heat what its tip touches while it is active; returns its index among those of the body.");
    sim.def(
        "activate",
        [](HeldSimulation& self, nb::handle body, nb::handle on, nb::handle electrode) {
            usable(self, "activate")
                .simulation()
                .activate(readArgument<BodyId>(body, "activate", "body"), readArgument<bool>(on, "activate", "on"),
                          readArgument<int>(electrode, "activate", "electrode"));
        },
        nb::arg("body").none(), nb::arg("on").none() = true, nb::arg("electrode").none() = 0,
        nb::sig("def activate(self, body: filasofia.BodyId, on: bool = True, electrode: int = 0) -> None"),
        "Presses the pedal of an electrode, or releases it.");
    sim.def(
        "energy",
        [](HeldSimulation& self, nb::handle body, nb::handle electrode) {
            return usable(self, "energy")
                .simulation()
                .energy(readArgument<BodyId>(body, "energy", "body"),
                        readArgument<int>(electrode, "energy", "electrode"));
        },
        nb::arg("body").none(), nb::arg("electrode").none() = 0,
        nb::sig("def energy(self, body: filasofia.BodyId, electrode: int = 0) -> filasofia.EnergyBalance"),
        "What an electrode has done.");
    sim.def(
        "add_duct",
        [](HeldSimulation& self, nb::handle body, nb::handle def) {
            const auto read = readDef<surface::DuctDef>(def, "add_duct: duct");
            return usable(self, "add_duct").simulation().addDuct(readArgument<BodyId>(body, "add_duct", "body"), read);
        },
        nb::arg("body").none(), nb::arg("duct").none(),
        nb::sig("def add_duct(self, body: filasofia.BodyId, duct: filasofia.DuctDef) -> int"),
        "Says that something flows in a tube of a soft body; returns its index among those of the body.");
    sim.def(
        "duct",
        [](HeldSimulation& self, nb::handle body, nb::handle duct) {
            return usable(self, "duct")
                .simulation()
                .duct(readArgument<BodyId>(body, "duct", "body"), readArgument<int>(duct, "duct", "duct"));
        },
        nb::arg("body").none(), nb::arg("duct").none() = 0,
        nb::sig("def duct(self, body: filasofia.BodyId, duct: int = 0) -> filasofia.DuctBalance"),
        "What flows in a duct.");
    sim.def(
        "add_smoke",
        [](HeldSimulation& self, nb::handle def) {
            const auto read = readDef<surface::SmokeDef>(def, "add_smoke: smoke");
            usable(self, "add_smoke").simulation().addSmoke(read);
        },
        nb::arg("smoke").none(), nb::sig("def add_smoke(self, smoke: filasofia.SmokeDef) -> None"),
        "Lets what burns smoke, in a room that holds it.");
    sim.def(
        "extract",
        [](HeldSimulation& self, nb::handle command) {
            usable(self, "extract").simulation().extract(readDef<surface::Extract>(command, "extract: command"));
        },
        nb::arg("command").none(), nb::sig("def extract(self, command: filasofia.Extract) -> None"),
        "Sucks smoke away from a place.");
    sim.def(
        "smoke", [](HeldSimulation& self) { return usable(self, "smoke").simulation().smoke(); },
        nb::sig("def smoke(self) -> filasofia.SmokeBalance"), "What has become of the smoke.");
    sim.def(
        "smoke_between",
        [](HeldSimulation& self, nb::handle from, nb::handle to) {
            return usable(self, "smoke_between")
                .simulation()
                .smokeBetween(readArgument<Vec3>(from, "smoke_between", "begin"),
                              readArgument<Vec3>(to, "smoke_between", "end"));
        },
        nb::arg("begin").none(), nb::arg("end").none(),
        nb::sig("def smoke_between(self, begin: collections.abc.Sequence[float], end: collections.abc.Sequence[float]) "
                "-> float"),
        "The optical depth of the smoke on a straight way: exp(-depth) of the light passes.");
    sim.def(
        "add_distension",
        [](HeldSimulation& self, nb::handle def) {
            const auto read = readDef<surface::DistensionDef>(def, "add_distension: distension");
            usable(self, "add_distension").simulation().addDistension(read);
        },
        nb::arg("distension").none(), nb::sig("def add_distension(self, distension: filasofia.DistensionDef) -> None"),
        "A fluid distends a cavity.");
    sim.def(
        "distend",
        [](HeldSimulation& self, nb::handle command) {
            usable(self, "distend").simulation().distend(readDef<surface::Distend>(command, "distend: command"));
        },
        nb::arg("command").none(), nb::sig("def distend(self, command: filasofia.Distend) -> None"),
        "Turns pump and taps of the distension.");
    sim.def(
        "distension", [](HeldSimulation& self) { return usable(self, "distension").simulation().distension(); },
        nb::sig("def distension(self) -> filasofia.DistensionBalance"), "What has become of the fluid.");
    sim.def("_render", &render);
    sim.def("_render_depth", &renderDepth);
    sim.def("_open_viewer", &openViewer);
    sim.def("_show_in_viewer", [](HeldSimulation& self) { withViewer(self, &Session::showInViewer); });
    sim.def("_close_viewer", [](HeldSimulation& self) { withViewer(self, &Session::closeViewer); });
    sim.def("_viewing", [](HeldSimulation& self) { return self.session->viewing(); });
}

} // namespace filasofia::python

#include "results.h"

#include "properties.h"

#include <nanobind/stl/vector.h>

namespace filasofia::python {
namespace {

using namespace physics;

void bindFlags(nb::module_& module)
{
    nb::enum_<StepFlag>(module, "StepFlag", nb::is_flag(), nb::is_arithmetic(), "Problems of a step. None ends it.")
        .value("LATE", StepFlag::Late)
        .value("CLAMPED", StepFlag::Clamped)
        .value("NOT_CONVERGED", StepFlag::NotConverged,
               "a solver stopped at its iteration limit, contact forces are off from their law by more than 5 %, or "
               "what is attached hard misses what it is to do by more than 0.2 mm")
        .value("UNDONE", StepFlag::Undone, "a body's new state was not finite and was restored")
        .value("EVENT_LOST", StepFlag::EventLost)
        .value("RECORD_LOST", StepFlag::RecordLost)
        .value("TUNED", StepFlag::Tuned)
        .value("TUNE_REJECTED", StepFlag::TuneRejected)
        .value("DAMPED", StepFlag::Damped, "a restored body repeated its step, heavily damped")
        .value("OUT_OF_TIME", StepFlag::OutOfTime)
        .value("NOTHING_ATTACHED", StepFlag::NothingAttached, "an attachment found no node, or a grasp no contact")
        .value("INVERTED", StepFlag::Inverted, "elements were inside out")
        .value("BEYOND_STRAIN", StepFlag::BeyondStrain, "elements were strained beyond valid_strain")
        .value("NOTHING_CHANGED", StepFlag::NothingChanged, "a SetTissue found no element")
        .value("RESTLESS", StepFlag::Restless, "a body goes on moving though nothing drives it")
        .value("ENERGY_GAINED", StepFlag::EnergyGained, "a restless body moves with ever more energy")
        .value("INTERSECTING", StepFlag::Intersecting, "surfaces of bodies pass through each other");
}

void bindParts(nb::module_& module)
{
    nb::class_<BodySolve> solve(module, "BodySolve", "How one body's step was solved.");
    addId(solve, "body", &BodySolve::body);
    addId(solve, "together", &BodySolve::together);
    solve.def_ro("iterations", &BodySolve::iterations).def_ro("residual", &BodySolve::residual);

    nb::class_<ContactReport>(module, "ContactReport", "Statistics of the contacts of a step.")
        .def_ro("found", &ContactReport::found)
        .def_ro("active", &ContactReport::active)
        .def_ro("rounds", &ContactReport::rounds)
        .def_ro("mismatch", &ContactReport::mismatch)
        .def_ro("penetration", &ContactReport::penetration, "[m] the deepest");

    nb::class_<Intersection> intersection(module, "Intersection",
                                          "Two bodies whose surfaces pass through each other; equal: through itself.");
    intersection.def_ro("crossings", &Intersection::crossings, "edges through triangles; 0: one is inside the other")
        .def_ro("depth", &Intersection::depth, "[m] of the deepest edge")
        .def_prop_ro(
            "cause",
            [](const Intersection& self) {
                using enum IntersectionCause;
                return self.cause == Start ? "start" : self.cause == Told ? "told" : self.cause == Own ? "own" : "lost";
            },
            "'start': they began so; 'told': one was told to be there; 'own': it does not collide with itself; 'lost'")
        .def_ro("force", &Intersection::force, "[N] sum of the normal forces between the two in the step");
    addId(intersection, "first", &Intersection::first);
    addId(intersection, "second", &Intersection::second);
    addVector(intersection, "place", &Intersection::place, "[m]");

    nb::class_<InvertedElements> inverted(module, "InvertedElements", "Elements that were inside out.");
    inverted.def_ro("count", &InvertedElements::count)
        .def_ro("element", &InvertedElements::element)
        .def_ro("volume", &InvertedElements::volume);
    addId(inverted, "body", &InvertedElements::body);
    addVector(inverted, "place", &InvertedElements::place, "[m]");

    nb::class_<StrainedElements> strained(module, "StrainedElements", "Elements strained beyond valid_strain.");
    strained.def_ro("count", &StrainedElements::count)
        .def_ro("element", &StrainedElements::element)
        .def_ro("strain", &StrainedElements::strain)
        .def_ro("valid", &StrainedElements::valid);
    addId(strained, "body", &StrainedElements::body);
    addVector(strained, "place", &StrainedElements::place, "[m]");

    nb::class_<MechanicalEnergy>(module, "MechanicalEnergy", "The mechanical energy of a body.")
        .def_ro("kinetic", &MechanicalEnergy::kinetic, "[J]; what is told its motion has none")
        .def_ro("elastic", &MechanicalEnergy::elastic, "[J], what strain stores by the law of the tissue")
        .def_ro("gravitational", &MechanicalEnergy::gravitational, "[J], zero with all mass at the world's origin")
        .def("__repr__", [](const MechanicalEnergy& self) {
            return text("MechanicalEnergy(kinetic=", self.kinetic, ", elastic=", self.elastic,
                        ", gravitational=", self.gravitational, ")");
        });

    nb::class_<Unrest> unrest(module, "Unrest", "Bodies that go on moving though nothing drives them.");
    unrest.def_ro("bodies", &Unrest::bodies).def_ro("speed", &Unrest::speed).def_ro("undriven", &Unrest::undriven);
    addId(unrest, "body", &Unrest::body);
}

void bindRuptures(nb::module_& module)
{
    nb::class_<LoosePiece> piece(module, "LoosePiece", "A part of a body that was detached.");
    piece.def_ro("piece", &LoosePiece::piece)
        .def_ro("elements", &LoosePiece::elements)
        .def_ro("mass", &LoosePiece::mass, "[kg]")
        .def_ro("held", &LoosePiece::held,
                "whether some of its nodes are attached to the world or to a kinematic body");
    addVector(piece, "place", &LoosePiece::place, "[m]");

    nb::class_<Rupture> rupture(module, "Rupture", "What a blade or stress opened in a body.");
    rupture.def_prop_ro("kind", [](const Rupture& self) { return self.kind == Rupture::Kind::Cut ? "cut" : "tear"; })
        .def_ro("area", &Rupture::area, "[m^2] at rest, of one side")
        .def_ro("nodes", &Rupture::nodes)
        .def_ro("elements", &Rupture::elements)
        .def_ro("detached", &Rupture::detached)
        .def_ro("cavities", &Rupture::cavities);
    addId(rupture, "body", &Rupture::body);
    addVector(rupture, "place", &Rupture::place, "[m]");

    nb::class_<LostPiece> lost(module, "LostPiece", "A piece that went farther than 10 m and was removed.");
    lost.def_ro("piece", &LostPiece::piece)
        .def_ro("mass", &LostPiece::mass, "[kg]")
        .def_ro("share", &LostPiece::share, "[-], of the mass that the body had as a whole");
    addId(lost, "body", &LostPiece::body);

    nb::class_<TopologyReport> topology(module, "TopologyReport", "Cuts and tears of a step.");
    addIds(topology, "idle_blades", &TopologyReport::idleBlades,
           "rigid bodies of which no blade cuts, as no body that may be cut has their groups");
    topology.def_ro("ruptures", &TopologyReport::ruptures)
        .def_ro("lost", &TopologyReport::lost, "pieces that went farther than 10 m and were removed")
        .def_ro("lost_pieces", &TopologyReport::lostPieces)
        .def_ro("pending", &TopologyReport::pending)
        .def_ro("blade_not_finite", &TopologyReport::bladeNotFinite, "blades whose position is not finite")
        .def_ro("blade_no_length", &TopologyReport::bladeNoLength, "blades without length")
        .def_ro("blade_jump", &TopologyReport::bladeJump, "blades that moved further in the step than a body is long")
        .def_ro("blade_too_fast", &TopologyReport::bladeTooFast, "blades that jumped across a body")
        .def_ro("blade_off", &TopologyReport::bladeOff,
                "blades that were switched off in tissue and pushed further into it")
        .def_ro("in_vain", &TopologyReport::inVain, "strokes that had crossed edges and opened nothing when they ended")
        .def_ro("no_piece", &TopologyReport::noPiece, "pieces that could not be removed")
        .def_prop_ro("refused", &TopologyReport::refused, "blades that were not used, and edits that were refused")
        .def("__repr__", [](const TopologyReport& self) {
            return text("TopologyReport(ruptures=", self.ruptures.size(), ", lost=", self.lost,
                        ", pending=", self.pending, ", refused=", self.refused(), ")");
        });
}

void bindStep(nb::module_& module)
{
    nb::class_<ClipReport>(module, "ClipReport", "What became of clips.")
        .def_ro("applied", &ClipReport::applied, "[-], began to close on tissue")
        .def_ro("missed", &ClipReport::missed, "[-], had nothing between their legs")
        .def_ro("slipped", &ClipReport::slipped, "[-], were pulled off, or lost their tissue")
        .def_ro("partial", &ClipReport::partial, "[-], among those applied: tissue goes on beyond their legs");
    nb::class_<ClipChange> change(module, "ClipChange", "What became of one clip.");
    change
        .def_prop_ro("kind",
                     [](const ClipChange& self) {
                         using enum ClipChange::Kind;
                         return self.kind == Applied ? "applied" : self.kind == Missed ? "missed" : "slipped";
                     })
        .def_ro("partial", &ClipChange::partial, "tissue went on beyond its legs when it was applied");
    addId(change, "clip", &ClipChange::clip);
    addId(change, "tissue", &ClipChange::tissue);
    nb::class_<AttachmentBreak> broke(module, "AttachmentBreak", "What of an attachment or a grasp let go in a step.");
    addId(broke, "body", &AttachmentBreak::body);
    addId(broke, "to", &AttachmentBreak::to);
    broke
        .def_prop_ro(
            "id", [](const AttachmentBreak& self) { return Convert<AttachmentId>::make(self.id); },
            nb::for_getter(nb::sig("def id(self) -> filasofia.AttachmentId")))
        .def_ro("grasp", &AttachmentBreak::grasp, "a grasp, by `to`, and no attachment")
        .def_ro("force", &AttachmentBreak::force, "[N] that it carried, summed over its points")
        .def_ro("points", &AttachmentBreak::points, "[-], that let go")
        .def_ro("broken", &AttachmentBreak::broken, "nothing of it holds any more");
    nb::class_<StepReport> step(module, "StepReport", "How a step went.");
    addIds(step, "undone", &StepReport::undone, "bodies that were restored to the state before the step");
    step.def_ro("step", &StepReport::step, "number of steps completed")
        .def_ro("time", &StepReport::time, "[s], simulated")
        .def_ro("dt", &StepReport::dt, "[s]; 0 while paused")
        .def_prop_ro("flags", [](const StepReport& self) { return static_cast<StepFlag>(self.flags); })
        .def_ro("solves", &StepReport::solves)
        .def_prop_ro("iterations", &StepReport::iterations, "of all solves, each counted once")
        .def_ro("contacts", &StepReport::contacts)
        .def_ro("intersections", &StepReport::intersections)
        .def_ro("inverted", &StepReport::inverted)
        .def_ro("beyond_strain", &StepReport::beyondStrain)
        .def_ro("unrest", &StepReport::unrest)
        .def_ro("topology", &StepReport::topology)
        .def_ro("clips", &StepReport::clips)
        .def_ro("clip_changes", &StepReport::clipChanges)
        .def_ro("breaks", &StepReport::breaks, "attachments and grasps of which points let go")
        .def("__repr__", [](nb::handle self) {
            const auto& report = nb::cast<const StepReport&>(self);
            return text("StepReport(step=", report.step, ", time=", report.time,
                        ", flags=", nb::cast<std::string>(nb::repr(self.attr("flags"))), ")");
        });
}

void bindRun(nb::module_& module)
{
    using runtime::ContactPairReport;
    using runtime::RunReport;
    nb::class_<ContactPairReport>(module, "ContactPairReport", "How two bodies touched in a run.")
        .def_ro("first", &ContactPairReport::first)
        .def_ro("second", &ContactPairReport::second)
        .def_ro("steps", &ContactPairReport::steps)
        .def_ro("mean_normal_force", &ContactPairReport::meanNormalForce, "[N]")
        .def_ro("max_normal_force", &ContactPairReport::maxNormalForce, "[N]")
        .def_ro("mean_friction_force", &ContactPairReport::meanFrictionForce, "[N]")
        .def_ro("max_friction_force", &ContactPairReport::maxFrictionForce, "[N]")
        .def_ro("deepest", &ContactPairReport::deepest, "[m]")
        .def_ro("unsolved", &ContactPairReport::unsolved,
                "[-] steps in which a solver stopped short of its tolerance; their forces are not in the others")
        .def_ro("max_unsolved_force", &ContactPairReport::maxUnsolvedForce, "[N], normal force in those steps");
    using surface::BloodBalance;
    nb::class_<BloodBalance>(module, "BloodBalance", "What became of the blood of a body.")
        .def_ro("welled", &BloodBalance::welled, "[m^3], lost by the vessels")
        .def_ro("on_tissue", &BloodBalance::onTissue, "[m^3], lies on the body now")
        .def_ro("sucked", &BloodBalance::sucked, "[m^3]")
        .def_ro("rinsed", &BloodBalance::rinsed, "[m^3]")
        .def_ro("dripped", &BloodBalance::dripped, "[m^3], fell from it")
        .def_ro("carried_off", &BloodBalance::carriedOff, "[m^3], left with pieces that were removed")
        .def_ro("rate", &BloodBalance::rate, "[m^3/s], wells now");
    using surface::HeatBalance;
    nb::class_<HeatBalance>(module, "HeatBalance", "What became of the heat of a body, and how much of it is burnt.")
        .def_ro("delivered", &HeatBalance::delivered, "[J], taken by the tissue")
        .def_ro("stored", &HeatBalance::stored, "[J], in the layer, beyond rest")
        .def_ro("perfused", &HeatBalance::perfused, "[J], carried away by blood")
        .def_ro("lost", &HeatBalance::lost, "[J], to what is below and to the air")
        .def_ro("boiled", &HeatBalance::boiled, "[J], left as steam")
        .def_ro("carried_off", &HeatBalance::carriedOff, "[J], left with pieces; negative where cuts bared warm tissue")
        .def_ro("fuming", &HeatBalance::fuming,
                "[J], of what was delivered: to tissue at 373.15 K or more, which smokes")
        .def_ro("hottest", &HeatBalance::hottest, "[K], now")
        .def_ro("peak", &HeatBalance::peak, "[K], since the body was added or reset")
        .def_ro("burnt", &HeatBalance::burnt, "[m^2], damaged")
        .def_ro("charred", &HeatBalance::charred, "[m^2], without water");
    using surface::EnergyBalance;
    nb::class_<EnergyBalance>(module, "EnergyBalance", "What an electrode has done.")
        .def_ro("active", &EnergyBalance::active, "[s], with its pedal pressed")
        .def_ro("in_air", &EnergyBalance::inAir, "[s], of these, without tissue that burns at its tip")
        .def_ro("delivered", &EnergyBalance::delivered, "[J], taken by tissue");
    using surface::AerosolBalance;
    nb::class_<AerosolBalance>(module, "AerosolBalance", "What became of smoke, or of droplets of steam.")
        .def_ro("emitted", &AerosolBalance::emitted, "[kg]")
        .def_ro("in_air", &AerosolBalance::inAir, "[kg], now")
        .def_ro("extracted", &AerosolBalance::extracted, "[kg], sucked away")
        .def_ro("vented", &AerosolBalance::vented, "[kg], pushed out by fresh gas")
        .def_ro("settled", &AerosolBalance::settled, "[kg], on walls; of droplets: dried up");
    using surface::SmokeBalance;
    nb::class_<SmokeBalance>(module, "SmokeBalance", "What became of the smoke of a simulation.")
        .def_ro("smoke", &SmokeBalance::smoke)
        .def_ro("steam", &SmokeBalance::steam, "droplets of condensed steam");
    using surface::DistensionBalance;
    nb::class_<DistensionBalance>(module, "DistensionBalance", "What became of the fluid that distends a cavity.")
        .def_ro("at_start", &DistensionBalance::atStart, "[m^3]")
        .def_ro("in_", &DistensionBalance::in, "[m^3], from bag or pump")
        .def_ro("bled", &DistensionBalance::bled, "[m^3], blood that welled into it")
        .def_ro("out", &DistensionBalance::out, "[m^3], through the outflow, blood among it")
        .def_ro("lost", &DistensionBalance::lost, "[m^3], through leaks and into vessels")
        .def_ro("volume", &DistensionBalance::volume, "[m^3], now")
        .def_ro("blood", &DistensionBalance::blood, "[m^3], in it now")
        .def_ro("pressure", &DistensionBalance::pressure, "[Pa], now, above that outside")
        .def_ro("inflow", &DistensionBalance::inflow, "[m^3/s], now")
        .def_ro("outflow", &DistensionBalance::outflow, "[m^3/s], now")
        .def_ro("gas_formed", &DistensionBalance::gasFormed, "[m^3], of all bubbles")
        .def_ro("gas", &DistensionBalance::gas, "[m^3], of bubbles now")
        .def_ro("beyond_limit", &DistensionBalance::beyondLimit, "the deficit is, or was, above the limit")
        .def_prop_ro("deficit", &surface::deficit, "[m^3], what went in and did not come out")
        .def_prop_ro("blood_share", &surface::bloodShare, "[-], share of blood in the fluid");
    using surface::DuctBalance;
    nb::class_<DuctBalance>(module, "DuctBalance", "What flows in a duct.")
        .def_prop_ro(
            "state",
            [](const DuctBalance& self) {
                return std::string(names(&self.state)[static_cast<std::size_t>(self.state)]);
            },
            "open, squeezed, clipped, cut or leaking")
        .def_ro("flow", &DuctBalance::flow, "[m^3/s], from the inlet to the outlet")
        .def_ro("leak", &DuctBalance::leak, "[m^3/s], out of its cut ends")
        .def_ro("lost", &DuctBalance::lost, "[m^3], that has flowed out of them")
        .def_ro("narrowest", &DuctBalance::narrowest, "[-], where it is narrowest: flow per pressure over that before")
        .def_ro("clips_before", &DuctBalance::clipsBefore, "[-], between the inlet and the cut, or on all of it")
        .def_ro("clips_after", &DuctBalance::clipsAfter, "[-], between the cut and the outlet");
    using runtime::DuctReport;
    nb::class_<DuctReport>(module, "DuctReport", "What has become of a duct in a run.")
        .def_ro("body", &DuctReport::body, "its name")
        .def_ro("duct", &DuctReport::duct, "the duct's name")
        .def_ro("balance", &DuctReport::balance);
    using runtime::OpenedSurfaces;
    nb::class_<OpenedSurfaces>(module, "OpenedSurfaces", "What was opened of a body in a run.")
        .def_ro("body", &OpenedSurfaces::body, "its name")
        .def_ro("steps", &OpenedSurfaces::steps, "that opened something of it")
        .def_ro("cut", &OpenedSurfaces::cut, "[m^2], one side, at rest")
        .def_ro("torn", &OpenedSurfaces::torn, "[m^2], one side, at rest")
        .def_ro("pieces", &OpenedSurfaces::pieces, "that came off")
        .def_ro("cavities", &OpenedSurfaces::cavities, "that were opened");
    using runtime::LostPiecesReport;
    nb::class_<LostPiecesReport>(module, "LostPiecesReport", "What a body has lost in a run.")
        .def_ro("body", &LostPiecesReport::body, "its name")
        .def_ro("pieces", &LostPiecesReport::pieces, "that went farther than 10 m and were removed")
        .def_ro("mass", &LostPiecesReport::mass, "[kg]")
        .def_ro("share", &LostPiecesReport::share, "[-], of the mass that the body had as a whole");
    nb::class_<RunReport>(module, "RunReport",
                          "How a run went. As text it is the summary that the command line prints.")
        .def_ro("steps", &RunReport::steps)
        .def_ro("time", &RunReport::time, "[s], simulated")
        .def_ro("hash", &RunReport::hash)
        .def_ro("undone", &RunReport::undone)
        .def_ro("undone_body", &RunReport::undoneBody, "the name of the first that was")
        .def_ro("undone_at_end", &RunReport::undoneAtEnd, "steps without a break at the end: physics has failed")
        .def_ro("damped", &RunReport::damped)
        .def_ro("not_converged", &RunReport::notConverged)
        .def_ro("intersecting", &RunReport::intersecting, "steps")
        .def_ro("inverted", &RunReport::inverted)
        .def_ro("beyond_strain", &RunReport::beyondStrain)
        .def_ro("restless", &RunReport::restless)
        .def_ro("energy_gained", &RunReport::energyGained)
        .def_ro("contacts", &RunReport::contacts)
        .def_ro("ducts", &RunReport::ducts)
        .def_ro("clips", &RunReport::clips, "in all steps")
        .def_ro("lost", &RunReport::lost, "one per body that lost pieces")
        .def_ro("opened", &RunReport::opened, "one per body that was cut or torn")
        .def_prop_ro("cut_area", &RunReport::cutArea, "[m^2], of all bodies, one side, at rest")
        .def_prop_ro("torn_area", &RunReport::tornArea, "[m^2], of all bodies, one side, at rest")
        .def_ro("nothing_changed", &RunReport::nothingChanged, "steps with a SetTissue that found no element")
        .def_ro("nothing_held", &RunReport::nothingHeld, "lines: attachments and grasps that held nothing")
        .def_ro("broke", &RunReport::broke, "lines: attachments and grasps of which points let go")
        .def_ro("blunt_blades", &RunReport::bluntBlades)
        .def_ro("callback_problems", &RunReport::callbackProblems)
        .def_ro("file_problems", &RunReport::fileProblems)
        .def_ro("finished", &RunReport::finished)
        .def_prop_ro("warnings", &runtime::warnings, "what went wrong in steps, a line each")
        .def_prop_ro(
            "wall_seconds", [](const RunReport& self) { return self.timing.wallSeconds; }, "[s] in steps")
        .def("__repr__", [](const RunReport& self) { return runtime::summary(self); });
}

} // namespace

void bindReports(nb::module_& module)
{
    bindFlags(module);
    bindParts(module);
    bindRuptures(module);
    bindStep(module);
    bindRun(module);
}

} // namespace filasofia::python

#include "defs.h"

#include "def_table.h"

#include "filasofia/prefab/clip_applier.h"
#include "filasofia/prefab/endoscope.h"
#include "filasofia/prefab/instrument_tie.h"
#include "filasofia/prefab/knot_hands.h"
#include "filasofia/prefab/laparoscope.h"
#include "filasofia/prefab/laparoscopic_instrument.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/prefab/specimen_bag.h"
#include "filasofia/prefab/suction_irrigator.h"
#include "filasofia/prefab/trocar_hands.h"
#include "filasofia/prefab/ultrasonic_shears.h"
#include "filasofia/prefab/wire_loop.h"

#include <nanobind/stl/vector.h>

namespace filasofia::python {
namespace {

using namespace physics;

const DefTable& table()
{
    static const DefTable made = [] {
        DefTable out;
        out.add<BodyDef>();
        // Every command but AddBody, which is Simulation.add(), and Tune, which needs C++.
        out.add<std::variant<RemoveBody, SetPose, SetGravity, SetMaterial, SetForces, SetPressure, SetWrench, Attach,
                             AttachRigid, Release, Grasp, RemovePiece, Reset, Pause, SetJoint, SetHaptic, SetTissue,
                             SetFibreStress, SetCurvature, SetCutting, SetCavity, ApplyClip>>();
        out.add<runtime::PhysicsDef>();
        out.add<runtime::LookDef>();
        out.add<runtime::ShowDef>();
        out.add<runtime::PaintDef>();
        out.add<surface::BleedingDef>();
        out.add<surface::BurningDef>();
        out.add<surface::Treatment>();
        out.add<surface::ElectrodeDef>();
        out.add<surface::DuctDef>();
        out.add<surface::SmokeDef>();
        out.add<surface::Extract>();
        out.add<surface::DistensionDef>();
        out.add<surface::Distend>();
        out.add<prefab::ClipApplierDef>();
        out.add<prefab::EndoscopeDef>();
        out.add<prefab::InstrumentTieDef>();
        out.add<prefab::KnotDef>();
        out.add<prefab::LaparoscopeDef>();
        out.add<prefab::LaparoscopicInstrumentDef>();
        out.add<prefab::SpecimenBagDef>();
        out.add<prefab::SuctionIrrigatorDef>();
        out.add<prefab::TrocarHandsDef>();
        out.add<prefab::UltrasonicShearsDef>();
        out.add<prefab::WireLoopDef>();
        out.add<runtime::PictureDef>();
        out.add<runtime::ViewerDef>();
        out.add<runtime::ReplayDef>();
        out.add<prefab::MetricTrackerDef>();
        return out;
    }();
    return made;
}

/// "[Pa], must be > 0"; empty for what has neither unit nor bound.
std::string boundOf(const FieldEntry& field)
{
    const bool bounded = std::isfinite(field.range.low) || std::isfinite(field.range.high);
    std::string out = field.unit.empty() ? std::string() : text("[", field.unit, "]");
    if (bounded) out += (out.empty() ? "" : ", ") + field.range.text("");
    return out;
}

nb::list schema()
{
    nb::list out;
    for (const DefEntry& def : table().entries()) {
        nb::list fields;
        for (const FieldEntry& field : def.fields)
            fields.append(nb::make_tuple(field.name, field.typing, boundOf(field), std::string(field.meaning)));
        out.append(nb::make_tuple(def.name, fields));
    }
    return out;
}

const DefEntry& entryAt(std::size_t def)
{
    if (def >= table().entries().size()) throw nb::index_error("no such Def");
    return table().entries()[def];
}

nb::object checkField(std::size_t def, std::size_t index, nb::handle value)
{
    const DefEntry& entry = entryAt(def);
    if (index >= entry.fields.size()) throw nb::index_error("no such field");
    const FieldEntry& field = entry.fields[index];
    const Where object{.name = entry.name};
    return field.keep(value, {.outer = &object, .name = field.name, .range = field.range, .unit = field.unit});
}

} // namespace

void bindDefs(nb::module_& module)
{
    module.def("schema", &schema, "The Defs in the order in which each needs those before it.");
    module.def("defaults", [](std::size_t def) { return entryAt(def).defaults(); });
    module.def("check_field", &checkField, nb::arg("number"), nb::arg("field"), nb::arg("value").none());
    module.def("set_classes", &setClasses);
    module.def(
        "did_you_mean",
        [](const std::string& word, const std::vector<std::string>& known) { return didYouMean(word, known); },
        "' (did you mean ...?)' for the nearest of the known words, or nothing.");
    module.def(
        "did_you_mean_one_of",
        [](const std::string& word, const std::vector<std::string>& known) { return didYouMeanOneOf(word, known); },
        "The same; if no known word is near, ' (it has ...)' with all, if these are few.");
}

} // namespace filasofia::python

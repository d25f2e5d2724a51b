#include "filasofia/prefab/laparoscopic_instrument.h"

#include "filasofia/core/text.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/trocar_drive.h"

namespace filasofia::prefab {
namespace {

std::string objectOf(const LaparoscopicInstrumentDef& def) { return text("instrument '", def.name, "'"); }

LaparoscopicInstrumentDef placed(LaparoscopicInstrumentDef def)
{
    if (def.tool.pose != Pose{}) fail(objectOf(def), ": tool.pose must be left out, start says where it is");
    if (def.tool.name != ArticulatedInstrumentDef{}.name)
        fail(objectOf(def), ": tool.name must be left out, got '", def.tool.name, "'");
    def.tool.name = def.name;
    def.tool.pose = pivotOf(def.trocar, def.start);
    return def;
}

} // namespace

struct LaparoscopicInstrument::Impl {
    Impl(runtime::Simulation& sim, const LaparoscopicInstrumentDef& asked)
        : def(asked), drive(sim, {objectOf(asked), asked.trocar, asked.hand, asked.start}),
          tool(sim, placed(asked).tool)
    {
    }
    [[nodiscard]] BodyId body() const { return tool.body(); }
    [[nodiscard]] Vec3 grip() const { return tool.grip(); }
    void go(const Pose& pivot) { tool.move(pivot); }

    const LaparoscopicInstrumentDef def;
    TrocarDrive drive;
    ArticulatedInstrument tool;
};

LaparoscopicInstrument::LaparoscopicInstrument(runtime::Simulation& simulation, const LaparoscopicInstrumentDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    driveEveryStep(simulation, impl_);
    remember(simulation, objectOf(def) + " in its trocar", std::shared_ptr<TrocarDrive>(impl_, &impl_->drive));
}
LaparoscopicInstrument::~LaparoscopicInstrument() = default;

BodyId LaparoscopicInstrument::body() const { return impl_->body(); }
const LaparoscopicInstrumentDef& LaparoscopicInstrument::def() const { return impl_->def; }
ArticulatedInstrument& LaparoscopicInstrument::tool() { return impl_->tool; }
const ArticulatedInstrument& LaparoscopicInstrument::tool() const { return impl_->tool; }
void LaparoscopicInstrument::move(const TrocarPose& pose) { impl_->drive.move(pose); }
TrocarReport LaparoscopicInstrument::report() const { return impl_->drive.report(); }
BodyId LaparoscopicInstrument::handle() const { return impl_->drive.handle(); }

} // namespace filasofia::prefab

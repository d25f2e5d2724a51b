#include "filasofia/engine/contact/clip_legs.h"

#include "filasofia/engine/contact/attachment_points.h"

namespace filasofia::engine {
namespace {

// [m] Points nearer to each other have no direction.
constexpr double kNoLength = 1e-9;

void addLegs(double dt, std::size_t body, const SoftState& state, const Clip& clip, std::vector<Constraint>& out)
{
    for (const ClipPair& pair : clip.pairs) {
        const Vec3 across = meanOf(pair[0], state.x) - meanOf(pair[1], state.x);
        const double d = length(across);
        if (!(d > clip.gap) || d < kNoLength) continue;
        Constraint& leg = out.emplace_back();
        leg.kind = ConstraintKind::ClipLeg;
        leg.frame = frameOf(1.0 / d * across);
        leg.bias.x = (d - clip.gap) / dt;
        leg.softness = dt * dt * clip.pairStiffness();
        // The tension over the length: points a few tenths of a millimetre apart turn it by what moves them sideways.
        // Without it the step does not know of that stiffness, which is many times the tissue's: a vessel that damping
        // of masses alone was to bring to rest shook at 0.7 m/s for ever, every other step.
        leg.across = (d - clip.gap) / d;
        for (std::size_t side = 0; side < 2; ++side) writeSoftPoint(pair[side], body, state, leg.sides[side]);
    }
}

} // namespace

void addClipLegs(double dt, const Scene& scene, Coupling& coupling)
{
    if (dt == 0.0) return;
    const std::size_t before = coupling.constraints.size();
    for (std::size_t b = 0; b < scene.soft.size(); ++b)
        for (const Clip& each : scene.soft[b].state.clips)
            addLegs(dt, b, scene.soft[b].state, each, coupling.constraints);
    coupling.clipLegCount = coupling.constraints.size() - before;
}

} // namespace filasofia::engine

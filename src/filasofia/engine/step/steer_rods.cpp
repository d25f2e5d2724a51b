#include "filasofia/engine/step/steer_rods.h"

namespace filasofia::engine {

void steerRods(const StepContext& context, Scene& scene)
{
    if (context.dt == 0.0) return;
    for (SoftBody& body : scene.soft) steer(context.dt, body.state.rod);
}

} // namespace filasofia::engine

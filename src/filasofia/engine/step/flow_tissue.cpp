#include "filasofia/engine/step/flow_tissue.h"

#include "filasofia/engine/body/plasticity.h"

#include <cmath>

namespace filasofia::engine {

void flowTissue(const StepContext& context, Scene& scene)
{
    if (context.dt == 0.0) return;
    for (SoftBody& body : scene.soft) {
        flow(body.model.rod, body.model.pins.hard, body.state.x, body.state.rod);
        if (!std::isfinite(body.model.yieldStress)) continue;
        const std::vector<int> elements = flow(body.state, context.pool, body.model);
        if (!elements.empty()) followTissue(body.model, elements, body.system);
    }
}

} // namespace filasofia::engine

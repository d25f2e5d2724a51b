#include "filasofia/physics/check_clip.h"

#include "filasofia/core/validate.h"

namespace filasofia::physics {

void check(const ClipDef& def, const std::string& object)
{
    validate(def, object);
    if (!(def.opening > def.gap)) fail(object, ".opening must be > gap, ", def.gap, " m, got ", def.opening);
}

void checkClipped(const SoftBodyDef& tissue, const std::string& object)
{
    const auto* cg = std::get_if<ConjugateGradient>(&tissue.solver);
    if (!std::holds_alternative<ImplicitEuler>(tissue.integrator) || !cg || cg->assembled)
        fail(object, ": clips need integrator ImplicitEuler and the default solver");
}

} // namespace filasofia::physics

#include "filasofia/runtime/layer_effects.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {

double spreadOf(const surface::BurningDef& def)
{
    constexpr double kLongest = 60.0;                                                 // [s]
    const double loss = def.loss + def.perfusion * def.bloodHeatCapacity * def.depth; // [W/(m^2 K)]
    const double perMinute = kLongest / (def.density * def.heatCapacity);             // [m^3 K/W]
    return std::sqrt(def.conductivity * (loss > 0.0 ? std::min(def.depth / loss, perMinute) : perMinute));
}

physics::SetTissue changeOf(BodyId id, const surface::HeatedTissueDef& def, surface::HeatedPart part)
{
    const auto towards = [&](double all) { return 1.0 + part.share * (all - 1.0); };
    return {.id = id,
            .region = {.where = physics::Listed{std::move(part.tetrahedra)}},
            .factors = physics::TissueFactors{.youngModulus = towards(def.stiffness),
                                              .tearingThreshold = towards(def.strength),
                                              .restScale = towards(1.0 - def.shrinkage)}};
}

void checkTissue(BodyId id, const physics::BodyDef& body, const physics::PhysicsEngine& engine,
                 const std::string& object)
{
    try {
        engine.check(physics::SetTissue{.id = id, .region = {}, .factors = physics::TissueFactors{}}, &body);
    } catch (const Error& problem) {
        fail(object, ": tissue: ", problem.what());
    }
}

bool reaches(const surface::Injure& injure, const surface::Bleeding& layer, const frame::SoftBodyFrame& body)
{
    const auto isNear = [&](std::size_t node) {
        return node < body.positions.size() && distance(body.positions[node], injure.place) <= injure.radius;
    };
    const std::vector<float> thickness = layer.thickness();
    for (std::size_t node = 0; node < thickness.size(); ++node)
        if (thickness[node] >= 0.0f && isNear(node)) return true;
    return body.boundary && std::ranges::any_of(body.boundary->triangles, [&](const geometry::Triangle& t) {
               return std::ranges::any_of(t, [&](int node) { return isNear(static_cast<std::size_t>(node)); });
           });
}

} // namespace filasofia::runtime

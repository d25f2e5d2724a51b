#include "filasofia/engine/body/tissue_map.h"

#include "filasofia/core/error.h"

namespace filasofia::engine {

std::shared_ptr<const TissueMap> mapTissue(const physics::FemMaterial& material, const geometry::TetMesh& mesh,
                                           Quat orientation, double density, const std::string& object)
{
    physics::checkStiffnessField(material, mesh, object);
    auto map = std::make_shared<TissueMap>();
    map->of.assign(mesh.tetrahedra.size(), {.youngModulus = material.youngModulus,
                                            .poissonRatio = material.poissonRatio,
                                            .tearingThreshold = material.tearingThreshold,
                                            .yieldStress = material.yieldStress,
                                            .density = density});
    for (std::size_t t = 0; t < material.stiffnessField.size(); ++t)
        map->of[t].youngModulus *= material.stiffnessField[t];
    for (std::size_t r = 0; r < material.regions.size(); ++r) {
        const physics::TissueRegion& region = material.regions[r];
        for (int t : physics::tetrahedraOf(region.where, mesh, text(object, ".regions[", r, "].where"))) {
            TetrahedronTissue& tissue = map->of[static_cast<std::size_t>(t)];
            apply(region, tissue);
            tissue.density = region.density.value_or(tissue.density);
        }
    }
    for (std::size_t k = 0; k < material.fibres.size(); ++k) {
        map->fibres.push_back(physics::directionsOf(material.fibres[k], mesh, text(object, ".fibres[", k, "]")));
        for (Vec3& direction : map->fibres.back()) direction = rotate(orientation, direction);
    }
    return map;
}

} // namespace filasofia::engine

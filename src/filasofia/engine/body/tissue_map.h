#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/math/quat.h"
#include "filasofia/physics/fem_material.h"

#include <memory>
#include <string>
#include <vector>

namespace filasofia::engine {

/// What a material says of one tetrahedron of the Def's mesh.
struct TetrahedronTissue {
    double youngModulus = 0.0;     ///< [Pa]
    double poissonRatio = 0.0;     ///< [-]
    double tearingThreshold = 0.0; ///< [Pa]
    double yieldStress = 0.0;      ///< [Pa]
    double density = 0.0;          ///< [kg/m^3]
    double restScale = 1.0;        ///< [-]
};

/// Sets what the region gives, but for the density, of a tetrahedron or an element.
template <class Tissue> void apply(const physics::TissueRegion& region, Tissue& tissue)
{
    tissue.youngModulus = region.youngModulus.value_or(tissue.youngModulus);
    tissue.poissonRatio = region.poissonRatio.value_or(tissue.poissonRatio);
    tissue.tearingThreshold = region.tearingThreshold.value_or(tissue.tearingThreshold);
    tissue.yieldStress = region.yieldStress.value_or(tissue.yieldStress);
    tissue.restScale = region.restScale.value_or(tissue.restScale);
}

/// Sets what factors concern, of an element whose tetrahedron is `of` that material.
template <class Tissue> void apply(const physics::TissueFactors& factors, const TetrahedronTissue& of, Tissue& tissue)
{
    tissue.youngModulus = factors.youngModulus * of.youngModulus;
    tissue.tearingThreshold = factors.tearingThreshold * of.tearingThreshold;
    tissue.restScale = factors.restScale * of.restScale;
}

/// A material looked up in a mesh, which takes too long for a step: it is made where a body is built.
struct TissueMap {
    std::vector<TetrahedronTissue> of; ///< per tetrahedron
    /// Per family of fibres and tetrahedron: the direction at rest, in the world; zero: no fibre
    std::vector<std::vector<Vec3>> fibres;
};

/// `density` [kg/m^3]: where no region says another. `orientation`: of the mesh in the world. Throws an Error that
/// begins with `object` if a region, a direction of fibres or the stiffness field does not fit the mesh.
std::shared_ptr<const TissueMap> mapTissue(const physics::FemMaterial& material, const geometry::TetMesh& mesh,
                                           Quat orientation, double density, const std::string& object);

} // namespace filasofia::engine

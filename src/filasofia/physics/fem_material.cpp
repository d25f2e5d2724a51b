#include "filasofia/physics/fem_material.h"

#include "filasofia/core/error.h"

namespace filasofia::physics {

void check(const FemMaterial& material, const std::string& object)
{
    check(material.law, object + ".law");
    if (material.fibres.size() > kMostFamilies)
        fail(object, ".fibres must have at most ", kMostFamilies, " entries, got ", material.fibres.size());
    if (material.relaxation.size() > kMostPronyTerms)
        fail(object, ".relaxation must have at most ", kMostPronyTerms, " entries, got ", material.relaxation.size());
    double sum = 0.0;
    for (const PronyTerm& term : material.relaxation) sum += term.share;
    if (!(sum < 1.0)) fail(object, ".relaxation: the shares must add up to less than 1, got ", sum);
}

void checkStiffnessField(const FemMaterial& material, const geometry::TetMesh& mesh, const std::string& object)
{
    const std::size_t given = material.stiffnessField.size(), count = mesh.tetrahedra.size();
    if (given != 0 && given != count)
        fail(object, ".stiffnessField must have one entry per tetrahedron (", count, "), got ", given);
}

void check(const FemMaterial& material, const geometry::TetMesh& mesh, const std::string& object)
{
    checkStiffnessField(material, mesh, object);
    for (std::size_t i = 0; i < material.regions.size(); ++i)
        static_cast<void>(tetrahedraOf(material.regions[i].where, mesh, text(object, ".regions[", i, "].where")));
    for (std::size_t i = 0; i < material.fibres.size(); ++i)
        static_cast<void>(directionsOf(material.fibres[i], mesh, text(object, ".fibres[", i, "]")));
}

void resolveNames(const geometry::TetMesh& mesh, const std::string& object, FemMaterial& material)
{
    for (std::size_t i = 0; i < material.regions.size(); ++i)
        resolveNames(mesh, text(object, ".regions[", i, "].where"), material.regions[i].where);
    for (std::size_t i = 0; i < material.fibres.size(); ++i) {
        FibreFamily& family = material.fibres[i];
        if (family.where) resolveNames(mesh, text(object, ".fibres[", i, "].where"), *family.where);
        auto* field = std::get_if<HarmonicField>(&family.direction);
        if (!field) continue;
        resolveNames(mesh, text(object, ".fibres[", i, "].direction.from"), field->from);
        resolveNames(mesh, text(object, ".fibres[", i, "].direction.to"), field->to);
    }
}

} // namespace filasofia::physics

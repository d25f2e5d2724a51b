#include "filasofia/sofa/shown_model.h"

#include <sofa/core/ObjectFactory.h>
#include <sofa/helper/io/Mesh.h>
#include <sofa/simulation/Node.h>

#include <memory>

namespace filasofia::sofaengine {

ShownModel::ShownModel()
    : d_position(initData(&d_position, "position", "vertices")),
      d_triangles(initData(&d_triangles, "triangles", "triangles over the vertices")),
      d_quads(initData(&d_quads, "quads", "quads over the vertices")),
      d_file(initData(&d_file, "filename", "a mesh of its own")),
      d_scale3d(initData(&d_scale3d, {1, 1, 1}, "scale3d", "scale")),
      d_rotation(initData(&d_rotation, "rotation", "degrees about x, y and z")),
      d_translation(initData(&d_translation, "translation", "translation")),
      d_scale(initData(&d_scale, 1.0, "scale", "scale")), d_dx(initData(&d_dx, 0.0, "dx", "translation")),
      d_dy(initData(&d_dy, 0.0, "dy", "translation")), d_dz(initData(&d_dz, 0.0, "dz", "translation"))
{
}

void ShownModel::parse(::sofa::core::objectmodel::BaseObjectDescription* words)
{
    // An OglModel has these, and a picture of ours has no use for them. SOFA warns of words that nobody reads.
    for (const char* each : {"color", "material", "materials", "texturename", "texcoords", "normals", "useNormals",
                             "updateNormals", "handleDynamicTopology"})
        words->getAttribute(each);
    State::parse(words);
}

void ShownModel::init()
{
    ::sofa::helper::WriteAccessor position(d_position);
    ::sofa::helper::WriteAccessor triangles(d_triangles);
    ::sofa::helper::WriteAccessor quads(d_quads);
    if (position.empty() && !d_file.getValue().empty()) {
        const std::unique_ptr<::sofa::helper::io::Mesh> mesh(::sofa::helper::io::Mesh::Create(d_file.getFullPath()));
        if (!mesh) return; // SOFA has told it
        for (const auto& vertex : mesh->getVertices()) position.push_back(vertex);
        for (const auto& facet : mesh->getFacets()) // a fan over each
            for (std::size_t i = 2; !facet.empty() && i < facet[0].size(); ++i)
                triangles.push_back(Topology::Triangle(facet[0][0], facet[0][i - 1], facet[0][i]));
        place();
        return;
    }
    if (!position.empty()) place();
    // Without vertices of its own it shows the mesh around it.
    auto* around = getContext()->getMeshTopology();
    if (!position.empty() || !around) return;
    showsMesh_ = true;
    for (::sofa::Size i = 0; i < around->getNbPoints(); ++i)
        position.push_back({around->getPX(i), around->getPY(i), around->getPZ(i)});
    for (const auto& each : around->getTriangles()) triangles.push_back(each);
    for (const auto& each : around->getQuads()) quads.push_back(each);
}

ShownModel::Topology* ShownModel::mesh() const { return showsMesh_ ? getContext()->getMeshTopology() : nullptr; }

void ShownModel::place()
{
    const ::sofa::type::Vec3 old{d_dx.getValue(), d_dy.getValue(), d_dz.getValue()};
    const auto turn = ::sofa::type::Quat<SReal>::fromEuler(d_rotation.getValue()[0] * M_PI / 180,
                                                           d_rotation.getValue()[1] * M_PI / 180,
                                                           d_rotation.getValue()[2] * M_PI / 180);
    ::sofa::helper::WriteAccessor position(d_position);
    for (auto& each : position) {
        each = each.linearProduct(d_scale3d.getValue()) * d_scale.getValue();
        each = turn.rotate(each) + d_translation.getValue() + old;
    }
}

bool ShownModel::insertInNode(::sofa::core::objectmodel::BaseNode* node)
{
    auto* graph = dynamic_cast<::sofa::simulation::Node*>(node);
    isNodesState_ = graph && !graph->getState();
    return isNodesState_ ? Inherit1::insertInNode(node) : BaseObject::insertInNode(node);
}

bool ShownModel::removeInNode(::sofa::core::objectmodel::BaseNode* node)
{
    return isNodesState_ ? Inherit1::removeInNode(node) : BaseObject::removeInNode(node);
}

void ShownModel::resize(::sofa::Size size) { ::sofa::helper::WriteAccessor(d_position).resize(size); }

void registerShownModel()
{
    static const bool once = [] {
        auto* factory = ::sofa::core::ObjectFactory::getInstance();
        if (factory->hasCreator("OglModel")) return true;
        ::sofa::core::ObjectRegistrationData("What Filasofia shows")
            .addCreator("OglModel", Vec3Types::Name(), std::make_shared<::sofa::core::ObjectCreator<ShownModel>>())
            .commitTo(factory);
        return true;
    }();
    static_cast<void>(once);
}

} // namespace filasofia::sofaengine

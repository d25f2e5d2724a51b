#include "filasofia/sofa/collision_node.h"

#include <sofa/component/collision/geometry/LineCollisionModel.h>
#include <sofa/component/collision/geometry/PointCollisionModel.h>
#include <sofa/component/collision/geometry/TriangleCollisionModel.h>
#include <sofa/component/mapping/linear/BarycentricMapping.h>
#include <sofa/component/mapping/linear/SubsetMapping.h>
#include <sofa/component/mapping/nonlinear/RigidMapping.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>
#include <sofa/simulation/Node.h>

namespace filasofia::sofaengine {
namespace {

using namespace ::sofa::component;
using ::sofa::core::objectmodel::New;
using ::sofa::simulation::Node;

/// A node below the body's, its states and the mesh over them.
struct Surface {
    Node::SPtr node;
    SoftStates::SPtr states;
};

Surface addSurface(const CollisionPlan& plan, Node& body, const Vec3Types::VecCoord& places)
{
    Surface surface{body.createChild("collision"), New<SoftStates>()};
    auto mesh = New<topology::container::constant::MeshTopology>();
    mesh->setNbPoints(static_cast<::sofa::Size>(places.size()));
    for (const geometry::Triangle& t : plan.mesh.triangles)
        mesh->addTriangle(static_cast<::sofa::Index>(t[0]), static_cast<::sofa::Index>(t[1]),
                          static_cast<::sofa::Index>(t[2]));
    surface.node->addObject(mesh);
    surface.states->resize(static_cast<::sofa::Size>(places.size()));
    surface.states->x.setValue(places);
    surface.states->x0.setValue(places);
    surface.node->addObject(surface.states);
    return surface;
}

template <class Base>
void addModel(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact, Node& to)
{
    const auto model = New<TaggedModel<Base>>();
    model->tag = tag;
    model->setContactDistance(contact.skin(plan.def.proximity));
    model->setContactStiffness(1.0); // 0 would switch its contacts off
    model->setSelfCollision(tag.self);
    model->setMoving(true);
    model->setSimulated(tag.moves || tag.driven);
    to.addObject(model);
}

ModelTag addModels(const CollisionPlan& plan, ModelTag tag, const ContactStage& contact, Node& to)
{
    tag.group = plan.def.group;
    tag.self = plan.def.self;
    tag.element = plan.def.element;
    tag.stiffness = contact.stiffness();
    if (!plan.def.cutting) tag.passes.reset();
    tag.welded = contact.welded();
    using namespace collision::geometry;
    if (plan.def.primitives.triangles) addModel<TriangleCollisionModel<Vec3Types>>(plan, tag, contact, to);
    if (plan.def.primitives.lines) addModel<LineCollisionModel<Vec3Types>>(plan, tag, contact, to);
    if (plan.def.primitives.points) addModel<PointCollisionModel<Vec3Types>>(plan, tag, contact, to);
    return tag;
}

Node& nodeOf(const ::sofa::core::objectmodel::BaseObject& each)
{
    return *::sofa::simulation::node::getNodeFrom(
        const_cast<::sofa::core::objectmodel::BaseContext*>(each.getContext()));
}

} // namespace

CollisionSurface addCollision(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact,
                              SoftStates& body)
{
    Vec3Types::VecCoord places;
    for (const Vec3 vertex : plan.mesh.vertices) places.push_back(toSofa(vertex));
    const Surface surface = addSurface(plan, nodeOf(body), places);
    if (plan.nodes.empty()) {
        const auto mapping = New<mapping::linear::BarycentricMapping<Vec3Types, Vec3Types>>();
        mapping->setModels(&body, surface.states.get());
        surface.node->addObject(mapping);
    } else {
        const auto mapping = New<mapping::linear::SubsetMapping<Vec3Types, Vec3Types>>();
        mapping->setModels(&body, surface.states.get());
        ::sofa::type::vector<::sofa::Index> indices;
        for (const int node : plan.nodes) indices.push_back(static_cast<::sofa::Index>(node));
        mapping->d_indices.setValue(indices);
        surface.node->addObject(mapping);
    }
    return {addModels(plan, tag, contact, *surface.node), surface.states, plan.mesh.triangles,
            contact.skin(plan.def.proximity)};
}

CollisionSurface addCollision(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact,
                              RigidStates& body, Vec3 centre)
{
    Vec3Types::VecCoord places;
    for (const Vec3 vertex : plan.mesh.vertices) places.push_back(toSofa(vertex - centre));
    const Surface surface = addSurface(plan, nodeOf(body), places);
    const auto mapping = New<mapping::nonlinear::RigidMapping<RigidTypes, Vec3Types>>();
    mapping->setModels(&body, surface.states.get());
    mapping->d_points.setValue(places);
    mapping->d_index.setValue(static_cast<::sofa::Index>(plan.def.element));
    surface.node->addObject(mapping);
    return {addModels(plan, tag, contact, *surface.node), surface.states, plan.mesh.triangles,
            contact.skin(plan.def.proximity)};
}

} // namespace filasofia::sofaengine

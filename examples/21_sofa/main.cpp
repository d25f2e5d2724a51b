// A component that only SOFA has, in a body of a Def: tissue with the law of Arruda and Boyce.
#include <filasofia/filasofia.h>
#include <filasofia/sofa/tune.h>

#include <sofa/component/solidmechanics/fem/hyperelastic/TetrahedronHyperelasticityFEMForceField.h>
#include <sofa/simulation/Node.h>

using namespace filasofia;
using Law = sofa::component::solidmechanics::fem::hyperelastic::TetrahedronHyperelasticityFEMForceField<
    sofa::defaulttype::Vec3Types>;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {.title = "SOFA"}});
    sim.useEngine("sofa");
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = asset("meshes/bunny_756.msh"),
        .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}}, // pinned at the head
    });
    sim.show(bunny, {.surface = asset("meshes/bunny.obj"), .subdivision = 1});
    sofaengine::tune(sim.physics(), [bunny](sofa::simulation::Node&, const sofaengine::NodeOf& nodeOf) {
        sofa::simulation::Node& node = *nodeOf(bunny);
        const auto law = sofa::core::objectmodel::New<Law>();
        law->setMaterialName("ArrudaBoyce");
        const double mu = 4_kPa, bulk = 30_kPa;
        Law::SetParameterArray parameters;
        parameters.push_back(mu);
        parameters.push_back(bulk);
        law->setparameter(parameters);
        node.removeObject(node.getObject("law"));
        node.addObject(law);
        law->init();
    });
    if (const int problem = sim.run(argc, argv)) return problem;
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const auto lowest = std::ranges::min(frame->softBody(bunny)->positions, {}, &Vec3::y);
    std::printf("after %.3f s the lowest point hangs at %.1f mm\n", frame->time, lowest.y * 1e3);
    return frame->time < 0.2 || lowest.y < -0.01 ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}

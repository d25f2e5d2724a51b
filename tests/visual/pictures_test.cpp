// Every material, light and effect as a picture, held against a reference (see pictures.h).
#include "little_scene.h"
#include "organs.h"
#include "pictures.h"

using namespace filasofia;
using namespace filasofia::visual;

namespace {

/// An operating field: folded tissue, an organ on it, a probe that touches it, and an endoscope's camera and light.
struct Scenery {
    explicit Scenery(const Material& material = TissueMaterial{}, Effects effects = effectsOf(Quality::High, 0.008))
    {
        server.add(VisualBodyDef{.name = "bed",
                                 .mesh = bed(0.30),
                                 .material = TissueMaterial{.baseColor = {0.50, 0.115, 0.095}, .noiseScale = 130.0}})
            .setPose({{0, -0.035, -0.02}, {}});
        body = &server.add(
            VisualBodyDef{.name = "organ", .mesh = organ(0.032, 3), .subdivision = 1, .material = material});
        tool = &server.add(VisualBodyDef{.name = "probe", .mesh = probe(), .subdivision = 1, .material = MetalMaterial{}});
        tool->setPose(lookAlong({0.036, 0.016, 0.016}, {0.55, 0.55, 0.45}));
        rig = &server.addTransform("endoscope");
        camera = &server.add(CameraDef{.verticalFieldOfView = 50.0 * kPi / 180.0, .near = 0.01, .focusDistance = 0.11});
        lamp = &server.add(LightDef{.kind = SpotLight{.intensity = 105.0, .innerAngle = 0.25, .outerAngle = 0.75}});
        camera->attachTo(*rig);
        lamp->attachTo(*rig);
        lamp->setPose(lookAt({-0.022, 0.026, 0.0}, {0.0, 0.0, -0.14}));
        rig->setPose(lookAt({-0.012, 0.062, 0.125}, {0.006, -0.003, 0.0}));
        view = &server.add(ViewDef{.effects = effects}, *camera);
        EnvironmentDef environment;
        environment.lampDirection = rotate(rig->pose().orientation, Vec3{0.45, 0.8, 0.6});
        server.setEnvironment(environment);
    }

    /// The pose whose +X axis points along `direction`.
    static Pose lookAlong(Vec3 from, Vec3 direction)
    {
        const Pose towards = lookAt(from, from + direction);
        return {from, towards.orientation * axisAngle({0, 1, 0}, kPi / 2)};
    }

    void set(const Effects& effects)
    {
        ViewDef def = view->def();
        def.effects = effects;
        view->set(def);
    }

    VisualServer server{{.width = 320, .height = 240}};
    VisualBody* body = nullptr;
    VisualBody* tool = nullptr;
    Transform* rig = nullptr;
    Camera* camera = nullptr;
    Light* lamp = nullptr;
    View* view = nullptr;
};

} // namespace

TEST_CASE("picture: tissue") { checkPicture(Scenery().server.capture(), "tissue"); }
TEST_CASE("picture: mucosa") { checkPicture(Scenery(MucosaMaterial{}).server.capture(), "mucosa"); }
TEST_CASE("picture: glass") { checkPicture(Scenery(GlassMaterial{}).server.capture(), "glass"); }
TEST_CASE("picture: metal") { checkPicture(Scenery(MetalMaterial{}).server.capture(), "metal"); }
TEST_CASE("picture: unlit") { checkPicture(Scenery(UnlitMaterial{{0.5,0.2,0.1}}).server.capture(), "unlit"); }
TEST_CASE("picture: bone") { checkPicture(Scenery(BoneMaterial{}).server.capture(), "bone"); }

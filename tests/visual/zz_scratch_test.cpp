#include "little_scene.h"
#include "organs.h"
using namespace filasofia;
using namespace filasofia::visual;
TEST_CASE("scratch: tone") {
    VisualServer server({.width = 32, .height = 32});
    Camera& cam = server.add(CameraDef{}); cam.setPose({{0,0,0.05},{}});
    server.add(ViewDef{.quality = Quality::Low}, cam);
    VisualBody& b = server.add(VisualBodyDef{.name="q", .mesh = screen(1,1), .material = CustomMaterial{"/tmp/look/raw.filamat", {{"color", Color{}}}}});
    auto show = [&](Vec3 c) { b.setMaterial(CustomMaterial{"/tmp/look/raw.filamat", {{"color", c}}}); auto p = server.capture().pixel(16,16); std::printf("%.5f %.5f %.5f %d %d %d\n", c.x,c.y,c.z,p[0],p[1],p[2]); };
    for (double x = 0.001; x < 60; x *= 1.25) show({x,x,x});
    for (Vec3 c : {Vec3{0.5,0.2,0.1},Vec3{0.8,0.05,0.05},Vec3{0.05,0.6,0.1},Vec3{0.1,0.2,0.8}}) show(c);
    for (Color c : {Color{0.5,0.2,0.1},Color{0.8,0.05,0.05},Color{0.05,0.6,0.1},Color{0.1,0.2,0.8},Color{0.2,0.2,0.2},Color{1,1,1}}) { b.setMaterial(UnlitMaterial{c}); auto p = server.capture().pixel(16,16); auto e=[](double v){return v<0.0031308?255*12.92*v:255*(1.055*std::pow(v,1/2.4)-0.055);}; std::printf("unlit want %.0f %.0f %.0f got %d %d %d\n", e(c.red),e(c.green),e(c.blue),p[0],p[1],p[2]); }
}
TEST_CASE("scratch: offscreen") {
    LittleScene scene;
    View& v = scene.server.add(ViewDef{.name="o", .quality=Quality::High, .target = OffScreen{320,240}}, *scene.look.camera);
    savePng(v.capture(), "/tmp/look/off.png");
    std::printf("off %f\n", brightness(v.capture()));
    scene.server.render();
    ViewDef d = v.def(); d.effects = effectsOf(Quality::High); d.effects->endoscope = EndoscopeOptics{}; v.set(d);
    std::printf("off optics %f\n", brightness(v.capture()));
    d.target = InWindow{}; d.effects->endoscope.reset(); v.set(d);
    std::printf("win %f\n", brightness(scene.server.capture()));
    d.effects->endoscope = EndoscopeOptics{};v.set(d);
    std::printf("win optics %f\n", brightness(scene.server.capture()));
}
TEST_CASE("scratch: pip") {
  for (int k = 0; k < 3; ++k) {
    LittleScene scene;
    View& v = scene.server.add(ViewDef{.name="o", .quality=Quality::High, .target = OffScreen{320,240}}, *scene.look.camera);
    if (k == 1) v.capture();
    Camera& c = scene.server.add(CameraDef{}); c.setPose({{10,0,0.5},{}});
    VisualBody& b = scene.server.add(VisualBodyDef{.name="q", .mesh = screen(0.4,0.3), .material = UnlitMaterial{.texture = ViewPicture{"o"}}});
    b.setPose({{10,0,0},{}});
    scene.look.view->setCamera(c);
    if (k == 2) scene.look.view->setVisible(false);
    std::printf("pip %f\n", brightness(scene.server.capture()));
    std::printf("pip %f\n", brightness(scene.server.capture()));
  }
}

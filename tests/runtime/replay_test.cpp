#include "filasofia/runtime/replay.h"

#include "filasofia/filasofia.h"
#include "filasofia/runtime/scene_events.h"
#include "filasofia/visual/image.h"

#include "skip.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace replay_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A folder for this test's files, removed at the end.
struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / text("filasofia_runtime_replay_test_", getpid());
    Folder() { std::filesystem::create_directory(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    [[nodiscard]] std::string operator/(const char* name) const { return (path / name).string(); }
};

std::string bytesOf(const std::string& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Writes an event, reads it and writes it again: the text must be the same.
template <class Event> Event roundTrip(const Event& event)
{
    const record::SceneRecord once = recordOf(event);
    const SceneEvent back = eventOf(once);
    REQUIRE(std::holds_alternative<Event>(back));
    CHECK(recordOf(back).words == once.words);
    return std::get<Event>(back);
}

/// A square with a texture whose file has this colour.
std::shared_ptr<const TriangleMesh> square()
{
    return std::make_shared<const TriangleMesh>(TriangleMesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                                             .triangles = {{0, 1, 2}, {0, 2, 3}},
                                                             .uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
}

void writeTexture(const std::string& file, unsigned char red)
{
    visual::Image image{.width = 4, .height = 4, .rgba = {}};
    for (int i = 0; i < 16; ++i) image.rgba.insert(image.rgba.end(), {red, 20, 30, 255});
    visual::savePng(image, file);
}

} // namespace

TEST_CASE("every event of a scene comes back from its recording")
{
    const auto began = roundTrip(SceneBegan{.look = {.around = Box{{0, 0, 0}, {1, 2, 3}}, .quality = Quality::Medium},
                                            .width = 640,
                                            .height = 480,
                                            .dressed = true});
    CHECK((began.width == 640 && began.dressed && began.look.quality == Quality::Medium && began.look.around));
    const auto bled = roundTrip(SceneBled{BodyId{4}, {.flux = 3e-4, .vesselDensity = 7e5}, {0, 0, -9.81}});
    CHECK((bled.body == BodyId{4} && bled.def.flux == 3e-4 && bled.gravity.z == -9.81));
    CHECK(std::isinf(std::get<Rinse>(roundTrip(SceneTreated{BodyId{4}, Rinse{}}).command).radius));
    CHECK(std::get<Suck>(roundTrip(SceneTreated{BodyId{4}, Suck{.rate = 2e-7}}).command).rate == 2e-7);
    const auto rinsed = std::get<Rinse>(
        roundTrip(SceneTreated{BodyId{4}, Rinse{.rate = 0.0, .body = BodyId{7}, .element = 2}}).command);
    CHECK((rinsed.rate == 0.0 && rinsed.body == BodyId{7} && rinsed.element == 2));
    const Heat heat{.place = {1, 2, 3}, .power = 30.0, .limit = 400.0, .source = 7};
    const auto heated = std::get<Heat>(roundTrip(SceneTreated{BodyId{4}, heat}).command);
    CHECK((heated.place == heat.place && heated.power == 30.0 && heated.limit == 400.0 && heated.source == 7));
    const auto burnt = roundTrip(SceneBurnt{BodyId{4}, {.depth = 7e-4, .target = false}});
    CHECK((burnt.body == BodyId{4} && burnt.def.depth == 7e-4 && burnt.def.frequencyFactor == 3.1e98));
    CHECK_FALSE(burnt.def.target);
    CHECK(roundTrip(SceneFile{"a \"b\".png", 7, 0xffffffffffffffffu}).digest == 0xffffffffffffffffu);
    const auto shown = roundTrip(SceneShown{
        3,
        BodyId{2},
        {.surface = square(), .material = UnlitMaterial{.texture = TextureFile{"t.png"}}, .visible = false}});
    REQUIRE(std::get<1>(shown.def.surface));
    CHECK(std::get<1>(shown.def.surface)->uv == square()->uv);
    CHECK(shown.def.material == visual::Material{UnlitMaterial{.texture = TextureFile{"t.png"}}});
    CHECK(!shown.def.visible);
    const std::vector<visual::MaterialParameter> parameters = {{"a", 0.5},
                                                               {"b", 3},
                                                               {"c", true},
                                                               {"d", visual::Color{1, 0, 0.5}},
                                                               {"e", Vec3{1, 2, 3}},
                                                               {"f", std::array{1.0, 2.0, 3.0, 4.0}},
                                                               {"g", visual::Texture{TextureFile{"g.png"}}}};
    for (const visual::Material& material :
         {visual::Material{TissueMaterial{}}, visual::Material{MetalMaterial{}}, visual::Material{MucosaMaterial{}},
          visual::Material{BoneMaterial{}}, visual::Material{GlassMaterial{}}, visual::Material{NamedMaterial{"n"}},
          visual::Material{UnlitMaterial{.texture = visual::ViewPicture{"v"}}},
          visual::Material{CustomMaterial{"c.filamat", parameters}}, visual::Material{ThreadMaterial{.strands = 0}}})
        CHECK(roundTrip(SceneMaterial{1, material}).material == material);
    CHECK(roundTrip(SceneVisible{1, false}).visible == false);
    CHECK(roundTrip(SceneUnshown{9}).shown == 9);
    const auto painted =
        roundTrip(ScenePainted{BodyId{4}, {.radius = 0.1, .state = {.burn = 0.5}, .mode = PaintMode::Replace}});
    CHECK((painted.body == BodyId{4} && painted.def.mode == PaintMode::Replace && painted.def.state.burn == 0.5));
    roundTrip(SceneCleaned{});
    visual::ViewDef view{.name = "off", .effects = visual::effectsOf(Quality::High), .target = visual::OffScreen{3, 4}};
    view.effects->endoscope.emplace();
    const auto stage = roundTrip(SceneStage{.materials = {{"m", MetalMaterial{}}},
                                            .cameras = {{.name = "eye"}},
                                            .lights = {{.kind = visual::PointLight{}}, {.kind = SpotLight{}}},
                                            .views = {{view, 0, false}}});
    CHECK((stage.cameras.size() == 1 && stage.lights.size() == 2 && stage.views.size() == 1));
    CHECK(stage.views[0].def.effects == view.effects);
    CHECK(roundTrip(ScenePlaces{{{}, {Pose{{1, 2, 3}, {}}, false}}, {}}).cameras[1].pose.position == Vec3{1, 2, 3});
    const auto electrode = roundTrip(SceneElectrode{
        BodyId{4},
        {.mode = EnergyMode::Bipolar, .power = 7.0, .other = ElectrodeTip{.element = 2, .body = BodyId{5}}}});
    CHECK((electrode.body == BodyId{4} && electrode.def.mode == EnergyMode::Bipolar && electrode.def.power == 7.0));
    CHECK((electrode.def.other && electrode.def.other->element == 2 && electrode.def.other->body == BodyId{5}));
    const auto activated = roundTrip(SceneActivated{BodyId{4}, 1, true});
    CHECK((activated.body == BodyId{4} && activated.electrode == 1 && activated.on));
    const auto duct = roundTrip(SceneDuct{BodyId{5}, {.name = "bile", .path = {{1, 2, 3}, {4, 5, 6}}, .radius = 2e-3}});
    CHECK(duct.body == BodyId{5});
    CHECK(duct.def.path == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
    CHECK(duct.def.radius == 2e-3);
    const auto smoke = roundTrip(SceneSmoke{{.room = Box{{0, 0, 0}, {1, 2, 3}}, .yield = 3e-8}, {0, 0, -9.81}});
    CHECK((smoke.def.room.high == Vec3{1, 2, 3} && smoke.def.yield == 3e-8 && smoke.gravity.z == -9.81));
    CHECK(std::isinf(
        roundTrip(SceneSmoke{{.room = Box{{0, 0, 0}, {1, 1, 1}}, .settling = std::numeric_limits<double>::infinity()}})
            .def.settling));
    const auto opening = roundTrip(SceneExtracted{{.place = {1, 2, 3}, .flow = 1e-4, .body = BodyId{3}, .source = 2}});
    CHECK((opening.command.place == Vec3{1, 2, 3} && opening.command.flow == 1e-4 && opening.command.source == 2));
    CHECK(opening.command.body == BodyId{3});
    const auto fluid = roundTrip(
        SceneDistension{{.room = Box{{0, 0, 0}, {1, 2, 3}}, .pressure = 9e3, .up = Vec3{0, 0, 2}}, {0, 0, -9.81}});
    CHECK((fluid.def.room.high == Vec3{1, 2, 3} && fluid.def.pressure == 9e3 && fluid.gravity.z == -9.81));
    CHECK(std::isinf(fluid.def.leakResistance));
    CHECK((fluid.def.up && *fluid.def.up == Vec3{0, 0, 2}));
    const auto turned = roundTrip(SceneDistended{{.outflow = 0.5}}).command;
    CHECK((!turned.pressure && !turned.inflow && turned.outflow && *turned.outflow == 0.5));
    STATIC_REQUIRE(std::variant_size_v<SceneEvent> == 20);
}

TEST_CASE("fields that materials got later are in a recording if they are set, and may be missing")
{
    const auto words = [](const visual::Material& material) { return recordOf(SceneMaterial{1, material}).words; };
    const visual::Material before[] = {TissueMaterial{}, MetalMaterial{}, GlassMaterial{}, NamedMaterial{"n"}};
    for (const visual::Material& material : before) { // as they were written before there were such fields
        CHECK_THAT(words(material), !Catch::Contains("normalTexture") && !Catch::Contains("overrides"));
        CHECK(roundTrip(SceneMaterial{1, material}).material == material);
    }
    const visual::Material now[] = {
        TissueMaterial{.normalTexture = TextureFile{"n.png"}, .occlusionStrength = 0.5},
        GlassMaterial{.roughnessTexture = TextureFile{"r.png"}},
        NamedMaterial{"n", {{"roughness", 0.2}, {"normalTexture", visual::Texture{TextureFile{"m.png"}}}}}};
    for (const visual::Material& material : now) CHECK(roundTrip(SceneMaterial{1, material}).material == material);
    CHECK(filesOf(SceneMaterial{1, now[0]}) == std::vector<std::string>{"n.png"});
    CHECK(filesOf(SceneMaterial{1, now[2]}) == std::vector<std::string>{"m.png"});
}

TEST_CASE("a file of a scene that is none, or would never end, has no digest")
{
    CHECK_FALSE(digested("/dev/zero"));
    CHECK_FALSE(digested("/tmp"));
    CHECK_FALSE(digested("/nowhere.png"));
}

TEST_CASE("the files that an event names are found, however deep")
{
    CHECK(filesOf(SceneShown{1,
                             BodyId{1},
                             {.material = UnlitMaterial{.texture = TextureFile{"a.png"}},
                              .interior = MetalMaterial{.baseColorTexture = TextureFile{"b.png"}}}}) ==
          std::vector<std::string>{"a.png", "b.png"});
    const CustomMaterial custom{"c.filamat", {{"t", visual::Texture{TextureFile{"t.png"}}}}};
    CHECK(filesOf(SceneStage{.materials = {{"m", custom}}}) == std::vector<std::string>{"c.filamat", "t.png"});
    CHECK(filesOf(SceneUnshown{}).empty());
}

TEST_CASE("an event of a scene that is wrong is refused")
{
    const auto refusal = [](const std::string& words) {
        try {
            eventOf({.words = words});
            return std::string();
        } catch (const Error& problem) {
            return std::string(problem.what());
        }
    };
    CHECK_THAT(refusal("{\"SceneX\":{}}"), Catch::Contains("unknown field 'SceneX'"));
    CHECK_THAT(refusal("{\"SceneUnshown\":{}}"), Catch::Contains("'scene.SceneUnshown.shown' is missing"));
    CHECK_THAT(refusal("{\"SceneUnshown\":{\"shown\":-1}}"), Catch::Contains("must be a whole number"));
    CHECK_THAT(refusal("{"), Catch::Contains("this is not a record"));
}

TEST_CASE("a session is replayed from its file alone, whatever the threads")
{
    const Folder folder;
    Simulation sim({.physics = {.rate = 500}});
    const BodyId body =
        sim.add(SoftBodyDef{.name = "block", .mesh = geometry::shapes::block({0.1, 0.1, 0.1}, {4, 4, 4})});
    sim.show(body);
    const RunReport report = sim.run({.headless = true, .steps = 40, .record = folder / "run.rec"});
    for (const int threads : {1, 2, 8}) {
        const ReplayReport again = replay({.file = folder / "run.rec", .check = true, .threads = threads});
        CHECK(again.hash == report.hash);
        CHECK(again.made == 40);
        CHECK(again.step == 40);
        CHECK(again.time == report.time);
        CHECK((!again.difference && again.damage.empty() && again.unhashed == 0 && again.pictures.empty()));
    }
    std::string bytes = bytesOf(folder / "run.rec");
    std::ofstream(folder / "run.rec", std::ios::binary) << bytes.substr(0, bytes.size() - 1);
    const ReplayReport cut = replay({.file = folder / "run.rec", .check = true});
    CHECK_THAT(cut.damage, Catch::Contains("cut off at byte "));
    CHECK_FALSE(cut.difference);
    CHECK_THROWS_WITH(replay({.file = folder / "no.rec"}), folder / "no.rec" + ": no such file");
    CHECK_THROWS_WITH(replay({.file = folder / "run.rec", .picture = "a.jpg"}),
                      "replay: picture must end in .png, got 'a.jpg'");
}

TEST_CASE("a replay draws what the run has drawn: own lights, materials by name, paint, what is hidden, what is gone")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const Folder folder;
    writeTexture(folder / "red.png", 200);
    Simulation sim({.window = {.width = 200, .height = 150}});
    const BodyId block =
        sim.add(SoftBodyDef{.name = "block", .mesh = geometry::shapes::block({0.06, 0.06, 0.06}, {3, 3, 3})});
    const BodyId plate =
        sim.add(RigidBodyDef{.name = "plate", .mesh = geometry::shapes::box({0.2, 0.01, 0.2}, {2, 1, 2})});
    const BodyId picture = sim.add(RigidBodyDef{.name = "picture", .elements = {Pose{{-0.5, -0.5, -0.2}, {}}}});
    const ShownId hidden = sim.show(plate);
    const ShownId gone = sim.show(plate, {.material = MetalMaterial{}});
    sim.show(picture, {.surface = square(), .material = UnlitMaterial{.texture = TextureFile{folder / "red.png"}}});
    const ShownId shown = sim.show(block);
    sim.paint(block, {.place = {0, 0, 0.03}, .radius = 0.04, .state = {.blood = 1.0}});
    visual::Camera* eye = nullptr;
    sim.dress([&](VisualServer& server) {
        server.addMaterial("gold", MetalMaterial{.baseColor = {0.9, 0.7, 0.2}});
        visual::Transform& rig = server.addTransform("rig");
        rig.setPose(lookAt({0.1, 0.1, 0.25}, {0, 0, 0}));
        eye = &server.add(CameraDef{.exposure = 9.0});
        eye->attachTo(rig);
        server.add(ViewDef{}, *eye);
        visual::Light& lamp = server.add(LightDef{.kind = SpotLight{.intensity = 3.0}});
        lamp.attachTo(rig);
        sim.follow(server.add(LightDef{.kind = visual::PointLight{.intensity = 0.2}}), plate,
                   {.offset = {{0, 0.1, 0}, {}}});
        server.setEnvironment({.intensity = 500.0});
    });
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step == 5) sim.setVisible(hidden, false);
        if (update.step == 7) sim.unshow(gone);
        if (update.step == 9) sim.setMaterial(shown, TissueMaterial{.baseColor = {0.2, 0.5, 0.1}});
        if (update.step == 11) sim.show(plate, {.material = NamedMaterial{"gold"}});
        if (update.step == 13) sim.paint(block, {.place = {0, 0.03, 0}, .radius = 0.03, .state = {.burn = 1.0}});
        if (update.step == 15) sim.physics().setPose(plate, {{0, -0.05, 0}, {}});
        if (update.step == 17) eye->setPose({{0.01, 0.02, 0}, {}});
    });
    sim.run({.headless = true, .steps = 20, .picture = folder / "run.png", .record = folder / "run.rec"});
    const auto again = replay({.file = folder / "run.rec", .check = true, .picture = folder / "again.png"});
    CHECK_FALSE(again.difference);
    CHECK(again.notes.empty());
    CHECK(again.pictures == std::vector<std::string>{folder / "again.png"});
    REQUIRE(bytesOf(folder / "run.png").size() > 1000);
    CHECK(bytesOf(folder / "run.png") == bytesOf(folder / "again.png"));

    // The one file that a recording does not contain: an Error names it if it has changed or is missing.
    writeTexture(folder / "red.png", 100);
    CHECK_THROWS_WITH(replay({.file = folder / "run.rec", .picture = folder / "again.png"}),
                      Catch::Contains("red.png', which the scene needs, has changed: recorded with ") &&
                          Catch::Contains(" bytes, digest ") && Catch::Contains(", now "));
    std::filesystem::remove(folder / "red.png");
    CHECK_THROWS_WITH(replay({.file = folder / "run.rec", .picture = folder / "again.png"}),
                      Catch::Contains("red.png', which the scene needs, is missing: recorded with "));
    CHECK(replay({.file = folder / "run.rec", .check = true}).made == 20); // nothing is drawn
}

TEST_CASE("a replay draws the blood of a duct that leaks as the run has drawn it")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const Folder folder;
    std::vector<Vec3> line;
    for (int i = 0; i <= 20; ++i) line.push_back({1_mm * i - 10_mm, 0, 0});
    /// An artery that is cut after 0.15 s; the number of steps before it leaks.
    const auto bleed = [&](RunDef run) {
        Simulation sim({.physics = {.rate = 500, .gravity = {}}, .window = {.width = 200, .height = 150}});
        SoftBodyDef def{.name = "artery", .mesh = geometry::shapes::vessel(line, 1_mm, 0.8_mm, {8, 1})};
        def.material = FemMaterial{.youngModulus = 40_kPa, .poissonRatio = 0.4};
        def.attachments = {{.box = Box{{-1, -1, -1}, {-9.5_mm, 1, 1}}}, {.box = Box{{9.5_mm, -1, -1}, {1, 1, 1}}}};
        def.dynamicTopology = true;
        const BodyId artery = sim.add(def);
        sim.bleed(artery, {});
        sim.addDuct(artery, {.path = {line.front(), line.back()}, .radius = 1_mm, .inletPressure = 12e3});
        RigidBodyDef knife{.name = "knife", .elements = {{{0.3_mm, 10_mm, 0}, axisAngle({0, 0, 1}, 90_deg)}}};
        knife.collision = {{.mesh = geometry::shapes::sheet(10_mm, 10_mm, {1, 1}), .cutting = true}};
        const BodyId blade = sim.add(knife);
        int steps = 0, whole = 0;
        sim.everyStep([&](double time) {
            const Vec3 place{0.3_mm, 10_mm - std::min(time, 0.2) * 60_mm, 0};
            sim.physics().setPose(blade, {place, axisAngle({0, 0, 1}, 90_deg)});
            ++steps;
            if (sim.duct(artery).state != surface::DuctState::Leaking) whole = steps;
        });
        run.headless = true;
        sim.run(run);
        return whole;
    };
    const int steps = bleed({.backend = Backend::Null, .steps = 180});
    REQUIRE(steps > 50);
    REQUIRE(steps < 150);
    // While what the wounds of the ends would bleed is still seen.
    bleed({.steps = steps + 10, .picture = folder / "run.png", .record = folder / "run.rec"});
    const auto again = replay({.file = folder / "run.rec", .check = true, .picture = folder / "again.png"});
    CHECK_FALSE(again.difference);
    CHECK(bytesOf(folder / "run.png") == bytesOf(folder / "again.png"));
}

} // namespace replay_test

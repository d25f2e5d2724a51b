#include "effort.h"
#include "filasofia/core/error.h"
#include "filasofia/physics/tissue.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace filasofia::scene {
namespace {

const char* const kCube = R"("mesh": {"type": "block", "size": "1 1 1 cm"})";

const physics::SoftBodyDef& softOf(const SceneDef& scene, std::size_t i = 0)
{
    return std::get<physics::SoftBodyDef>(scene.bodies.at(i).def);
}

} // namespace

TEST_CASE("scene files: fields of all kinds are read, and what is missing keeps its default")
{
    const SceneDef scene = SceneFolder().load(R"({
        // comments are allowed /* "even" these */
        "physics": {"rate": "0.5 kHz", "gravity": [0, 0, -1.5], "threads": 2, "contact": "PenaltyContact"},
        "look": {"around": [["-1 cm", 0, 0], "1 2 3 cm"], "quality": "low"},
        "bodies": [{
            "name": "a \"cube\" {", /* a brace in a name,
                                       and a comment of two lines */
            "mesh": {"type": "block", "size": [0.1, "20 mm", 0.3], "cells": [1, 2, 3]},
            "pose": {"position": "1 2 3 mm", "orientation": {"axis": [0, 1, 0], "angle": "90 deg"}},
            "material": {"youngModulus": "3 kPa", "law": {"type": "Ogden", "terms": [{"exponent": 3}]},
                         "tearingThreshold": "infinite"},
            "mass": {"type": "TotalMass", "value": "20 g"},
            "solver": "Cholesky",
            "show": [{"material": {"type": "MetalMaterial", "roughness": 0.25}}]
        }, {
            "type": "RigidBodyDef", "name": "tool", "elements": ["0 1 0 cm", {"position": [1, 2, 3]}],
            "dynamic": true, "mass": {"type": "GivenInertia", "mass": 2},
            "attachments": [{"element": 1, "to": "a \"cube\" {"}]
        }],
        "haptics": [{"body": "tool", "device": {"type": "GamepadDevice", "speed": "5 cm/s"}, "origin": "0 0 1 m"}]
    })");
    CHECK(scene.physics.rate == 500.0);
    CHECK(scene.physics.slack == runtime::PhysicsDef{}.slack);
    CHECK(scene.physics.gravity == Vec3{0, 0, -1.5});
    CHECK(scene.physics.threads == 2);
    CHECK(std::holds_alternative<physics::PenaltyContact>(scene.physics.contact));
    CHECK(scene.look.around == geometry::Box{{-0.01, 0, 0}, {0.01, 0.02, 0.03}});
    CHECK(scene.look.quality == visual::Quality::Low);
    REQUIRE(scene.bodies.size() == 2);
    const physics::SoftBodyDef& cube = softOf(scene);
    CHECK(cube.name == "a \"cube\" {");
    CHECK(scene.bodies[0].places.at("").ends_with("scene.json:5:20"));
    const auto& mesh = *std::get<std::shared_ptr<const geometry::TetMesh>>(cube.mesh);
    CHECK(mesh.tetrahedra.size() == 36);
    CHECK(cube.pose.position == Vec3{1e-3, 2e-3, 3e-3});
    CHECK(cube.pose.orientation == axisAngle({0, 1, 0}, 90.0 * std::numbers::pi / 180.0));
    const auto& fem = std::get<physics::FemMaterial>(cube.material);
    CHECK(fem.youngModulus == 3000.0);
    CHECK(std::get<physics::Ogden>(fem.law).terms.at(0).exponent == 3.0);
    CHECK(std::isinf(fem.tearingThreshold));
    CHECK(std::get<physics::TotalMass>(cube.mass).value == 0.02);
    CHECK(std::holds_alternative<physics::Cholesky>(cube.solver));
    CHECK(std::get<visual::MetalMaterial>(scene.bodies[0].show.at(0).material.value()).roughness == 0.25);
    const auto& tool = std::get<physics::RigidBodyDef>(scene.bodies[1].def);
    CHECK(tool.elements.at(0).position.y == 0.01);
    CHECK(tool.elements.at(1).position == Vec3{1, 2, 3});
    CHECK(tool.attachments.at(0).to == BodyId{1});
    CHECK(scene.haptics.at(0).body == BodyId{2});
    CHECK(std::get<device::GamepadDevice>(scene.haptics[0].device).speed == 0.05);
    CHECK(scene.haptics[0].origin->position.z == 1.0);
}

TEST_CASE("scene files: a material may begin with a tissue of the library")
{
    const auto cube = text(R"({"bodies": [{)", kCube, R"(, "material": {"tissue": "liver", "poissonRatio": 0.3}}]})");
    const SceneDef scene = SceneFolder().load(cube);
    const auto& fem = std::get<physics::FemMaterial>(softOf(scene).material);
    const physics::FemMaterial& liver = physics::tissue("liver").material;
    CHECK(fem.youngModulus == liver.youngModulus);
    CHECK(fem.relaxation == liver.relaxation);
    CHECK(fem.poissonRatio == 0.3);
    const auto densityOf = [](const std::string& rest) {
        const auto lung = text(R"({"bodies": [{)", kCube, R"(, "material": {"tissue": "lung"})", rest, "}]}");
        return std::get<physics::Density>(softOf(SceneFolder().load(lung)).mass).value;
    };
    CHECK(densityOf("") == physics::tissue("lung").density);
    CHECK(densityOf(R"(, "mass": {"value": 7})") == 7.0);
}

TEST_CASE("scene files: defaults and classes stand behind what an object says itself")
{
    const SceneDef scene = SceneFolder().load(text(R"({
        "defaults": {"SoftBodyDef": {"friction": 0.1, "material": {"youngModulus": "1 kPa", "poissonRatio": 0.2}},
                     "FemMaterial": {"poissonRatio": 0.4, "yieldStress": "5 kPa"}},
        "classes": {"hard": {"SoftBodyDef": {"material": {"youngModulus": "9 kPa"}, "collision": [{"selfOnceCut": null}, {"selfOnceCut": false}]}},
                    "springs": {"SoftBodyDef": {"material": {"type": "MassSpringMaterial", "stiffness": 7}}}},
        "bodies": [
            {"name": "plain", )",
                                                   kCube, R"(},
            {"name": "hard", "class": "hard", "friction": 0.9, )",
                                                   kCube, R"(},
            {"name": "own", "class": "hard", "material": {"youngModulus": 5}, "collision": [], )",
                                                   kCube, R"(},
            {"name": "springs", "class": "springs", "material": {"damping": 2}, )",
                                                   kCube, R"(}
        ]})"));
    const auto fem = [&](std::size_t i) { return std::get<physics::FemMaterial>(softOf(scene, i).material); };
    CHECK(softOf(scene, 0).friction == 0.1);
    CHECK(fem(0).youngModulus == 1000.0);
    CHECK(fem(0).poissonRatio == 0.2); // the body's default is nearer than the material's
    CHECK(fem(0).yieldStress == 5000.0);
    CHECK(softOf(scene, 1).friction == 0.9);
    CHECK(fem(1).youngModulus == 9000.0);
    CHECK(fem(1).poissonRatio == 0.2);
    CHECK(softOf(scene, 1).collision.size() == 2);
    CHECK_FALSE(softOf(scene, 1).collision[0].selfOnceCut.has_value());
    CHECK(softOf(scene, 1).collision[1].selfOnceCut == false);
    CHECK(fem(2).youngModulus == 5.0);
    CHECK(softOf(scene, 2).collision.empty());
    const auto springs = std::get<physics::MassSpringMaterial>(softOf(scene, 3).material);
    CHECK(springs.stiffness == 7.0);
    CHECK(springs.damping == 2.0);
}

TEST_CASE("scene files: defaults reach what no file mentions, and a class all that is in its object")
{
    const SceneDef scene = SceneFolder().load(text(R"({
        "defaults": {"FemMaterial": {"youngModulus": 10}, "ConjugateGradient": {"tolerance": 0.1},
                     "SoftBodyDef": {"material": {"poissonRatio": 0.1}}, "PhysicsDef": {"rate": 300},
                     "PenaltyContact": {"stiffness": 5}, "block": {"cells": [1, 1, 1]}},
        "classes": {"soft": {"FemMaterial": {"youngModulus": 20, "poissonRatio": 0.2}},
                    "softer": {"FemMaterial": {"youngModulus": 30}}},
        "bodies": [
            {"name": "plain", )",
                                                   kCube, R"(},
            {"name": "soft", "class": "soft", "solver": "ConjugateGradient", )",
                                                   kCube, R"(},
            {"name": "softer", "class": "soft", "material": {"class": "softer"}, )",
                                                   kCube, R"(},
            {"name": "other", "solver": "Cholesky", )",
                                                   kCube, R"(}
        ]})"));
    const auto fem = [&](std::size_t i) { return std::get<physics::FemMaterial>(softOf(scene, i).material); };
    const auto tolerance = [&](std::size_t i) {
        return std::get<physics::ConjugateGradient>(softOf(scene, i).solver).tolerance;
    };
    CHECK(scene.physics.rate == 300.0);
    CHECK(std::holds_alternative<physics::ExactContact>(scene.physics.contact)); // defaults choose no alternative
    CHECK(fem(0).youngModulus == 10.0);
    CHECK(fem(0).poissonRatio == 0.1);
    CHECK(tolerance(0) == 0.1);
    CHECK(std::get<std::shared_ptr<const geometry::TetMesh>>(softOf(scene, 0).mesh)->tetrahedra.size() == 6);
    CHECK(fem(1).youngModulus == 20.0);
    CHECK(fem(1).poissonRatio == 0.2); // a class comes before all defaults
    CHECK(tolerance(1) == 0.1);
    CHECK(fem(2).youngModulus == 30.0); // an inner class comes before an outer one
    CHECK(fem(2).poissonRatio == 0.2);
    CHECK(std::holds_alternative<physics::Cholesky>(softOf(scene, 3).solver));
}

TEST_CASE("scene files: an included file's bodies come first, and the file that includes it has the last word")
{
    const SceneFolder folder;
    folder.write("rooms/theatre.json", text(R"({"physics": {"rate": 250, "slack": "1 ms"}, "include": ["base.json"],
        "classes": {"c": {"SoftBodyDef": {"friction": 0.7}}}, "bodies": [{"name": "table", )",
                                            kCube, "}]}"));
    folder.write("rooms/base.json", text(R"({"bodies": [{"name": "floor", )", kCube, "}]}"));
    const SceneDef scene = folder.load(text(R"({"include": ["rooms/theatre.json", "rooms/base.json"],
        "physics": {"rate": 500}, "bodies": [{"name": "organ", "class": "c", "attachments": [{"to": "table"}], )",
                                            kCube, "}]}"));
    CHECK(scene.physics.rate == 500.0);
    CHECK(scene.physics.slack == 1e-3);
    REQUIRE(scene.bodies.size() == 3); // the floor once
    CHECK(softOf(scene, 0).name == "floor");
    CHECK(softOf(scene, 2).friction == 0.7);
    CHECK(softOf(scene, 2).attachments.at(0).to == BodyId{2});

    folder.write("a.json", R"({"include": ["b.json"]})");
    folder.write("b.json", R"({"include": ["a.json"]})");
    CHECK_THROWS_WITH(folder.load(R"({"include": ["a.json"]})"), Catch::Contains("must not be a file that includes"));
    CHECK_THROWS_WITH(folder.load(R"({"include": ["scene.json"]})"), Catch::Contains("scene.json:1:14"));
}

TEST_CASE("scene files: every mistake is one line with its place, its bound and its value")
{
    const SceneFolder folder;
    const auto body = [](const std::string& rest) { return text("{\"bodies\": [\n{", kCube, rest, "}]}"); };
    CHECK(folder.errorOf(body(R"(, "frction": 1)")) ==
          "scene.json:2:60: unknown field 'frction' in bodies[0], a SoftBodyDef (did you mean 'friction'?)");
    CHECK(folder.errorOf(body(R"(, "totalMass": 0.15)")) ==
          "scene.json:2:62: unknown field 'totalMass' in bodies[0], a SoftBodyDef (did you mean 'mass'?)");
    CHECK(folder.errorOf(body(R"(, "friction": -1)")) == "scene.json:2:61: bodies[0].friction must be >= 0, got -1");
    CHECK(folder.errorOf(body(R"(, "pressure": "5 mm")")) ==
          "scene.json:2:61: bodies[0].pressure must be in Pa or a unit like it, got \"5 mm\"");
    CHECK(folder.errorOf(body(R"(, "friction": "5 mm")")) ==
          "scene.json:2:61: bodies[0].friction must be a number without a unit, got \"5 mm\"");
    const auto contains = [&](const std::string& scene, const std::string& part) {
        const std::string error = folder.errorOf(scene);
        INFO(scene);
        CHECK_THAT(error, Catch::Contains(part));
        CHECK(error.find('\n') == std::string::npos);
        CHECK(error.size() < 400);
    };
    contains(body(R"(, "friction": "much")"), "friction must be a number, such as 0.01, got \"much\"");
    contains(body(R"(, "pressure": "much")"), "must be a number, such as 0.01 or \"0.01 Pa\", got \"much\"");
    contains(R"({"physics": {"rate": "much"}})", "must be a number, such as 1 or \"1 Hz\", got \"much\"");
    contains(R"({"bodies": [{"mesh": {"type": "tetrahedra", "file": "a.msh", "scale": "mm"}}]})",
             "scale must be a number, such as 0.01, got \"mm\"");
    contains(body(R"(, "mass": {"type": "TotalMass", "mass": 1})"),
             "unknown field 'mass' in bodies[0].mass, a TotalMass (it has ");
    contains(R"({"commands": [{"type": "SetTissue", "time": 0, "id": "a", "restScale": 1}]})",
             "unknown field 'restScale' in commands[0], a SetTissue (it has id, region, factors, type, class, time)");
    contains(body(R"(, "friction": true)"), "bodies[0].friction must be a number, got true");
    contains(body(R"(, "gravity": 1)"), "bodies[0].gravity must be true or false, got 1");
    contains(body(R"(, "name": 1)"), "bodies[0].name must be a text, got 1");
    contains(body(R"(, "pose": "1 2 mm")"), "bodies[0].pose must be 3 numbers, got \"1 2 mm\"");
    contains(body(R"(, "pose": {"orientation": {"axis": [1, 0, 0]}})"), "or have an axis and an angle");
    contains(body(R"(, "solver": "Colesky")"), "must be one of ConjugateGradient, Cholesky, got \"Colesky\" (did you");
    contains(body(R"(, "material": {"type": 1})"), "bodies[0].material.type must be a text");
    contains(body(R"(, "material": [1])"), "bodies[0].material must be an object, one of FemMaterial, ");
    contains(body(R"(, "material": {"tissue": "livr"})"), "(did you mean 'liver'?)");
    contains(body(R"(, "material": {"stiffness": 1})"), "'stiffness' in bodies[0].material, a FemMaterial");
    contains(body(R"(, "attachments": [{"to": "nobody"}])"), "must be the name of a body before this one");
    contains(R"({"cameras": [{"follow": {"body": "livr"}}], "bodies": [{"type": "RigidBodyDef", "name": "liver"}]})",
             "follow.body must be the name of a body of the scene, got \"livr\" (did you mean 'liver'?)");
    contains(R"({"commands": [{"time": 1, "type": "SetPressure", "id": "x"}]})",
             "id must be the name of a body of the scene, got");
    contains(body(R"(, "attachments": {})"), "bodies[0].attachments must be a list, got an object");
    contains(body(R"(, "collision": [{"element": 0.5}])"), "collision[0].element must be a whole number, got 0.5");
    contains(body(R"(, "collision": [{"group": 1e12}])"), "collision[0].group must be in [-2147483648, 2147483647]");
    contains(body(R"(, "material": "liver")"), "got \"liver\" (did you mean {\"tissue\": \"liver\"}?)");
    contains(body(R"(, "material": {"youngModulus": "infinite"})"), "must be > 0 Pa and finite, got \"infinite\"");
    contains(body(R"(, "pressure": "5 kpa")"), "or a unit like it, got \"5 kpa\" (did you mean 'kPa'?)");
    contains(body(R"(, "pressure": "5,1 kPa")"), "must be written without commas, such as");
    contains(body(R"(, "pose": "0, 1, 0 mm")"), "bodies[0].pose must be 3 numbers without commas");
    contains(body(R"(, "pose": {"orientation": {"axis": [0, 0, 0], "angle": 1}})"), "axis must have a length > 0");
    contains(body(R"(, "attachments": [{"box": [[1, 0, 0], [0, 1, 1]]}])"), "must have a lower corner that is <=");
    contains(body(R"(, "name": "a", "attachments": [{"to": "a"}])"), "got \"a\", which is this one or comes later");
    contains(R"({"look": {"direction": [0, 0, 0]}})", "1:10: look must have a direction with a length > 0");
    contains(R"({"bodies": [{"type": "RigidBodyDef", "motions": [{"keys": [{"time": 1}]}]}]})",
             "bodies[0].motions[0].keys[0] must have the member 'pose' (KeyPose)");
    contains(
        R"({"bodies": [{"type": "RigidBodyDef", "motions": [{"keys": [{"pose": {"orientation": [1, 0, 0, 0]}}]}]}]})",
        "keys[0].pose must have the member 'position' (KeyPose)");
    contains(R"({"defaults": {"SoftBodyDef": {"type": "RigidBodyDef"}}})", "type must be SoftBodyDef, if it is given");
    contains(R"({"defaults": {"SoftBodyDef": {"class": "a"}}})", "class must not be given");
    contains(text(R"({"classes": {"a": {"RigidBodyDef": {}}}, "bodies": [{"class": "a", )", kCube, "}]}"),
             "class must be a class that says something of this object, or of one in it");
    contains(body(R"(, "class": "x")"), "must be a class of the scene, which has none, got \"x\"");
    contains(R"({"bodies": [{"mesh": {"size": [1, 1, 1]}}]})", "mesh must have a type");
    contains(R"({"bodies": [{"mesh": {"type": "block", "size": "1 1 0 m"}}]})", "bodies[0].mesh.size[2] must be > 0 m");
    contains(R"({"bodies": [{"mesh": {"type": "block"}}]})",
             "scene.json:1:22: bodies[0].mesh must have the member 'size' (block)");
    contains(R"({"bodies": [{"mesh": "no.msh"}]})", "mesh must be a file that exists, got \"no.msh\"");
    contains(R"({"bodies": [{"mesh": "asset:no.msh"}]})", "scene.json:1:22: bodies[0].mesh: ");
    contains(text(R"({"bodies": [{"name": "a", )", kCube, R"(}, {"name": "a", )", kCube, "}]}"),
             "bodies[1].name must differ from those of the other bodies, got 'a'");
    contains(R"({"physics": {"rate": 0}})", "physics.rate must be in [1, 100000] Hz, got 0");
    contains(R"({"physcs": {}})", "unknown field 'physcs' in the scene (did you mean 'physics'?)");
    contains(R"({"physics": {}, "look": {"rate": 5}, "physics" /* again */ : {}})",
             "scene.json:1:38: \"physics\" is given twice");
    contains(text(R"({"defaults": {"SoftBodyDef": {"solver": {"type": "Colesky"}}}, "bodies": [{)", kCube,
                  R"(, "solver": {"tolerance": 0.1}}]})"),
             "scene.json:1:50: bodies[0].solver.type must be one of ConjugateGradient, Cholesky, got \"Colesky\"");
    contains(R"({"defaults": {"SoftBodyDf": {}}})", "(did you mean 'SoftBodyDef'?)");
    contains(R"({"defaults": {"SoftBodyDef": {"frction": 1}}})", "scene.json:1:42: unknown field 'frction'");
    contains(R"({"classes": {"a": {"SoftBodyDef": 5}}})", "classes.a.SoftBodyDef must be an object, got 5");
    contains("[]", "scene.json:1:1: the scene must be an object");
    contains("{\n\"physics\": {,}}", "scene.json:2:13: this is no JSON: ");
    contains("{\"physics\": {\"rate\": 5, }}", "scene.json:1:25: there must be no comma before '}'");
    contains(" \n", "the file is empty");
    contains("{\"physics\": {\"rate\": 1e999}}", "scene.json:1:22: this is no JSON: number overflow parsing '1e999'");
    contains(std::string("// a\0 88\0 b\n\"c", 14), "scene.json:1:5: this is no JSON: there is a byte of value 0");
    CHECK(folder.load("{} // a comment that a carriage return ends\r// {\r").bodies.empty());
    contains(std::string(100000, '['), "this is no JSON");
    contains(std::string(1000, '[') + std::string(1000, ']'),
             "scene.json:1:66: lists and objects must be nested at most");
    CHECK_THROWS_WITH(loadScene("no_such_scene.json"), Catch::Contains("no_such_scene.json"));
}

TEST_CASE("scene files: a scene reads no file outside its folder unless that is allowed")
{
    const SceneFolder folder, other;
    const std::string secret = other.write("secret.msh", "x");
    const auto refused = Catch::Contains("must be a file in the folder of the scene");
    const auto scene = [&](const std::string& name) {
        return folder.write("scene.json", text(R"({"bodies": [{"mesh": ")", name, R"("}]})"));
    };
    CHECK_THROWS_WITH(loadScene(scene(secret)), refused);
    const auto sideways =
        std::filesystem::path("..") / std::filesystem::path(secret).parent_path().filename() / "secret.msh";
    CHECK_THROWS_WITH(loadScene(scene(sideways.string())), refused);
    std::filesystem::create_symlink(secret, std::filesystem::path(scene("x")).parent_path() / "link.msh");
    CHECK_THROWS_WITH(loadScene(scene("link.msh")), refused);
    CHECK_THROWS_WITH(loadScene(scene("../\u809d.msh")), Catch::Contains("got \"../\u809d.msh\"")); // as it was written
    CHECK_THROWS_WITH(loadScene(scene("asset:../../etc/passwd")), Catch::Contains("must be a file that comes with"));
    const std::string zero = scene("a\\u0000b");
    for (const bool anyFolder : {false, true})
        CHECK_THROWS_WITH(
            loadScene(zero, {.anyFolder = anyFolder}),
            Catch::Contains("1:22: bodies[0].mesh must be the name of a file, without a byte of value 0"));
    CHECK_THROWS_WITH(loadScene(std::string("a\0.json", 7)), "a .json: a file name must not have a byte of value 0");
    CHECK(std::get<std::string>(softOf(loadScene(scene(secret), {.anyFolder = true})).mesh) == secret);
}

TEST_CASE("scene files: damaged files are refused or read, and nothing else", "[cases]")
{
    const SceneFolder folder;
    std::mt19937 random(5);
    for (const char* name : {"bunny", "friction", "jaws", "poke"}) {
        std::ifstream file(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/", name, ".json"));
        const std::string whole((std::istreambuf_iterator<char>(file)), {});
        REQUIRE(!whole.empty());
        int refused = 0;
        const int all = cases(500);
        for (int i = 0; i < all; ++i) {
            std::string scene = whole;
            for (unsigned k = 0; k <= random() % 3; ++k) {
                const std::size_t at = random() % scene.size(), from = random() % scene.size();
                if (random() % 2 == 0)
                    scene[at] = "{}[]\",:/*0-e. x\n"[random() % 16];
                else
                    scene.replace(at, random() % 8, scene.substr(from, random() % 24));
            }
            try {
                (void)folder.load(scene);
            } catch (const Error&) {
                ++refused;
            }
        }
        INFO(name);
        CHECK(refused > all / 2);
    }
}

TEST_CASE("scene files: a texture is the name of its file, or an object with a type")
{
    const SceneFolder folder;
    folder.write("skin.png", "a picture");
    const auto shown = [&](const std::string& texture) {
        return R"({"bodies": [{"type": "RigidBodyDef", "name": "a", "show": [{"material":
{"type": "MucosaMaterial", "baseColorTexture": )" +
               texture + "}}]}]}";
    };
    const auto textureOf = [](const SceneDef& scene) {
        const auto& material = std::get<visual::MucosaMaterial>(scene.bodies.at(0).show.at(0).material.value());
        return std::get<visual::TextureFile>(material.baseColorTexture).file;
    };
    const std::string file = textureOf(folder.load(shown(R"({"type": "TextureFile", "file": "skin.png"})")));
    CHECK_THAT(file, Catch::EndsWith("skin.png"));
    CHECK(textureOf(folder.load(shown(R"("skin.png")"))) == file);
    CHECK_THAT(folder.errorOf(shown(R"("skim.png")")),
               Catch::Contains("scene.json:2:48: ") && Catch::Contains("skim.png"));
    CHECK_THAT(folder.errorOf(shown(R"("skin")")), Catch::Contains("must be one of NoTexture, TextureFile"));
}

TEST_CASE("scene files: the defaults in the schema are those of a reader")
{
    const auto defs = nlohmann::json::parse(sceneSchema()).at("$defs");
    const auto propertiesOf = [&](const std::string& type) -> const nlohmann::json& {
        if (!defs.contains(type) || !defs.at(type).contains("properties"))
            for (const auto& each : defs.at("SceneBody").at("anyOf"))
                if (each.at("properties").at("type").at("const") == type) return each.at("properties");
        return defs.at(type).at("properties");
    };
    nlohmann::json scene = {{"physics", nlohmann::json::object()},
                            {"window", nlohmann::json::object()},
                            {"look", nlohmann::json::object()},
                            {"smoke", {{"room", {{0, 0, 0}, {1, 1, 1}}}}},
                            {"bodies",
                             {{{"type", "SoftBodyDef"},
                               {"name", "liver"},
                               {"mesh", {{"type", "block"}, {"size", {0.1, 0.1, 0.1}}}},
                               {"material", {{"type", "FemMaterial"}, {"law", {{"type", "NeoHookean"}}}}},
                               {"collision", {nlohmann::json::object()}},
                               {"attachments", {{{"nodes", {0}}}}}},
                              {{"type", "RigidBodyDef"},
                               {"name", "tool"},
                               {"mesh", {{"type", "sphere"}, {"radius", 0.01}}},
                               {"collision", {nlohmann::json::object()}}},
                              {{"type", "RodBodyDef"}, {"name", "thread"}, {"points", {{0, 0, 0}, {0, 0, 1}}}}}}};
    const SceneFolder folder;
    const auto saved = [&] {
        saveScene(folder.load(scene.dump()), folder.file("saved.json"), {.overwrite = true});
        std::ifstream file(folder.file("saved.json"));
        return std::string((std::istreambuf_iterator<char>(file)), {});
    };
    const std::string before = saved();
    int filled = 0;
    const auto fill = [&](nlohmann::json& object, const std::string& type) {
        for (const auto& [name, property] : propertiesOf(type).items())
            if (property.contains("default") && !object.contains(name)) {
                object[name] = property.at("default");
                ++filled;
            }
    };
    fill(scene["physics"], "PhysicsDef");
    fill(scene["window"], "WindowDef");
    fill(scene["look"], "LookDef");
    fill(scene["smoke"], "SmokeDef");
    for (auto& body : scene["bodies"]) fill(body, body.at("type"));
    fill(scene["bodies"][0]["material"], "FemMaterial");
    fill(scene["bodies"][0]["collision"][0], "CollisionDef");
    fill(scene["bodies"][1]["collision"][0], "CollisionDef");
    fill(scene["bodies"][0]["attachments"][0], "AttachmentDef");
    CHECK(filled > 60);
    CHECK(saved() == before); // a writer leaves out what equals its default
}

TEST_CASE("scene files: the schema that comes with Filasofia is that of the Defs")
{
    const std::string schema = sceneSchema();
    std::ifstream file(FILASOFIA_SOURCE_DIR "/assets/scene.schema.json");
    const std::string written((std::istreambuf_iterator<char>(file)), {});
    CHECK(written == schema + "\n"); // filasofia schema > assets/scene.schema.json
    const auto json = nlohmann::json::parse(schema);
    const auto& defs = json.at("$defs");
    for (const auto& def : defs) {
        const auto properties = def.find("properties");
        if (properties == def.end()) continue; // a body has two lists of them
        for (const auto& property : *properties)
            if (const auto found = property.find("$ref"); found != property.end())
                CHECK(defs.contains(found->get<std::string>().substr(std::string("#/$defs/").size())));
    }
}

} // namespace filasofia::scene

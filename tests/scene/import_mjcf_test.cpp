#include "filasofia/filasofia.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/scene/import.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace filasofia::scene {
namespace import_mjcf_test {

using Catch::Matchers::Contains;

Imported mjcf(const std::string& inside, const ImportOptions& options = {})
{
    const SceneFolder folder;
    return loadMjcf(folder.write("model.xml", "<mujoco>\n" + inside + "\n</mujoco>\n"), options);
}
Imported world(const std::string& inside) { return mjcf("<worldbody>\n" + inside + "\n</worldbody>"); }

std::string errorOf(const std::string& inside, const ImportOptions& options = {})
{
    try {
        mjcf(inside, options);
    } catch (const Error& error) {
        const std::string line = error.what();
        const auto at = line.find("model.xml");
        return at == std::string::npos ? line : line.substr(at);
    }
    return "no error";
}
std::string worldError(const std::string& inside) { return errorOf("<worldbody>\n" + inside + "\n</worldbody>"); }

const RigidBodyDef& rigid(const Imported& imported, std::size_t body)
{
    return std::get<RigidBodyDef>(imported.scene.bodies.at(body).def);
}
bool near(Vec3 a, Vec3 b) { return length(a - b) < 1e-12; }

std::vector<std::string> told(const Imported& imported)
{
    std::vector<std::string> all;
    for (const std::string& note : imported.notes) all.push_back(note.substr(note.find("model.xml")));
    return all;
}

TEST_CASE("MJCF: a body falls onto the plane with the time step and the gravity of the option")
{
    const Imported imported = mjcf(R"(<option timestep="0.001" gravity="0 0 -5"/><worldbody>
<geom type="plane" size="0 0 1"/><body name="ball" pos="0 0 0.2"><freejoint/><geom size="0.05" mass="0.3"/></body></worldbody>)");
    CHECK(imported.scene.physics.rate == 1000);
    CHECK(near(imported.scene.physics.gravity, {0, -5, 0}));
    CHECK(std::get<GivenInertia>(rigid(imported, 1).mass).moments.x == Approx(0.4 * 0.3 * 0.05 * 0.05));
    Simulation sim(simulationDef(imported.scene));
    const BodyId ball = addScene(sim, imported.scene).bodies.at(1);
    sim.run({.headless = true, .steps = 200});
    CHECK(sim.physics().latest()->rigidBody(ball)->poses[0].position.y ==
          Approx(0.2 - 0.5 * 5 * 0.2 * 0.2).margin(1e-3));
    sim.run({.headless = true, .steps = 800});
    CHECK(sim.physics().latest()->rigidBody(ball)->poses[0].position.y == Approx(0.05).margin(1e-3));
}

TEST_CASE("MJCF: joints in a body stand one behind the other, limits are in degrees, and nothing drives them")
{
    const Imported imported = world(R"(
<body name="arm" pos="1 0 0"><joint name="a" axis="0 1 0" range="-90 45"/><joint name="b" type="slide" pos="0 0 0.1" range="-1 2"/>
  <geom type="capsule" size="0.01" fromto="0 0 0 0.2 0 0"/>
  <body name="fixed" pos="0.2 0 0"><geom type="box" size="0.02 0.02 0.02"/>
    <body><joint name="c" ref="30" damping="2" frictionloss="0.5" armature="0.1"/><geom size="0.01"/></body></body></body>)");
    REQUIRE(imported.joints == std::vector<std::vector<std::string>>{{"a", "b", "c"}});
    const auto& joints = rigid(imported, 0).articulation.joints;
    CHECK(joints[0].lower == Approx(-90_deg));
    CHECK((joints[1].kind == JointKind::Prismatic && joints[1].upper == 2));
    CHECK(joints[0].mass->mass < 1e-5 * joints[1].mass->mass); // the body hangs on its last joint
    CHECK(joints[1].mass->mass == Approx(1000 * (3.14159265 * 1e-4 * (0.2 + 0.04 / 3) + 0.04 * 0.04 * 0.04)));
    CHECK(joints[2].parent == 2); // what is fixed to a body is part of it
    CHECK(near(joints[2].parentOffset.position, {0.2, 0, 0}));
    CHECK((joints[2].damping == 2 && joints[2].friction == 0.5 && joints[2].inertia == 0.1));
    CHECK(joints[2].start == Approx(30_deg));
    CHECK(std::isinf(joints[2].upper));
    for (const JointDef& each : joints) CHECK(std::holds_alternative<JointForce>(*each.command));
    const std::vector<Pose> poses = physics::elementPoses(rigid(imported, 0));
    CHECK(near(poses[3].position, {1.2, 0, 0})); // at its reference the joint is where the file has it
    CHECK(std::abs(poses[3].orientation.w) == Approx(std::sqrt(0.5)));
    // With several joints in a body, it and its parent are not neighbours, and would touch all the time.
    CHECK_FALSE(rigid(imported, 0).collision[0].self);
    CHECK(imported.notes.at(0).ends_with("links do not touch each other if one of them has several joints"));
}

TEST_CASE("MJCF: orientations by quat, axisangle, euler, xyaxes and zaxis")
{
    const auto turned = [](const std::string& compiler, const std::string& says) {
        const Imported imported =
            mjcf(compiler + "<worldbody><body name=\"b\" " + says + "><geom size=\"1\"/></body></worldbody>");
        const Quat toUp = {std::sqrt(0.5), std::sqrt(0.5), 0, 0}; // back to z up
        return toMat3(toUp * rigid(imported, 0).elements[0].orientation);
    };
    const auto same = [](const Mat3& a, const Mat3& b) {
        return length(a[0] - b[0]) + length(a[1] - b[1]) + length(a[2] - b[2]) < 1e-9;
    };
    const Mat3 aboutZ{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
    CHECK(same(turned("", "quat=\"2 0 0 2\""), aboutZ));
    CHECK(same(turned("", "axisangle=\"0 0 3 90\""), aboutZ));
    CHECK(same(turned("<compiler angle=\"radian\"/>", "axisangle=\"0 0 3 1.5707963267948966\""), aboutZ));
    CHECK(same(turned("", "xyaxes=\"0 1 0 -1 1 0\""), aboutZ));
    CHECK(same(turned("", "zaxis=\"1 0 0\""), {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}}));
    const Mat3 x = toMat3(axisAngle({1, 0, 0}, 20_deg)), y = toMat3(axisAngle({0, 1, 0}, 30_deg)),
               z = toMat3(axisAngle({0, 0, 1}, 40_deg));
    CHECK(same(turned("", "euler=\"20 30 40\""), x * y * z));
    CHECK(same(turned("<compiler eulerseq=\"XYZ\"/>", "euler=\"20 30 40\""), z * y * x));
    CHECK(same(turned("<compiler eulerseq=\"zyx\"/>", "euler=\"40 30 20\""), z * y * x));
}

TEST_CASE("MJCF: classes inherit, childclass counts for what is inside, and what an element says comes first")
{
    const Imported imported = mjcf(R"(
<default><geom size="0.1" friction="0.5"/><joint damping="7"/>
  <default class="soft"><geom friction="0.2"/><default class="softer"><joint damping="1"/></default></default></default>
<worldbody><body name="a" childclass="softer"><freejoint/><geom/>
  <body><joint/><geom size="0.2"/></body><body><joint class="main"/><geom class="soft" friction="0.9"/></body></body>
</worldbody>)");
    const RigidBodyDef& body = rigid(imported, 0);
    CHECK(body.articulation.joints[0].damping == 1);
    CHECK(body.articulation.joints[1].damping == 7);
    CHECK(body.friction == 0.9); // the largest one of its geoms
    const auto size = [&](std::size_t i) {
        return geometry::boxAround(
                   std::get<std::shared_ptr<const geometry::TriangleMesh>>(body.collision[i].mesh)->vertices)
            .high.x;
    };
    CHECK(size(0) == Approx(0.1));
    CHECK(size(1) == Approx(0.2));
    CHECK(body.collision[0].self);
    CHECK(
        errorOf(
            "<default><default class=\"soft\"/></default><worldbody><geom class=\"softr\" size=\"1\"/></worldbody>") ==
        "model.xml:2:55: mujoco/worldbody/geom.class must be a class, got 'softr' (did you mean 'soft'?)");
}

TEST_CASE("MJCF: a mesh may be in the model itself, by its vertices and faces or as the hull of its vertices")
{
    const auto massOf = [](const std::string& mesh) {
        const Imported imported = mjcf("<asset><mesh name=\"m\" " + mesh + R"(/></asset><worldbody><body><freejoint/>
<geom type="mesh" mesh="m" density="600"/></body></worldbody>)");
        return std::get<GivenInertia>(rigid(imported, 0).mass).mass;
    };
    const std::string vertices = "vertex=\"0 0 0  1 0 0  0 1 0  0 0 1\"";
    CHECK(massOf(vertices) == Approx(100.0));
    CHECK(massOf(vertices + " face=\"0 2 1  0 1 3  0 3 2  1 2 3\"") == Approx(100.0));
    CHECK(massOf("scale=\"2 1 1\" vertex=\"0 0 0  1 0 0  0 1 0  0 0 1  .1 .1 .1  .2 .2 0\"") == Approx(200.0));
    const auto error = [](const std::string& mesh) {
        return errorOf("<asset>\n<mesh name=\"m\" " + mesh +
                       "/>\n</asset><worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody>");
    };
    CHECK_THAT(error(""), Catch::Contains("model.xml:3:2: mujoco/asset/mesh 'm' must say its file or its vertices"));
    CHECK_THAT(error("vertex=\"0 0 0 1 0 0 0 1 0 0 0 1 2\""), Catch::Contains("must be three numbers per vertex"));
    CHECK_THAT(error("vertex=\"0 0 0 1 0 0 0 1 0 1 1 0\""), Catch::Contains("must not lie in a plane"));
    CHECK_THAT(error(vertices + " face=\"0 1 4\""), Catch::Contains("face must be in [0, 3]"));
    CHECK_THAT(error(vertices + " face=\"0 1 1\""), Catch::Contains("names a vertex twice"));
    CHECK_THAT(error(vertices + " face=\"0 1\""), Catch::Contains("must be three vertices per face"));
}

TEST_CASE("MJCF: shapes weigh what they do, by density, by mass, and as a mesh")
{
    const auto inertia = [](const std::string& geom) {
        return std::get<GivenInertia>(rigid(world("<body><freejoint/><geom " + geom + "/></body>"), 0).mass);
    };
    const double pi = 3.141592653589793;
    CHECK(inertia("type=\"box\" size=\"0.1 0.2 0.3\" mass=\"3\"").moments.x == Approx(3.0 / 3 * (0.04 + 0.09)));
    CHECK(inertia("type=\"cylinder\" size=\"0.1 0.2\"").mass == Approx(1000 * pi * 0.01 * 0.4));
    CHECK(inertia("type=\"cylinder\" size=\"0.1 0.2\" mass=\"12\"").moments.x == Approx(3 * 0.01 + 0.16));
    CHECK(inertia("type=\"ellipsoid\" size=\"0.1 0.2 0.3\" mass=\"5\"").moments.z == Approx(0.01 + 0.04));
    // A capsule without length is a ball, a long one without a radius a rod.
    CHECK(inertia("type=\"capsule\" size=\"0.1 1e-6\" mass=\"5\"").moments.x == Approx(2 * 0.01).epsilon(1e-4));
    CHECK(inertia("type=\"capsule\" size=\"1e-5 0.3\" mass=\"3\"").moments.x == Approx(0.09).epsilon(1e-3));
    const auto fine = geometry::massProperties(*geometry::shapes::capsule(0.1, 0.4, 100), "capsule");
    CHECK(inertia("type=\"capsule\" size=\"0.1 0.2\" density=\"1\"").moments.x ==
          Approx(fine.inertia[0].x).epsilon(1e-3));
    CHECK(inertia("type=\"capsule\" size=\"0.1 0.2\" density=\"1\"").moments.z ==
          Approx(fine.inertia[1].y).epsilon(1e-3));
}

TEST_CASE("MJCF: actuators drive joints, cameras and lights are the picture's, contact bits are groups")
{
    const Imported imported = mjcf(
        R"(<worldbody><light directional="true" dir="1 0 -1"/><camera name="eye" pos="0 -1 0" xyaxes="1 0 0 0 0 1" fovy="60"/>
<body><joint name="a"/><geom size="0.1" contype="4" conaffinity="4"/><geom size="0.2" contype="0" conaffinity="0" group="3"/>
<body><joint name="b"/><geom size="0.1"/></body></body></worldbody>
<actuator><position joint="a" kp="3" kv="0.2" forcerange="-4 5"/><motor joint="b"/><velocity joint="b"/></actuator>)");
    const auto& body = rigid(imported, 0);
    const auto& spring = std::get<JointSpring>(*body.articulation.joints[0].command);
    CHECK((spring.value == 0.0 && spring.stiffness == 3.0 && spring.damping == 0.2 && spring.strength == 5.0));
    CHECK(std::holds_alternative<JointForce>(*body.articulation.joints[1].command));
    const std::vector<std::string> notes = told(imported);
    CHECK(notes.size() == 2);
    CHECK(notes[0].ends_with("forcerange is read as the larger of its two forces, in both directions"));
    REQUIRE(body.collision.size() == 2);
    CHECK((body.collision[0].group == 2 && body.collision[1].group == 0));
    CHECK(imported.scene.bodies[0].show.size() == 2);
    REQUIRE(imported.scene.cameras.size() == 1);
    CHECK(imported.scene.cameras[0].def.verticalFieldOfView == Approx(60_deg));
    CHECK(near(imported.scene.cameras[0].pose.position, {0, 0, 1}));
    CHECK(near(rotate(imported.scene.cameras[0].pose.orientation, {0, 0, -1}), {0, 0, -1}));
    CHECK(near(rotate(imported.scene.lights.at(0).pose.orientation, {0, 0, -1}), normalized(Vec3{1, -1, 0})));
    Simulation sim(simulationDef(imported.scene));
    static_cast<void>(addScene(sim, imported.scene));
    CHECK(sim.run({.headless = true, .steps = 5}).complete());
}

TEST_CASE("MJCF: the stiffness of a joint draws it to springref, if no actuator has a spring of its own")
{
    const std::string body = R"(<compiler angle="degree"/><worldbody><body>
<joint name="a" stiffness="2" springref="90"/><geom size="0.1"/></body></worldbody>)";
    const auto springOf = [](const Imported& imported) {
        return std::get<JointSpring>(*rigid(imported, 0).articulation.joints[0].command);
    };
    const Imported alone = mjcf(body + "<actuator><motor joint='a'/></actuator>");
    CHECK(springOf(alone).value == Approx(90_deg));
    CHECK(springOf(alone).stiffness == 2.0);
    CHECK(told(alone).empty());
    const Imported driven = mjcf(body + "<actuator><position joint='a' kp='7'/></actuator>");
    CHECK(springOf(driven).value == 0.0);
    CHECK(springOf(driven).stiffness == 7.0);
    REQUIRE(told(driven).size() == 1);
    CHECK(told(driven)[0].find("the stiffness of a <joint> that has an actuator with one is not read") !=
          std::string::npos);
}

TEST_CASE("MJCF: an equality of joints lets one follow the other from where both are in the file")
{
    const auto model = [](const std::string& equality) {
        return R"(<worldbody><body><geom size="0.1"/>
<body><joint name="a" type="slide" axis="1 0 0" ref="0.1"/><geom size="0.1"/></body>
<body><joint name="b" type="slide" axis="1 0 0" ref="0.3"/><geom size="0.1"/></body></body></worldbody>
<actuator><position joint="a"/></actuator><equality>)" +
               equality + "</equality>";
    };
    const Imported imported = mjcf(model(R"(<joint joint1="b" joint2="a" polycoef="0.05 -2 0 0 0"/>)"));
    Simulation sim(simulationDef(imported.scene));
    const BodyId body = addScene(sim, imported.scene).bodies.at(0);
    sim.physics().setJoint(body, 0, JointPosition{0.2});
    static_cast<void>(sim.run({.headless = true, .steps = 300}));
    const auto& joints = sim.physics().latest()->rigidBody(body)->joints;
    CHECK(joints.at(0).position == Approx(0.2));
    CHECK(joints.at(1).position == Approx(0.3 + 0.05 - 2 * (0.2 - 0.1)));

    // MuJoCo has 0 1 0 0 0 where polycoef says nothing.
    CHECK(rigid(mjcf(model(R"(<joint joint1="b" joint2="a" polycoef="0.05"/>)")), 0)
              .articulation.joints[1]
              .mimic->multiplier == 1.0);
    CHECK_THAT(told(mjcf(model(R"(<joint joint1="a" joint2="b"/>)"))).back(),
               Catch::EndsWith("<position> of a joint1 of <equality> is not read: joint2 moves it"));
    const auto alone = mjcf(model(R"(<joint joint1="b" polycoef="0.05"/>)"));
    CHECK(std::get<JointPosition>(*rigid(alone, 0).articulation.joints[1].command).value == Approx(0.35));
    CHECK_FALSE(rigid(mjcf(model(R"(<joint joint1="b" joint2="a" active="false"/>)")), 0).articulation.joints[1].mimic);
    const auto tells = [&](const std::string& equality, const std::string& words) {
        const std::vector<std::string> notes = told(mjcf(model(equality)));
        return std::any_of(notes.begin(), notes.end(), [&](const std::string& each) { return each.ends_with(words); });
    };
    CHECK(tells(R"(<weld body1="x"/>)", "<weld> of <equality> is not read"));
    CHECK(tells(R"(<joint joint1="b" joint2="a" solref="1 1"/>)", "<joint> solref is not read"));
    CHECK(tells(R"(<joint joint1="b" joint2="a" polycoef="0 1 1"/>)", "higher powers are not read"));
    const std::string three =
        R"(<worldbody><body><geom size="0.1"/><body><joint name="a" type="slide"/><geom size="0.1"/></body>
<body><joint name="b" type="slide"/><geom size="0.1"/></body><body><joint name="c" type="slide"/><geom size="0.1"/></body>
</body></worldbody><actuator><motor joint="c"/></actuator>
<equality><joint joint1="c" joint2="b" polycoef="0.1 2"/><joint joint1="b" joint2="a" polycoef="0.2 -1"/></equality>)";
    const Imported chain = mjcf(three); // one that follows one that follows
    const auto& mimic = rigid(chain, 0).articulation.joints[2].mimic;
    REQUIRE(mimic);
    CHECK((mimic->joint == 0 && mimic->multiplier == -2.0 && mimic->offset == Approx(0.5)));
    CHECK(told(chain).size() == 1);
    CHECK_THAT(told(chain).front(), Catch::EndsWith("<motor> of a joint1 of <equality> is not read: joint2 moves it"));
    const auto wrong = [&](const std::string& equality) { return errorOf(model(equality)); };
    CHECK_THAT(wrong(R"(<joint joint2="a"/>)"), Catch::Contains("must say its joint1"));
    CHECK_THAT(wrong(R"(<joint joint1="b" joint2="b"/>)"), Catch::Contains("must be another joint of the same body"));
    CHECK_THAT(wrong(R"(<joint joint1="b" joint2="a"/><joint joint1="a" joint2="b"/>)"),
               Catch::Contains("must not lead back to its own joint"));
    CHECK_THAT(wrong(R"(<joint joint1="b" joint2="a"/><joint joint1="b"/>)"),
               Catch::Contains("must be a joint that no other <equality> has for its joint1"));
}

TEST_CASE("MJCF: what is not read is told once per kind with its place, and is an error if strict")
{
    const std::string model = R"(<option integrator="Euler"/><tendon/>
<worldbody><site/><site/><geom size="1" condim="3"/><geom size="1" condim="1" denisty="2"/><body><geom size="1"/></body></worldbody>
<keyframe/><default><pair/></default>)";
    CHECK(told(mjcf(model)) ==
          std::vector<std::string>{"model.xml:4:22: a default <pair> is not read",
                                   "model.xml:2:30: <tendon> is not read", "model.xml:4:2: <keyframe> is not read",
                                   "model.xml:2:2: <option> integrator is not read",
                                   "model.xml:3:13: <site> is a place that sensors may name, and is not drawn",
                                   "model.xml:3:27: <geom> condim is not read",
                                   "model.xml:3:54: <geom> denisty is not read (did you mean 'density'?)"});
    CHECK(errorOf(model, {.strict = true}) ==
          "model.xml:4:22: mujoco/default/pair: a default <pair> is not read (strict)");
}

TEST_CASE("MJCF: a mistake is one line with place, element, attribute, bound and value")
{
    CHECK(worldError("<geom type=\"bax\" size=\"1\"/>") ==
          "model.xml:3:2: mujoco/worldbody/geom.type must be one of plane, hfield, sphere, capsule, ellipsoid, "
          "cylinder, box, mesh, "
          "sdf, got 'bax' (did you mean 'box'?)");
    CHECK(worldError("<geom name=\"g\" size=\"-1\"/>") ==
          "model.xml:3:2: mujoco/worldbody/geom 'g'.size must be in [0, 1000], got '-1'");
    CHECK(worldError("<geom type=\"box\" size=\"1 1\"/>") ==
          "model.xml:3:2: mujoco/worldbody/geom.size must be 3 numbers, got '1 1'");
    CHECK(worldError("<geom size=\"1e308\"/>").ends_with("must be in [0, 1000], got '1e308'"));
    CHECK(worldError("<geom size=\"nan\"/>").ends_with("must consist of finite numbers, got 'nan'"));
    CHECK(worldError("<body><joint type=\"ball\"/></body>") ==
          "model.xml:3:8: mujoco/worldbody/body/joint is a ball joint: hinges and slides are carried, and free joints");
    CHECK(worldError("<body><freejoint/></body>") ==
          "model.xml:3:2: mujoco/worldbody/body must have a mass, because it moves freely");
    CHECK(
        worldError("<flexcomp dim=\"3\" count=\"100000 100000 100000\"/>") ==
        "model.xml:3:2: mujoco/worldbody/flexcomp must leave at most 300000 nodes in the model, got 1e+15 up to here");
    CHECK(worldError("<flexcomp dim=\"3\" count=\"3 3 3\"><pin id=\"27\"/></flexcomp>") ==
          "model.xml:3:34: mujoco/worldbody/flexcomp/pin.id must be in [0, 26], got '27'");
    CHECK(worldError("<geom type=\"mesh\" mesh=\"m\"/>") ==
          "model.xml:3:2: mujoco/worldbody/geom.mesh must be a mesh of the assets, got 'm'");
    CHECK(errorOf("") == "model.xml:1:2: mujoco must have a <worldbody>");
}

TEST_CASE("MJCF: what says the same thing twice is refused, or told where MuJoCo has a rule")
{
    const auto second = [](const std::string& tag) { return " is a second <" + tag + ">, where there may be one"; };
    const std::string inertial = R"(<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>)";
    CHECK(worldError("<body>" + inertial + inertial + "</body>") ==
          "model.xml:3:60: mujoco/worldbody/body/inertial" + second("inertial"));
    CHECK(worldError("<body>" + inertial + "<frame>" + inertial + "</frame></body>").ends_with(second("inertial")));
    CHECK(worldError("<body quat=\"1 0 0 0\" euler=\"0 0 90\"/>") ==
          "model.xml:3:2: mujoco/worldbody/body.euler must not stand beside quat, got '0 0 90'");
    CHECK(worldError("<body zaxis=\"0 0 1\" axisangle=\"1 0 0 5\"/>")
              .ends_with("must not stand beside axisangle, got '0 0 1'"));
    CHECK(worldError(R"(<body><inertial mass="1" pos="0 0 0" diaginertia="1 1 1" fullinertia="1 1 1 0 0 0"/></body>)")
              .ends_with(".fullinertia must not stand beside diaginertia, got '1 1 1 0 0 0'"));
    CHECK(worldError(R"(<body><inertial mass="1" pos="0 0 0" quat="1 0 0 0" fullinertia="1 1 1 0 0 0"/></body>)")
              .ends_with(".quat must not stand beside fullinertia, got '1 0 0 0'"));
    CHECK(errorOf("<default><geom/><geom/></default><worldbody/>").ends_with("mujoco/default/geom" + second("geom")));
    CHECK(worldError("<flexcomp dim=\"3\"><elasticity/><elasticity/></flexcomp>").ends_with(second("elasticity")));
    CHECK(worldError("<body name=\"a\"/><body name=\"a\"/>").ends_with("body 'a' has a name that another one has"));
    CHECK(worldError("<geom fromto=\"0 0 0 1 0 0\" size=\"1\"/>")
              .ends_with("needs a capsule, ellipsoid, cylinder or box, got '0 0 0 1 0 0'"));
    CHECK(worldError("<joint/>") == "model.xml:3:2: mujoco/worldbody/joint must stand in a body, and not in the world");
    CHECK(worldError("<camera/><light type=\"spot\" directional=\"true\"/>")
              .ends_with("must not stand beside type, got 'true'"));
    CHECK(worldError("<geom type=\"box\" pos=\"1 0 0\" fromto=\"0 0 0 1 0 0\" size=\"1\"/>")
              .ends_with("geom.pos must not stand beside fromto, got '1 0 0'"));
    const Imported tolerant = world(R"(<body><freejoint/>
<geom type="capsule" quat="0 1 0 0" size="0.1" fromto="0 0 0 1 0 0" mass="1" density="5"/></body>)");
    CHECK(told(tolerant) ==
          std::vector<std::string>{"model.xml:4:2: <geom> quat is not used beside fromto, as in MuJoCo",
                                   "model.xml:4:2: <geom> density is not used beside mass, as in MuJoCo"});
}

TEST_CASE("MJCF: a joint in a frame moves the body that the frame is in, about the axis of the frame")
{
    const std::string geom = R"(<geom type="box" size="0.1 0.2 0.3" pos="0.3 0 0"/>)";
    const auto posed = [&](const std::string& joint) {
        const Imported imported = world("<body name=\"b\" pos=\"0 1 0\">" + joint + geom + "</body>");
        Simulation sim(simulationDef(imported.scene));
        const BodyId body = addScene(sim, imported.scene).bodies.at(0);
        sim.run({.headless = true, .steps = 100});
        return sim.physics().latest()->rigidBody(body)->poses.at(2);
    };
    // The frame turns z to y and is moved; the slide in it has its parent's axes again.
    const Pose plain = posed(R"(<joint axis="0 1 0" pos="0.1 0.2 0.35" ref="20"/><joint type="slide" axis="0 0 1"/>)");
    const Pose framed = posed(R"(<frame pos="0.1 0.2 0.3" euler="-90 0 0"><joint pos="0 -0.05 0" ref="20"/>
        <frame euler="90 0 0"><joint type="slide"/></frame></frame>)");
    CHECK(length(framed.position - plain.position) < 1e-9);
    CHECK(std::abs(dot(framed.orientation, plain.orientation)) == Approx(1.0));
    CHECK(length(plain.position) > 0.1); // it swings
    const Imported classes = mjcf(R"(<default><default class="c"><joint damping="3"/></default></default><worldbody>
<body><frame childclass="c"><joint/></frame><geom size="1"/></body></worldbody>)");
    CHECK(rigid(classes, 0).articulation.joints.at(0).damping == 3);
    CHECK(world("<body><frame pos=\"1 0 0\"><freejoint/><geom size=\"0.1\"/></frame></body>").scene.bodies.size() == 1);
}

TEST_CASE("MJCF: hostile files end in an error, quickly")
{
    std::string deep, out;
    for (int i = 0; i < 100000; ++i) deep += "<body>";
    for (int i = 0; i < 100000; ++i) out += "</body>";
    CHECK(worldError(deep + out).ends_with("is nested more than 200 deep"));
    const std::string bomb = R"(<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>)";
    const SceneFolder folder;
    const auto load = [&](const std::string& text) -> std::string {
        try {
            return loadMjcf(folder.write("model.xml", text)).scene.bodies.empty() ? "empty" : "loaded";
        } catch (const Error& error) {
            return error.what();
        }
    };
    CHECK(load(bomb + "<mujoco><worldbody><geom size=\"&b;\"/></worldbody></mujoco>")
              .ends_with("got '&b;'")); // not expanded
    folder.write("a.xml", "<mujoco><include file=\"b.xml\"/></mujoco>");
    folder.write("b.xml", "<mujoco><include file=\"a.xml\"/></mujoco>");
    CHECK(load("<mujoco><include file=\"a.xml\"/></mujoco>").find("must be a file that is not read yet") !=
          std::string::npos);
    CHECK(load("<mujoco><include file=\"model.xml\"/></mujoco>").find("must be a file that is not read yet") !=
          std::string::npos);
    CHECK(load("<mujoco><include file=\"/etc/passwd\"/></mujoco>").find("in the folder of the model") !=
          std::string::npos);
    CHECK(load("").ends_with("model.xml: is empty"));
    CHECK(load("<robot/>").ends_with("must begin with <mujoco>, got <robot>"));
}

TEST_CASE("MJCF: an included file stands in the place of its include, and its mistakes have its name")
{
    const SceneFolder folder;
    folder.write("ground.xml",
                 "<mujoco><worldbody><geom name=\"ground\" type=\"plane\" size=\"1 1 1\"/></worldbody></mujoco>");
    const std::string part = folder.write("part.xml", "<mujocoinclude>\n<geom size=\"0.1\"/></mujocoinclude>");
    const std::string model = folder.write("model.xml", R"(<mujoco><include file="ground.xml"/><worldbody>
<body name="b"><include file="part.xml"/></body></worldbody></mujoco>)");
    const Imported imported = loadMjcf(model);
    CHECK(imported.scene.bodies.size() == 2);
    CHECK(imported.scene.files.size() == 3);
    folder.write("part.xml", "<mujocoinclude>\n<geom size=\"x\"/></mujocoinclude>");
    try {
        loadMjcf(model);
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(std::string(error.what()).find("part.xml:2:2: mujocoinclude/geom.size") != std::string::npos);
    }
}

TEST_CASE("MJCF: bodies with unlike frictions are told, because their pairs rub otherwise")
{
    const SceneFolder folder;
    const auto notes = [&](double friction) {
        return loadMjcf(
                   folder.write("model.xml",
                                text("<mujoco><worldbody><geom type=\"plane\" size=\"1 1 1\" friction=\"0.3\"/><body>"
                                     "<freejoint/><geom size=\"0.1\" friction=\"",
                                     friction, "\"/></body></worldbody></mujoco>")))
            .notes;
    };
    CHECK(notes(0.3).empty());
    REQUIRE(notes(1.0).size() == 1);
    CHECK_THAT(notes(1.0)[0],
               Catch::EndsWith("model.xml:1:2: bodies have frictions from 0.3 to 1: two of them rub with "
                               "the root of their product, in MuJoCo with the larger one"));
}

TEST_CASE("imports: a file is what its name and its first element say")
{
    CHECK((isSceneFile("a.urdf") && isSceneFile("a.XML") && isSceneFile("a.json") && !isSceneFile("a.obj")));
    const SceneFolder folder;
    const SceneDef robot = loadAnyScene(
        folder.write("a.xml", "<?xml version=\"1.0\"?><!-- <mujoco> --><robot name=\"r\"><link name=\"a\"/></robot>"));
    CHECK(std::get<RigidBodyDef>(robot.bodies.at(0).def).name == "r");
    CHECK(loadAnyScene(folder.write("b.xml", "<mujoco><worldbody><geom size=\"1\"/></worldbody></mujoco>"))
              .bodies.size() == 1);
    const std::string scene = folder.write("c.json", "{}");
    CHECK(loadAnyScene(scene).bodies.empty());
    CHECK_THROWS_WITH(loadAnyScene(scene, {.strict = true}),
                      Catch::Contains("c.json: strict is for URDF, MJCF and .scn"));
    CHECK_THROWS_WITH(loadAnyScene(scene, {.packages = {"/tmp"}}), Catch::Contains("c.json: a package is for URDF"));
    CHECK_THROWS_WITH(loadUrdf(folder.file("a.xml"), {.packages = {"/nope"}}), "package must be a folder, got '/nope'");
}

TEST_CASE("MJCF: sensors of joints, places, velocities and touch read what they read in MuJoCo")
{
    const Imported imported = mjcf(R"(<worldbody>
<geom type="plane" size="0 0 1"/>
<body name="arm" pos="0 0 1"><joint name="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.02" mass="1"/>
  <site name="tip" pos="0.4 0 0.05"/></body>
<body name="ball" pos="1 0 0.04"><freejoint/><geom name="round" pos="0 0.01 0" size="0.05" mass="0.3"/><site name="skin" size="0.06"/></body></worldbody>
<actuator><motor name="pull" joint="hinge"/></actuator>
<sensor><jointpos name="angle" joint="hinge"/><actuatorfrc actuator="pull"/><framepos name="tip" objtype="site" objname="tip"/>
<framepos objtype="body" objname="ball"/><framepos name="origin" objtype="xbody" objname="ball"/>
<framelinvel name="v" objtype="body" objname="ball"/><touch name="touch" site="skin"/><gyro site="tip"/></sensor>)");
    const std::vector<std::string> notes = told(imported);
    REQUIRE(notes.size() == 3);
    CHECK(notes[0].ends_with("<site> is a place that sensors may name, and is not drawn"));
    CHECK(notes[1].ends_with("<touch> is read as all contacts of its body, in the site or not"));
    CHECK(notes[2].ends_with("<gyro> of <sensor> is not read"));
    Simulation sim(simulationDef(imported.scene));
    const AddedScene added = addScene(sim, imported.scene);
    CHECK(added.bodies.size() == 3);
    prefab::SensorsDef def{.sensors = imported.scene.sensors};
    REQUIRE(def.sensors.size() == 7);
    const prefab::Sensors sensors(sim, def);
    sim.run({.headless = true, .steps = 200});
    const std::vector<prefab::SensorReading> now = sensors.read();
    CHECK(now[0].name == "angle");
    CHECK(now[1].name == "actuatorfrc");
    CHECK(now[3].name == "framepos");
    const double angle = now[0].values[0];
    CHECK(angle > 0.1); // about their y, our -z: the arm sinks
    const auto isAt = [&](std::size_t k, Vec3 at, double margin) {
        return distance({now[k].values[0], now[k].values[1], now[k].values[2]}, at) < margin;
    };
    CHECK(isAt(2,
               {0.4 * std::cos(angle) + 0.05 * std::sin(angle), 1 - 0.4 * std::sin(angle) + 0.05 * std::cos(angle), 0},
               1e-9));
    CHECK(isAt(3, {1, 0.05, -0.01}, 1e-3)); // its centre: it rests on the plane
    CHECK(isAt(4, {1, 0.05, 0}, 1e-3));
    CHECK(isAt(5, {}, 1e-3));
    CHECK(now[6].values.back() == Approx(0.3 * 9.81).epsilon(0.01));
}

TEST_CASE("MJCF: a sensor of something that is not there, or of a kind that is not read, is told")
{
    const std::string body =
        R"(<worldbody><body name="arm"><joint name="hinge"/><geom size="0.1"/></body></worldbody>)";
    CHECK(errorOf(body + "<sensor><jointpos/></sensor>").find("must say its joint") != std::string::npos);
    CHECK(errorOf(body + "<sensor><framepos objtype='sight' objname='tip'/></sensor>").find("objtype must be") !=
          std::string::npos);
    const auto note = [&](const std::string& sensors, std::size_t read) {
        const Imported imported =
            mjcf(body + "<actuator><velocity name='v' joint='hinge'/></actuator><sensor>" + sensors + "</sensor>");
        CHECK(imported.scene.sensors.size() == read);
        return told(imported).back();
    };
    CHECK(note("<jointpos joint='hinges'/>", 0)
              .ends_with(
                  "<jointpos> of 'hinges' is not read: nothing that is read has this name (did you mean 'hinge'?)"));
    CHECK(note("<actuatorfrc actuator='v'/>", 0).find("<actuatorfrc> of 'v' is not read") != std::string::npos);
    CHECK(note("<framepos objtype='site' objname='tip'/>", 0).find("<framepos> of 'tip' is not read") !=
          std::string::npos);
    CHECK(note("<framepos objtype='camera' objname='eye'/>", 0).ends_with("<framepos> of a camera is not read"));
    CHECK(note("<framepos objtype='body' objname='world'/>", 0).find("neither moves, touches nor shows") !=
          std::string::npos);
    CHECK(note("<clock/>", 0).ends_with("<clock> of <sensor> is not read"));
    CHECK(note("<framepos objtype='body' objname='arm' reftype='body' refname='arm'/>", 1).find("refname") !=
          std::string::npos);
}

TEST_CASE("MJCF: a force range of nothing is no limit, and a constant force without a spring is told")
{
    const auto of = [](const std::string& actuator) {
        return mjcf("<worldbody><body><joint name='a'/><geom size='0.1'/></body></worldbody><actuator>" + actuator +
                    "</actuator>");
    };
    const auto strengthOf = [&](const std::string& range) {
        return std::get<JointSpring>(
                   *rigid(of("<position joint='a' " + range + "/>"), 0).articulation.joints[0].command)
            .strength;
    };
    CHECK(std::isinf(strengthOf("forcerange='0 0'")));
    CHECK(std::isinf(strengthOf("forcerange='-3 3' forcelimited='false'")));
    CHECK(strengthOf("forcerange='0 0' forcelimited='true'") == 0.0);
    CHECK_THROWS_WITH(strengthOf("forcerange='3 -3'"), Contains("forcerange must be ascending"));
    CHECK_THROWS_WITH(strengthOf("forcelimited='true'"), Contains("must say its forcerange"));
    CHECK(told(of("<general joint='a' biastype='affine' biasprm='5 0 -2'/>")).back().find("constant force") !=
          std::string::npos);
    CHECK(told(of("<general joint='a' forcerange='-1 1'/>")).back().find("forcerange is not read") !=
          std::string::npos);
}

TEST_CASE("MJCF: quarter turns one behind the other leave unit quaternions that every Def takes")
{
    for (const char* turn : {"1 1 0 0", "0.7071 -0.7071 0 0", "0 0 1 1", "0 0 1 -1", "1 -1 0 0"}) {
        const Imported imported =
            world(text(R"(<body quat=")", turn, R"("><geom size="0.1"/><body quat="1 1 0 0"><joint/><geom size="0.1"/>
<body quat="1 -1 0 0"><geom size="0.1"/><body quat="1 1 0 0"><joint/><geom size="0.1"/></body></body></body></body>)"));
        Simulation sim(simulationDef(imported.scene));
        CHECK_NOTHROW(static_cast<void>(addScene(sim, imported.scene)));
    }
}

TEST_CASE("MJCF: a plane is touched beyond the size at which it is drawn")
{
    const Imported imported = world(R"(<geom type="plane" size="0.3 0.3 0.1"/>
<body pos="100 0 0.06"><freejoint/><geom type="box" size="0.05 0.05 0.05"/></body>)");
    Simulation sim(simulationDef(imported.scene));
    const BodyId box = addScene(sim, imported.scene).bodies.at(1);
    sim.run({.headless = true, .steps = 500});
    CHECK(sim.physics().latest()->rigidBody(box)->poses[0].position.y == Approx(0.05).margin(1e-3));
    double most = 0.0;
    for (const runtime::ShowDef& each : imported.scene.bodies[0].show)
        for (const Vec3& v : std::get<std::shared_ptr<const geometry::TriangleMesh>>(each.surface)->vertices)
            most = std::max(most, std::abs(v.x));
    CHECK(most == Approx(0.3));
}

TEST_CASE("MJCF: what a free joint says of damping is told, and a size may replace the first numbers of its default")
{
    const Imported imported = mjcf(R"(<default><geom size="0.03 0.1"/></default>
<worldbody><body><joint type="free" damping="2" armature="0"/><geom type="capsule" size="0.02"/></body></worldbody>)");
    REQUIRE(told(imported).size() == 1);
    CHECK(told(imported)[0].ends_with("<joint> damping of a free joint is not read"));
    const auto& mesh = *std::get<std::shared_ptr<const geometry::TriangleMesh>>(rigid(imported, 0).collision[0].mesh);
    double radius = 0.0, top = 0.0;
    for (const Vec3& v : mesh.vertices) {
        radius = std::max(radius, std::hypot(v.x, v.y));
        top = std::max(top, v.z);
    }
    CHECK(radius == Approx(0.02).epsilon(0.02));
    CHECK(top == Approx(0.12).epsilon(0.02));
    CHECK(worldError(R"(<body><geom type="capsule" size="0.02"/></body>)").find("size must be at least 2 numbers") !=
          std::string::npos);
}

TEST_CASE("MJCF: links whose contype and conaffinity never meet do not touch each other")
{
    const auto self = [](const std::string& bits) {
        return rigid(world(R"(<body><geom size="0.1" )" + bits + R"(/><body><joint/><geom size="0.1" )" + bits +
                           "/></body></body>"),
                     0)
            .collision[0]
            .self;
    };
    CHECK(self(""));
    CHECK(!self(R"(contype="1" conaffinity="0")"));
    CHECK(self(R"(contype="2" conaffinity="3")"));
    CHECK(!self(R"(contype="2" conaffinity="1")"));
}

TEST_CASE("MJCF: a general actuator with an affine bias is a spring, scaled by its gear")
{
    const auto springOf = [](const std::string& actuator) {
        const Imported imported =
            mjcf("<worldbody><body><joint name='a'/><geom size='0.1'/></body></worldbody><actuator>" + actuator +
                 "</actuator>");
        return std::get<JointSpring>(*rigid(imported, 0).articulation.joints[0].command);
    };
    const JointSpring panda =
        springOf("<general joint='a' biastype='affine' gainprm='450' biasprm='9 -450 -45' forcerange='-87 87'/>");
    CHECK((panda.stiffness == 450.0 && panda.damping == 45.0 && panda.strength == 87.0));
    CHECK(panda.value == Approx(0.02));
    const JointSpring geared = springOf("<position joint='a' kp='3' kv='1' gear='2' forcerange='-5 5'/>");
    CHECK((geared.stiffness == 12.0 && geared.damping == 4.0 && geared.strength == 10.0));
    const Imported motor = mjcf("<worldbody><body><joint name='a'/><geom size='0.1'/></body></worldbody>"
                                "<actuator><general joint='a'/></actuator>");
    CHECK(std::holds_alternative<JointForce>(*rigid(motor, 0).articulation.joints[0].command));
}

TEST_CASE("MJCF: a shin that lies along its trunk, in the direction of its hip's axis, is not pressed without end")
{
    // Nothing can part the two: their contact's normal is the axis. The force grew by 100 MN a second.
    const Imported imported = mjcf(R"(<option timestep="0.0005"/>
<default><joint axis="0 1 0" damping="0.05" armature="0.002"/></default>
<worldbody><geom type="plane" size="0 0 .1"/>
<body name="trunk" pos="0 0 0.6" euler="5 10 0"><freejoint/><geom type="box" size="0.2 0.08 0.05" mass="5"/>
<body pos="0.2 -0.1 0"><joint range="-90 90"/><geom type="capsule" fromto="0 0 0 -.1 0 -.2" size="0.02"/>
<body pos="-.1 0 -.2"><joint range="-90 90"/><geom type="capsule" fromto="0 0 0 .1 0 -.2" size="0.02"/>
<geom type="sphere" size="0.025" pos=".1 0 -.2"/></body></body></body></worldbody>)");
    Simulation sim(simulationDef(imported.scene));
    const BodyId trunk = addScene(sim, imported.scene).bodies.at(1);
    double most = 0.0;
    for (int i = 0; i < 60; ++i) {
        sim.run({.headless = true, .steps = 50});
        double sum = 0.0;
        for (const frame::Contact& each : sim.physics().latest()->contacts)
            if (each.first == trunk && each.second == trunk) sum += each.normalForce;
        most = std::max(most, sum);
    }
    CHECK(most > 100.0); // they do touch
    CHECK(most < 2e4);
}

} // namespace import_mjcf_test
} // namespace filasofia::scene

#include "filasofia/filasofia.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/import.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

#include <algorithm>

namespace filasofia::scene {
namespace import_urdf_test {

const RigidBodyDef& robotOf(const Imported& imported)
{
    return std::get<RigidBodyDef>(imported.scene.bodies.at(0).def);
}

Imported urdf(const std::string& inside, const ImportOptions& options = {})
{
    const SceneFolder folder;
    return loadUrdf(folder.write("robot.urdf", "<robot name=\"r\">\n" + inside + "\n</robot>\n"), options);
}

std::string errorOf(const std::string& inside, const ImportOptions& options = {})
{
    try {
        urdf(inside, options);
    } catch (const Error& error) {
        const std::string line = error.what();
        const auto at = line.find("robot.urdf");
        return at == std::string::npos ? line : line.substr(at);
    }
    return "no error";
}

constexpr const char* kDouble = R"(
<link name="base"/>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <dynamics damping="0.001" friction="0.0005"/></joint>
<link name="upper">
  <inertial><origin xyz="0.1 0 0"/><mass value="0.5"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="2e-3" iyz="0" izz="2e-3"/></inertial>
</link>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0.2 0 0" rpy="0 0.5 0"/>
  <axis xyz="0 1 0"/></joint>
<link name="lower">
  <inertial><origin xyz="0.05 0 0"/><mass value="0.2"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="2e-4" iyz="0" izz="2e-4"/></inertial>
</link>)";

RigidBodyDef doubleInDefs()
{
    return {
        .name = "r",
        .elements = {{{}, {0.70710678118654757, -0.70710678118654757, 0, 0}}},
        .articulation = {
            .joints = {{.axis = {0, 1, 0},
                        .parent = 0,
                        .child = 1,
                        .command = JointForce{0},
                        .damping = 0.001,
                        .friction = 0.0005,
                        .mass = GivenInertia{.mass = 0.5, .centre = {0.1, 0, 0}, .moments = {1e-4, 2e-3, 2e-3}}},
                       {.axis = {0, 1, 0},
                        .parent = 1,
                        .child = 2,
                        .parentOffset = {{0.2, 0, 0}, axisAngle({0, 1, 0}, 0.5)},
                        .command = JointForce{0},
                        .mass = GivenInertia{.mass = 0.2, .centre = {0.05, 0, 0}, .moments = {1e-5, 2e-4, 2e-4}}}}}};
}

TEST_CASE("URDF: a double pendulum has the hash of the same articulation in Defs at every step, and swings")
{
    const Imported imported = urdf(kDouble);
    CHECK(imported.notes.empty());
    CHECK(imported.joints == std::vector<std::vector<std::string>>{{"shoulder", "elbow"}});
    Simulation file(simulationDef(imported.scene)), program;
    const BodyId arm = addScene(file, imported.scene).bodies.at(0);
    program.add(doubleInDefs());
    runtime::SteppedRun a(file), b(program);
    for (int step = 0; step < 500; ++step) {
        a.step();
        b.step();
        REQUIRE(file.physics().hash() == program.physics().hash());
    }
    const auto frame = file.physics().latest();
    CHECK(std::abs(frame->rigidBody(arm)->joints[0].position) > 0.5);
}

TEST_CASE("URDF: a mass of 0 is told if its link moves, and so is its inertia")
{
    const auto told = [](const std::string& type, const std::string& inertia) {
        std::vector<std::string> notes = urdf("<link name=\"base\"/><link name=\"arm\"><inertial><mass value=\"0\"/>" +
                                              inertia + "</inertial></link><joint name=\"turn\" type=\"" + type +
                                              "\"><parent link=\"base\"/><child link=\"arm\"/></joint>")
                                             .notes;
        for (std::string& each : notes) each = each.substr(each.find(": ") + 2);
        return notes;
    };
    const std::string some = "<inertia ixx=\"1e-3\" iyy=\"1e-3\" izz=\"1e-3\"/>";
    const std::string weightless = "a moving link with a <mass> of 0 gets a millionth of the mass of its robot";
    const auto holds = [](const std::vector<std::string>& notes, const std::string& line) {
        return std::ranges::find(notes, line) != notes.end();
    };
    CHECK(holds(told("continuous", ""), weightless));
    CHECK(holds(told("continuous", some), "<inertia> of a link with a <mass> of 0 is not read"));
    CHECK_FALSE(holds(told("fixed", ""), weightless));
}

TEST_CASE("URDF: a link that is fixed to another is part of it, with its mass and its shapes")
{
    const Imported imported = urdf(R"(
<link name="base"><collision><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit lower="0.2" upper="1" effort="5" velocity="2.5"/></joint>
<link name="arm"><inertial><mass value="1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial></link>
<joint name="weld" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.3 0 0"/></joint>
<link name="hand"><inertial><mass value="3"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial>
  <collision><origin xyz="0 0 0.1"/><geometry><box size="0.02 0.02 0.04"/></geometry></collision>
  <visual><geometry><cylinder radius="0.01" length="0.1"/></geometry></visual></link>)");
    const RigidBodyDef& robot = robotOf(imported);
    REQUIRE(robot.articulation.joints.size() == 1);
    const JointDef& joint = robot.articulation.joints[0];
    CHECK((joint.lower == 0.2 && joint.upper == 1 && joint.start == 0.2 && joint.speed == 2.5));
    CHECK_FALSE(joint.command); // its drive holds it
    REQUIRE(joint.mass);
    CHECK(joint.mass->mass == 4);
    CHECK(joint.mass->centre.x == Approx(0.225));
    CHECK(joint.mass->moments.y == Approx(2e-3 + 0.75 * 0.3 * 0.3)); // the reduced mass at the distance of both
    REQUIRE(robot.collision.size() == 2);
    CHECK((robot.collision[0].element == 0 && robot.collision[1].element == 1));
    const auto& box = std::get<std::shared_ptr<const geometry::TriangleMesh>>(robot.collision[1].mesh);
    const geometry::Box around = geometry::boxAround(box->vertices);
    CHECK(around.low.x == Approx(0.29));
    CHECK(around.high.z == Approx(0.12));
    CHECK(imported.scene.bodies[0].show.size() == 1);
}

TEST_CASE("URDF: an inertia tensor that is not diagonal becomes its principal moments")
{
    const Imported imported = urdf(R"(
<link name="a"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
<link name="b"><inertial><origin rpy="0.3 -0.4 1.1"/><mass value="2"/>
  <inertia ixx="0.03" ixy="0.002" ixz="-0.001" iyy="0.02" iyz="0.003" izz="0.025"/></inertial></link>)");
    const GivenInertia mass = *robotOf(imported).articulation.joints[0].mass;
    const Mat3 axes = toMat3(mass.axes), found = axes * Mat3::diagonal(mass.moments) * transpose(axes);
    const Mat3 given{{{0.03, 0.002, -0.001}, {0.002, 0.02, 0.003}, {-0.001, 0.003, 0.025}}};
    const Mat3 turn = toMat3(axisAngle({0, 0, 1}, 1.1) * axisAngle({0, 1, 0}, -0.4) * axisAngle({1, 0, 0}, 0.3));
    const Mat3 expected = turn * given * transpose(turn);
    for (int r = 0; r < 3; ++r) CHECK(length(found[r] - expected[r]) < 1e-15);
}

TEST_CASE("URDF: the needle driver runs, and its tip goes where its joints say")
{
    const Imported imported = loadUrdf(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/needle_driver.urdf"));
    CHECK(imported.joints[0] ==
          std::vector<std::string>{"yaw", "pitch", "insertion", "roll", "wrist_pitch", "jaw_left", "jaw_right"});
    REQUIRE(imported.notes.size() == 1);
    CHECK(imported.notes[0].ends_with("whatever is in its way"));
    Simulation sim(simulationDef(imported.scene));
    const BodyId driver = addScene(sim, imported.scene).bodies.at(0);
    sim.physics().setJoint(driver, 1, JointPosition{30_deg});
    sim.physics().setJoint(driver, 2, JointPosition{0.1});
    sim.run({.headless = true, .steps = 800});
    // The wrist is 0.04 m + insertion below the remote centre, turned by the pitch about x; z is up there, y here.
    const Vec3 wrist = sim.physics().latest()->rigidBody(driver)->poses.at(5).position;
    CHECK(wrist.x == Approx(0.0).margin(1e-9));
    CHECK(wrist.y == Approx(-0.14 * std::cos(30_deg)));
    CHECK(wrist.z == Approx(-0.14 * std::sin(30_deg)));
}

TEST_CASE("URDF: a joint mimics another one, which may stand behind it and mimic a third")
{
    const auto finger = [](const char* name, const char* mimic) {
        return text("<link name=\"", name,
                    "\"><inertial><mass value=\"0.1\"/><inertia ixx=\"1\" iyy=\"1\" "
                    "izz=\"1\"/></inertial></link><joint name=\"",
                    name, "\" type=\"prismatic\"><parent link=\"hand\"/><child link=\"", name,
                    "\"/><axis xyz=\"0 1 0\"/><limit lower=\"-0.05\" upper=\"0.05\" effort=\"1\" velocity=\"0.1\"/>",
                    mimic, "</joint>");
    };
    const std::string robot = R"(<link name="hand"/>)" + finger("left", R"(<mimic joint="right" multiplier="-1"/>)") +
                              finger("third", R"(<mimic joint="left" multiplier="2" offset="0.01"/>)") +
                              finger("right", "");
    const Imported imported = urdf(robot);
    CHECK(imported.joints.at(0) == std::vector<std::string>{"left", "third", "right"});
    Simulation sim(simulationDef(imported.scene));
    const BodyId gripper = addScene(sim, imported.scene).bodies.at(0);
    const auto at = [&](std::size_t joint) {
        return sim.physics().latest()->rigidBody(gripper)->joints.at(joint).position;
    };
    sim.physics().setJoint(gripper, 2, JointPosition{0.02});
    static_cast<void>(sim.run({.headless = true, .steps = 100}));
    CHECK(at(2) == Approx(0.01).epsilon(1e-6)); // on its way
    CHECK(at(0) == Approx(-0.01).epsilon(1e-6));
    CHECK(at(1) == Approx(-0.01).epsilon(1e-6)); // 2 * -0.01 + 0.01
    static_cast<void>(sim.run({.headless = true, .steps = 300}));
    CHECK(at(0) == Approx(-0.02).epsilon(1e-6));
    CHECK(at(1) == Approx(-0.03).epsilon(1e-6));
    CHECK_THROWS_WITH(sim.physics().setJoint(gripper, 0, JointPosition{0.0}),
                      Catch::Contains("joint 0: takes no command: it mimics joint 2"));

    const auto wrong = [&](const std::string& mimic) {
        return errorOf(R"(<link name="hand"/>)" + finger("a", mimic.c_str()) + finger("b", R"(<mimic joint="a"/>)"));
    };
    CHECK_THAT(wrong("<mimic/>"), Catch::Contains("joint 'a'/mimic must say its joint"));
    CHECK_THAT(wrong(R"(<mimic joint="c"/>)"), Catch::Contains("mimic.joint must be the name of a joint, got 'c'"));
    CHECK_THAT(wrong(R"(<mimic joint="b"/>)"), Catch::Contains("joint 'a'/mimic must not lead back to its own joint"));

    // The other joint starts where its follower is within its limits, if there is such a place.
    const auto apart = [&](const std::string& mimic) {
        return R"(<link name="hand"/>)" + finger("a", "") + finger("b", mimic.c_str());
    };
    const Imported shifted = urdf(apart(R"(<mimic joint="a" offset="0.08"/>)"));
    CHECK(std::any_of(shifted.notes.begin(), shifted.notes.end(), [](const std::string& note) {
        return note.ends_with("<limit> velocity does not count if the joint has a <mimic>: it goes with the other one");
    }));
    Simulation moved(simulationDef(shifted.scene));
    const BodyId hand = addScene(moved, shifted.scene).bodies.at(0);
    static_cast<void>(moved.run({.headless = true, .steps = 10}));
    CHECK(moved.physics().latest()->rigidBody(hand)->joints.at(0).position == Approx(-0.03));
    CHECK(moved.physics().latest()->rigidBody(hand)->joints.at(1).position == Approx(0.05));
    CHECK_THAT(
        errorOf(apart(R"(<mimic joint="a" offset="0.2"/>)")),
        Catch::Contains("joint 'b'/mimic leaves joint 'a' no place: its limits and those of the joints that go with "
                        "it do not meet"));
}

TEST_CASE("URDF: what is not read is told once per kind with its place, and is an error if strict")
{
    const std::string robot = R"(
<link name="a"><sensor/><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
<link name="b"><sensor/></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><calibration up="0"/><axis xzy="1 0 0"/>
  <limit effort="1"/></joint>
<transmission name="t"/><gazebo/><gazebo/>)";
    std::vector<std::string> told;
    for (const std::string& note : urdf(robot).notes) told.push_back(note.substr(note.find("robot.urdf")));
    CHECK(told ==
          std::vector<std::string>{
              "robot.urdf:7:2: <transmission> is not read", "robot.urdf:7:26: <gazebo> is not read",
              "robot.urdf:3:17: <sensor> is not read", "robot.urdf:5:71: <calibration> is not read",
              "robot.urdf:5:92: <axis> xzy is not read (did you mean 'xyz'?)",
              "robot.urdf:6:4: <limit> effort bounds no force: the joint goes where it is told, whatever is in its "
              "way"});
    CHECK(errorOf(robot, {.strict = true}) ==
          "robot.urdf:7:2: robot 'r'/transmission 't': <transmission> is not read (strict)");
    CHECK(errorOf(kDouble, {.strict = true}) == "no error");
}

TEST_CASE("URDF: a mistake is one line with place, element, attribute, bound and value")
{
    const std::string joint = R"(<link name="a"/><link name="b"/><joint name="j" type=)";
    const std::string ends = R"(<parent link="a"/><child link="b"/></joint>)";
    CHECK(errorOf(joint + "\"revolut\">" + ends) ==
          "robot.urdf:2:34: robot 'r'/joint 'j'.type must be one of fixed, revolute, continuous, prismatic, floating, "
          "planar, got 'revolut' (did you mean 'revolute'?)");
    CHECK(errorOf(joint + "\"floating\">" + ends) == "robot.urdf:2:34: robot 'r'/joint 'j' is floating: joints of one "
                                                     "degree of freedom are carried, and fixed ones");
    CHECK(errorOf(joint + "\"prismatic\">" + ends) == "robot.urdf:2:34: robot 'r'/joint 'j' must have a <limit>");
    CHECK(errorOf(joint + "\"prismatic\"><limit lower=\"2\" upper=\"1\"/>" + ends) ==
          "robot.urdf:2:67: robot 'r'/joint 'j'/limit.upper must leave lower <= upper, got '1'");
    CHECK(
        errorOf(R"(<link name="arm"/><joint name="j" type="fixed"><parent link="amr"/><child link="arm"/></joint>)") ==
        "robot.urdf:2:49: robot 'r'/joint 'j'/parent.link must be the name of a link, got 'amr' (did you mean 'arm'?)");
    CHECK(
        errorOf(R"(<link name="a"><visual><geometry><sphere radius="nan"/></geometry></visual></link>)") ==
        "robot.urdf:2:35: robot 'r'/link 'a'/visual/geometry/sphere.radius must consist of finite numbers, got 'nan'");
    CHECK(errorOf(R"(<link name="a"><visual><geometry><box size="1 -2 1e308"/></geometry></visual></link>)") ==
          "robot.urdf:2:35: robot 'r'/link 'a'/visual/geometry/box.size must be in [1e-07, 1000], got '1 -2 1e308'");
    CHECK(errorOf(R"(<link name="a"/><link name="b"/>)") ==
          "robot.urdf:2:18: robot 'r'/link 'b' is a second link that no joint moves; a robot has one");
    CHECK(errorOf(joint + "\"fixed\">" + ends +
                  R"(<joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint>)") ==
          "robot.urdf:1:2: robot 'r' must have a link that no joint moves: its joints form a loop");
    CHECK(errorOf(R"(<link name="a"/><xacro:property xmlns:xacro="x" name="w" value="1"/>)") ==
          "robot.urdf:2:18: robot 'r'/xacro:property 'w' is a macro: expand the file first (xacro FILE > robot.urdf)");
    CHECK(errorOf(R"(<link name="a" name="b"/>)") == "robot.urdf:2:2: robot 'r'/link 'a'.name is given twice");
    CHECK(errorOf("<link name=\"a\">") == "robot.urdf:3:3: this is no XML: Start-end tags mismatch");
    CHECK(
        errorOf(
            R"(<link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="3"/></inertial></link>)"
            R"(<joint name="j" type="continuous">)" +
            ends) == "robot.urdf:2:33: robot 'r'/link 'b'/inertial must have principal moments of inertia > 0, none "
                     "larger than the sum "
                     "of the other two, together with the parts that are fixed to it");
}

TEST_CASE("URDF: what may be there once is refused the second time, and never taken or dropped without a word")
{
    const std::string two =
        R"(<link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/><child link="b"/>)";
    const auto joint = [&](const std::string& inside) { return errorOf(two + "\n" + inside + "</joint>"); };
    CHECK(joint("<limit upper=\"1\"/><limit upper=\"2\"/>") ==
          "robot.urdf:3:20: robot 'r'/joint 'j'/limit is a second <limit>, where there may be one");
    for (const char* tag :
         {"axis xyz=\"1 0 0\"", "dynamics damping=\"1\"", "origin", "child link=\"a\"", "parent link=\"b\""})
        CHECK_THAT(joint(text("<limit/><", tag, "/><", tag, "/>")), Catch::Contains("is a second <"));
    const auto link = [](const std::string& inside) { return errorOf("<link name=\"a\">" + inside + "</link>"); };
    const std::string inertial = R"(<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>)";
    CHECK(link(inertial + inertial).ends_with("/inertial is a second <inertial>, where there may be one"));
    CHECK(link("<inertial><mass value=\"1\"/><mass value=\"2\"/></inertial>")
              .ends_with("a second <mass>, where there may be one"));
    const std::string ball = "<geometry><sphere radius=\"1\"/></geometry>";
    CHECK(link("<visual>" + ball + ball + "</visual>").ends_with("a second <geometry>, where there may be one"));
    CHECK(link("<visual><geometry><sphere radius=\"1\"/><box size=\"1 1 1\"/></geometry></visual>")
              .ends_with("geometry/box is a second shape: a <geometry> has one"));
    const std::string red = R"(<material name="m"><color rgba="1 0 0 1"/></material>)";
    const std::string blue = R"(<material name="m"><color rgba="0 0 1 1"/></material>)";
    CHECK(errorOf("<link name=\"a\"/>" + red + red).ends_with("material 'm' has a name that another one has"));
    const Imported own = urdf(red + "<link name=\"a\"><visual>" + ball + blue + "</visual></link>");
    REQUIRE(own.notes.size() == 1);
    CHECK_THAT(own.notes[0], Catch::Contains("a <material> has another colour than the first one of its name"));
}

TEST_CASE("URDF: meshes are scaled, mirrored right side out, and lie in the robot's folder or in a package")
{
    const SceneFolder folder;
    const std::string corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    folder.write("pkg/meshes/corner.obj", corner);
    const auto load = [&](const std::string& place, const std::string& mesh, const ImportOptions& options = {}) {
        return loadUrdf(
            folder.write(place, "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"" + mesh +
                                    "\" scale=\"-0.1 0.2 0.3\"/></geometry></collision></link></robot>"),
            options);
    };
    const Imported plain = load("pkg/robot.urdf", "meshes/corner.obj");
    const auto& mesh = std::get<std::shared_ptr<const geometry::TriangleMesh>>(robotOf(plain).collision.at(0).mesh);
    CHECK(geometry::boxAround(mesh->vertices).low.x == Approx(-0.1));
    CHECK(geometry::enclosedVolume(*mesh) == Approx(0.1 * 0.2 * 0.3 / 6));
    CHECK(plain.scene.files.size() == 2);

    const auto errorFrom = [&](auto&&... arguments) -> std::string {
        try {
            load(arguments...);
            return "no error";
        } catch (const Error& error) {
            return error.what();
        }
    };
    const std::string below = "pkg/urdf/robot.urdf", named = "package://pkg/meshes/corner.obj";
    CHECK(errorFrom(below, "../meshes/corner.obj").find("in the folder of the robot") != std::string::npos);
    CHECK(errorFrom(below, named).find("(--any-folder allows all)") != std::string::npos);
    CHECK(errorFrom(below, named, ImportOptions{.anyFolder = true}) == "no error");
    const std::filesystem::path root = std::filesystem::path(folder.write("x", "")).parent_path();
    CHECK(errorFrom(below, named, ImportOptions{.packages = {root}}) == "no error");
    CHECK(errorFrom(below, named, ImportOptions{.packages = {root / "pkg"}}) == "no error");
    CHECK(errorFrom(below, "package://other/corner.obj").find("(--package names one)") != std::string::npos);
    CHECK(errorFrom("pkg/robot.urdf", "meshes/none.obj").find("must be a file that exists") != std::string::npos);
}

TEST_CASE("URDF: a mesh in Collada has its unit and its nodes' places, polygons, and no up axis")
{
    const SceneFolder folder;
    const std::string dae = R"(<COLLADA><asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist><input semantic="VERTEX" offset="1"/><input semantic="NORMAL" offset="0"/><vcount>4</vcount><p>9 0 9 1 9 2 9 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene><node><translate>0 0 5</translate><node><scale>2 -1 1</scale>
<instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes></COLLADA>)";
    const auto load = [&](const std::string& words) {
        folder.write("m.dae", words);
        return loadUrdf(folder.write("robot.urdf",
                                     "<robot name=\"r\"><link name=\"a\"><visual><geometry><mesh filename=\"m.dae\"/>"
                                     "</geometry></visual></link></robot>"));
    };
    const Imported imported = load(dae);
    const auto& mesh =
        *std::get<std::shared_ptr<const geometry::TriangleMesh>>(imported.scene.bodies[0].show.at(0).surface);
    REQUIRE(mesh.triangles.size() == 2);
    const geometry::Box around = geometry::boxAround(mesh.vertices);
    CHECK(length(around.low - Vec3{0, -0.01, 0.05}) < 1e-12);
    CHECK(length(around.high - Vec3{0.02, 0, 0.05}) < 1e-12);
    for (const geometry::Triangle& each : mesh.triangles) // mirrored, and still seen from +z
        CHECK(
            cross(mesh.vertices[each[1]] - mesh.vertices[each[0]], mesh.vertices[each[2]] - mesh.vertices[each[0]]).z >
            0);
    const auto errorFrom = [&](std::string words, const std::string& from, const std::string& to) -> std::string {
        words.replace(words.find(from), from.size(), to);
        try {
            load(words);
            return "no error";
        } catch (const Error& error) {
            return error.what();
        }
    };
    CHECK(errorFrom(dae, "9 3<", "9 4<").ends_with("a face names vertex 4; it must be in [0, 4)"));
    CHECK(errorFrom(dae, "#g", "#h").ends_with("there is no geometry 'h'"));
    CHECK(errorFrom(dae, "1 1 0 0 1 0", "1 1 0 0 nan 0").find("numbers must be finite") != std::string::npos);
    CHECK(errorFrom(dae, "</COLLADA>", "").find("this is no XML") != std::string::npos);
}

TEST_CASE("URDF: a robot that weighs nothing is held where nothing drives it")
{
    const Imported imported = urdf(R"(<link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>)");
    CHECK_FALSE(robotOf(imported).articulation.joints[0].command);
    CHECK(imported.notes.at(0).ends_with("joint 'j' is held: its robot weighs nothing, so no force can move it"));
}

TEST_CASE("URDF: a shape of size 0 is left out and told")
{
    const Imported imported =
        urdf("<link name=\"a\"><visual><geometry><box size=\"0 0 0\"/></geometry></visual></link>");
    CHECK(imported.scene.bodies[0].show.empty());
    CHECK(imported.notes.at(0).ends_with("a shape of size 0 is left out"));
}

} // namespace import_urdf_test
} // namespace filasofia::scene

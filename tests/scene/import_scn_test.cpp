#include "filasofia/filasofia.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/import.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace filasofia::scene {
namespace import_scn_test {

Imported scn(const std::string& inside, const std::string& root = R"(gravity="0 -9.81 0" dt="0.02")",
             const ImportOptions& options = {})
{
    const SceneFolder folder;
    return loadScn(folder.write("scene.scn", "<Node name=\"root\" " + root + ">\n" + inside + "\n</Node>\n"), options);
}

std::string errorOf(const std::string& inside, const ImportOptions& options = {})
{
    try {
        scn(inside, "", options);
    } catch (const Error& error) {
        const std::string line = error.what();
        const auto at = line.find("scene.scn");
        return at == std::string::npos ? line : line.substr(at);
    }
    return "no error";
}

const SoftBodyDef& softOf(const Imported& imported, std::size_t index = 0)
{
    return std::get<SoftBodyDef>(imported.scene.bodies.at(index).def);
}

const TetMesh& meshOf(const SoftBodyDef& def) { return *std::get<std::shared_ptr<const TetMesh>>(def.mesh); }

constexpr const char* kBeam = R"(
<Node name="Beam">
  <EulerImplicitSolver rayleighStiffness="0.1" rayleighMass="0.2"/>
  <CGLinearSolver iterations="25" tolerance="1e-9" threshold="1e-9"/>
  <RegularGridTopology name="grid" n="9 3 3" min="0 0 0" max="0.4 0.1 0.1"/>
  <MechanicalObject template="Vec3" translation="0 0.5 0"/>
  <UniformMass totalMass="4"/>
  <HexahedronFEMForceField youngModulus="20000" poissonRatio="0.3" method="large"/>
  <BoxROI name="box" box="-0.01 0.4 -0.01 0.01 0.7 0.2"/>
  <FixedProjectiveConstraint indices="@box.indices"/>
</Node>)";

TEST_CASE("a beam of SOFA is the soft body that its components say")
{
    const Imported imported = scn(kBeam);
    CHECK(imported.notes.empty());
    CHECK(imported.scene.physics.rate == Approx(50));
    CHECK(imported.scene.physics.gravity == Vec3{0, -9.81, 0});
    const SoftBodyDef& beam = softOf(imported);
    CHECK(beam.name == "Beam");
    CHECK(meshOf(beam).nodes.size() == 81);
    CHECK(meshOf(beam).tetrahedra.size() == 8 * 2 * 2 * 6);
    CHECK(meshOf(beam).nodes[1] == Vec3{0.05, 0.5, 0}); // x runs first, as in SOFA
    const auto& material = std::get<FemMaterial>(beam.material);
    CHECK(std::holds_alternative<physics::Corotational>(material.law));
    CHECK(material.youngModulus == 20000);
    CHECK(material.poissonRatio == 0.3);
    CHECK(std::get<physics::TotalMass>(beam.mass).value == 4);
    CHECK(beam.rayleigh.mass == 0.2);
    CHECK(beam.rayleigh.stiffness == 0.1);
    CHECK(beam.collision.empty()); // there is no CollisionPipeline
    REQUIRE(beam.attachments.size() == 1);
    CHECK(beam.attachments[0].nodes.size() == 9);
    CHECK(beam.attachments[0].nodes[1] == 9);
}

TEST_CASE("a beam of SOFA bends as the same body of ours, to the bit")
{
    const auto hashAfter = [](const SceneDef& scene) {
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
        runtime::SteppedRun run(sim);
        for (int i = 0; i < 30; ++i) run.step();
        return sim.physics().hash();
    };
    Imported imported = scn(kBeam);
    SceneDef own = imported.scene;
    SoftBodyDef def{.name = "Beam", .mesh = softOf(imported).mesh};
    def.material = FemMaterial{.youngModulus = 20000, .poissonRatio = 0.3, .law = physics::Corotational{}};
    def.mass = physics::TotalMass{4};
    def.rayleigh = {.mass = 0.2, .stiffness = 0.1};
    def.attachments = {{.box = Box{{-0.01, 0.4, -0.01}, {0.01, 0.7, 0.2}}}};
    def.friction = 0.0;
    own.bodies[0].def = def;
    CHECK(hashAfter(imported.scene) == hashAfter(own));
}

TEST_CASE("masses, forces, springs to the shape at rest and numbered nodes are read")
{
    const auto of = [](const std::string& components) {
        return softOf(scn("<Node name=\"B\"><EulerImplicitSolver/><RegularGridTopology nx=\"2\" ny=\"2\" "
                          "nz=\"2\"/><MechanicalObject/>"
                          "<TetrahedronFEMForceField/>" +
                          components + "</Node>"));
    };
    CHECK(std::get<physics::Density>(of("<DiagonalMass massDensity=\"7\"/>").mass).value == 7);
    CHECK(std::get<physics::TotalMass>(of("<MeshMatrixMass totalMass=\"2\"/>").mass).value == 2);
    CHECK(std::get<physics::TotalMass>(of("<UniformMass vertexMass=\"0.5\"/>").mass).value == 4); // 8 nodes
    const SoftBodyDef fixed = of("<UniformMass totalMass=\"1\"/><FixedConstraint indices=\"3 5-7\"/>"
                                 "<RestShapeSpringsForceField points=\"1\" stiffness=\"40\"/>");
    REQUIRE(fixed.attachments.size() == 2);
    CHECK(fixed.attachments[0].nodes == std::vector{3, 5, 6, 7});
    CHECK(fixed.attachments[1].stiffness == 40);
    const SoftBodyDef pulled =
        of("<UniformMass totalMass=\"1\"/><ConstantForceField indices=\"6 7\" totalForce=\"0 4 0\"/>");
    REQUIRE(pulled.forces.size() == 2);
    CHECK(pulled.forces[1].node == 7);
    CHECK(pulled.forces[1].force == Vec3{0, 2, 0});
}

TEST_CASE("hyperelastic materials of SOFA are read by their Lame parameters")
{
    const auto of = [](const std::string& material) {
        return std::get<FemMaterial>(
            softOf(scn("<Node name=\"B\"><EulerImplicitSolver/><RegularGridTopology n=\"2 2 2\"/>"
                       "<MechanicalObject/><UniformMass totalMass=\"1\"/>"
                       "<TetrahedronHyperelasticityFEMForceField " +
                       material + "/></Node>"))
                .material);
    };
    const FemMaterial venant = of(R"(materialName="StVenantKirchhoff" ParameterSet="1000 4000")");
    CHECK(std::holds_alternative<physics::StVenantKirchhoff>(venant.law));
    CHECK(venant.youngModulus == Approx(2800));
    CHECK(venant.poissonRatio == Approx(0.4));
    CHECK(of(R"(materialName="NeoHookean" ParameterSet="1000 5000")").poissonRatio == Approx(5.0 / 12.0));
    const FemMaterial mooney = of(R"(materialName="MooneyRivlin" ParameterSet="750 250 4000")"); // mu = 2000
    CHECK(std::get<physics::MooneyRivlin>(mooney.law).share == 0.25);
    CHECK(mooney.poissonRatio == Approx((3 * 4000.0 - 2 * 2000.0) / (2 * (3 * 4000.0 + 2000.0))));
    CHECK(mooney.youngModulus == Approx(9 * 4000.0 * 2000.0 / (3 * 4000.0 + 2000.0)));
    const auto refused = [](const std::string& material) {
        return errorOf("<Node name=\"B\"><RegularGridTopology n=\"2 2 2\"/><MechanicalObject/>"
                       "<TetrahedronHyperelasticityFEMForceField " +
                       material + "/></Node>");
    };
    CHECK(refused("materialName=\"Costa\"")
              .ends_with("materialName must be StVenantKirchhoff, NeoHookean, StableNeoHookean or MooneyRivlin, got "
                         "'Costa'"));
    CHECK(refused("ParameterSet=\"1 2\"").find("must have the materialName StVenantKirchhoff") != std::string::npos);
    CHECK(refused(R"(materialName="MooneyRivlin" ParameterSet="750 250 1000")").find("k0 >= 4/3 (c1 + c2)") !=
          std::string::npos);
}

/// A soft body of eight nodes with these attributes of its elasticity, and these further components.
std::string cubeWith(const std::string& law, const std::string& components = "")
{
    return "<Node name=\"B\"><EulerImplicitSolver/><RegularGridTopology n=\"2 2 2\"/><MechanicalObject/>"
           "<UniformMass totalMass=\"1\"/><TetrahedronFEMForceField " +
           law + "/>" + components + "</Node>";
}

/// What is told of a scene, without the places.
std::vector<std::string> toldOf(const std::string& inside)
{
    std::vector<std::string> notes = scn(inside).notes;
    for (std::string& each : notes) each = each.substr(each.find(": ") + 2);
    return notes;
}

using Notes = std::vector<std::string>;

TEST_CASE("an attribute of a component of SOFA that is neither read nor without effect is told")
{
    CHECK(toldOf(cubeWith("youngModulous=\"20000\"")) ==
          Notes{"<TetrahedronFEMForceField> youngModulous is not read (did you mean 'youngModulus'?)"});
    CHECK(toldOf(cubeWith("localStiffnessFactor=\"1 0.5\"")) ==
          Notes{"<TetrahedronFEMForceField> localStiffnessFactor is not read"});
    const auto body = [](const std::string& solver, const std::string& state, const std::string& mass) {
        return toldOf("<Node name=\"B\"><EulerImplicitSolver " + solver +
                      "/><RegularGridTopology n=\"2 2 2\"/><MechanicalObject " + state + "/><UniformMass " + mass +
                      "/><TetrahedronFEMForceField/></Node>");
    };
    CHECK(body("firstOrder=\"1\"", "velocity=\"1 0 0\"", "totalMass=\"1\" filename=\"a\"") ==
          Notes{"<EulerImplicitSolver> firstOrder is not read", "<MechanicalObject> velocity is not read",
                "<UniformMass> filename is not read"});
    CHECK(body("", "position=\"0 0 0\"", "totalMass=\"1\"") == Notes{"<MechanicalObject> position is not read"});
    CHECK(errorOf(cubeWith("youngModulous=\"20000\""), {.strict = true}).ends_with("(strict)"));
    // What draws, prints, links, or has the value that changes nothing.
    CHECK(body("firstOrder=\"false\" vdamping=\"0.0\" printLog=\"1\" name=\"s\" tags=\"t\"",
               "velocity=\"0 0 0  0 0 0\" restScale=\"1\" showObject=\"1\" showObjectScale=\"3\" reserve=\"9\"",
               "totalMass=\"1\" showAxisSizeFactor=\"2\"")
              .empty());
    CHECK(toldOf(cubeWith("template=\"Vec3\" computeVonMisesStress=\"1\" showVonMisesStressPerNode=\"1\" "
                          "localStiffnessFactor=\"1 1\" plasticYieldThreshold=\"0.1\" listening=\"1\""))
              .empty());
}

TEST_CASE("a second elasticity or mass of a node of SOFA is told, and so is a mass that is given in two ways")
{
    CHECK(toldOf(cubeWith("", "<MeshSpringForceField stiffness=\"5\"/>")) ==
          Notes{"<MeshSpringForceField> is not read: a <Node> has one elasticity here, and adds them in SOFA"});
    CHECK(toldOf(cubeWith("", "<DiagonalMass massDensity=\"5\"/>")) ==
          Notes{"<DiagonalMass> is not read: a <Node> has one mass here, and adds them in SOFA"});
    const Imported both = scn("<Node name=\"B\"><EulerImplicitSolver/><RegularGridTopology n=\"2 2 2\"/>"
                              "<MechanicalObject/><DiagonalMass massDensity=\"5\" totalMass=\"3\"/>"
                              "<TetrahedronFEMForceField/></Node>");
    CHECK(std::get<physics::TotalMass>(softOf(both).mass).value == 3); // as in SOFA
    CHECK(both.notes.size() == 1);
}

TEST_CASE("a component that acts on no body that is read is told, and a body that is left out")
{
    CHECK(toldOf(cubeWith("", "<Node name=\"C\"><MechanicalObject/><ConstantForceField totalForce=\"0 1 0\"/>"
                              "<BarycentricMapping/></Node>")) ==
          Notes{"<ConstantForceField> is not read in a <Node> that is mapped"});
    CHECK(toldOf(cubeWith("") + "<Node name=\"C\"><MechanicalObject template=\"Rigid3\"/>"
                                "<RestShapeSpringsForceField/></Node>") ==
          Notes{"<RestShapeSpringsForceField> is not read in a <Node> of a rigid body"});
    CHECK(toldOf(cubeWith("") + "<Node name=\"C\"><MechanicalObject/></Node>") ==
          Notes{"<Node> 'C' is left out: it has no elasticity that is read, and no surface that collides or is seen"});
}

TEST_CASE("collision models of SOFA of one group are told if they belong to several bodies")
{
    const std::string model = "<TriangleCollisionModel group=\"1\"/>";
    CHECK(toldOf("<CollisionPipeline/>" + cubeWith("", model + "<LineCollisionModel group=\"1\"/>")).empty());
    CHECK(toldOf("<CollisionPipeline/>" + cubeWith("", model) + cubeWith("", model)) ==
          Notes{"<TriangleCollisionModel> group is not read: bodies of a group touch"});
}

TEST_CASE("the order of SOFA's explicit solver, the corner of a grid and the stretch of a state are read")
{
    const auto of = [](const std::string& solver) {
        return softOf(
            scn("<Node name=\"B\">" + solver +
                "<RegularGridTopology n=\"2 2 2\" p0=\"3 0 0\" max=\"1 1 1\"/>"
                "<MechanicalObject sx=\"2\"/><UniformMass totalMass=\"1\"/><TetrahedronFEMForceField/></Node>"));
    };
    const SoftBodyDef usual = of("<EulerExplicitSolver/>");
    CHECK(std::get<physics::ExplicitEuler>(usual.integrator).symplectic); // SOFA's default
    CHECK_FALSE(
        std::get<physics::ExplicitEuler>(of("<EulerExplicitSolver symplectic=\"false\"/>").integrator).symplectic);
    CHECK(meshOf(usual).nodes[0].x == 6);
    CHECK(meshOf(usual).nodes[1].x == 8);
}

TEST_CASE("colours of SOFA are numbers, words or hexadecimal, and another word is told")
{
    const SceneFolder folder;
    folder.write("solid.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const auto with = [&](const std::string& colour) {
        return loadScn(
            folder.write("scene.scn", "<Node name=\"root\"><Node name=\"P\"><OglModel fileMesh=\"solid.obj\" "
                                      "color=\"" +
                                          colour + "\"/></Node></Node>"));
    };
    const auto colourOf = [](const Imported& imported) {
        const auto& material = imported.scene.bodies.at(0).show.at(0).material;
        REQUIRE(material);
        return std::visit(
            [](const auto& each) {
                if constexpr (requires { each.baseColor; })
                    return each.baseColor;
                else
                    return visual::Color{};
            },
            *material);
    };
    const auto same = [&](const std::string& word, const std::string& numbers) {
        const Imported named = with(word);
        return named.notes.empty() && colourOf(named) == colourOf(with(numbers));
    };
    CHECK_FALSE(same("red", "0 1 0"));
    CHECK(same("red", "1 0 0"));
    CHECK(same("gray", "0.5 0.5 0.5"));
    CHECK(same("orange", "1 0.5 0"));
    CHECK(same("#ff0000", "1 0 0"));
    CHECK(same("#00FF0080", "0 1 0"));
    const Imported other = with("rouge");
    REQUIRE(other.notes.size() == 1);
    CHECK(other.notes[0].find("<OglModel> color is not read: 'rouge' is none of SOFA's words") != std::string::npos);
    CHECK(with("#12345").notes.size() == 1);
}

TEST_CASE("a scene of SOFA without a body says what was not read on the way")
{
    const std::string typo = errorOf("<Node name=\"B\"><RegularGridTopology n=\"2 2 2\"/><MechanicalObject/>"
                                     "<UniformMass totalMass=\"1\"/>\n<TetraedronFEMForceField/></Node>");
    CHECK(typo.starts_with("scene.scn:1:2: Node 'root' has no body that is read: "));
    CHECK(
        typo.find("scene.scn:3:2: <TetraedronFEMForceField> is not read (did you mean 'TetrahedronFEMForceField'?)") !=
        std::string::npos);
    CHECK(errorOf("<Node name=\"B\"><MechanicalObject/><TriangularFEMForceField/></Node>")
              .find("<TriangularFEMForceField> is not read") != std::string::npos);
    CHECK(errorOf("<Node name=\"B\"><MechanicalObject/></Node>").find("<Node> 'B' is left out") != std::string::npos);
}

constexpr const char* kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST_CASE("rigid bodies, obstacles, friction and collision models of SOFA are read, and a body falls on an obstacle")
{
    const SceneFolder folder;
    folder.write("solid.obj", kObj);
    const auto file = folder.write("scene.scn", R"(<Node name="root" dt="0.005">
  <CollisionPipeline/><CollisionResponse response="FrictionContactConstraint" responseParams="mu=0.6"/>
  <LocalMinDistance alarmDistance="0.1" contactDistance="0.02"/>
  <MeshOBJLoader name="loader" filename="solid.obj"/>
  <Node name="Floor"><MeshTopology src="@loader"/><MechanicalObject src="@loader" scale="10" translation="-3 -3.5 -3"/>
    <TriangleCollisionModel simulated="0" moving="0"/></Node>
  <Node name="Falls"><EulerImplicitSolver/><CGLinearSolver/>
    <MechanicalObject template="Rigid3" position="0 3 0 0 0 0 1"/><UniformMass totalMass="2"/>
    <Node name="Surface"><MeshTopology src="@../../loader"/><MechanicalObject src="@../../loader"/>
      <TriangleCollisionModel/><RigidMapping/></Node>
    <Node name="Visual"><OglModel src="@../../loader" color="1 0 0"/><RigidMapping/></Node></Node>
</Node>)");
    const Imported imported = loadScn(file);
    REQUIRE(imported.scene.bodies.size() == 2);
    const auto& floor = std::get<RigidBodyDef>(imported.scene.bodies[0].def);
    const auto& falls = std::get<RigidBodyDef>(imported.scene.bodies[1].def);
    CHECK_FALSE(floor.dynamic);
    CHECK(floor.friction == 0.6);
    CHECK(floor.collision.at(0).proximity == 0.01);
    CHECK(falls.dynamic);
    CHECK(falls.elements.at(0).position == Vec3{0, 3, 0});
    CHECK(std::get<physics::GivenInertia>(falls.mass).mass == 2);
    CHECK(imported.scene.bodies[1].show.size() == 1);
    Simulation sim(simulationDef(imported.scene));
    static_cast<void>(addScene(sim, imported.scene));
    runtime::SteppedRun run(sim);
    double most = 0.0; // it falls by 1.5 m and slides off
    for (int i = 0; i < 200; ++i) {
        run.step();
        for (const frame::Contact& each : sim.physics().latest()->contacts) most = std::max(most, each.normalForce);
    }
    CHECK(most > 10.0); // 2 kg weigh 19.6 N
}

TEST_CASE("a rigid body of SOFA turns about its frame, with the inertia of the box around its collision model there")
{
    const SceneFolder folder;
    folder.write("solid.obj", kObj); // in [0, 1] along each axis
    const auto massOf = [&](const std::string& pipeline, const std::string& child) {
        const Imported imported = loadScn(folder.write("scene.scn", "<Node name=\"root\">" + pipeline +
                                                                        R"(<Node name="B"><EulerImplicitSolver/>
            <MechanicalObject template="Rigid3" position="0 3 0 0 0 0 1"/><UniformMass totalMass="2"/>
            <Node name="S"><MeshOBJLoader name="l" filename="solid.obj"/><MeshTopology src="@l"/>
              <MechanicalObject src="@l"/>)" + child + "<RigidMapping/></Node></Node></Node>"));
        return std::get<physics::GivenInertia>(std::get<RigidBodyDef>(imported.scene.bodies.at(0).def).mass);
    };
    const std::string collides = "<CollisionPipeline/>", model = "<TriangleCollisionModel/>";
    const physics::GivenInertia box = massOf(collides, model), none = massOf("", model);
    CHECK(massOf(collides, "<OglModel src=\"@l\"/>").moments == none.moments); // a picture weighs nothing
    CHECK(box.centre == Vec3{});
    CHECK(box.moments.x == Approx(2.0 * (1.0 / 3.0 + 1.0 / 3.0)));
    CHECK(none.centre == Vec3{});
    CHECK(none.moments == Vec3{2, 2, 2}); // SOFA's default
}

TEST_CASE("a scene of SOFA in millimetres is told by its gravity")
{
    CHECK(scn(kBeam).notes.empty());
    CHECK_THAT(
        scn(kBeam, R"(gravity="0 -9810 0")").notes.at(0),
        Catch::EndsWith(": gravity is 9810: the scene seems to be in millimetres, and lengths are read as metres; "
                        "for organs of their own size, give the unit 0.001 (--unit 0.001, in Python unit=0.001)"));
}

/// Half a beam on a floor, and a rigid ball with a mass, with lengths in units of `unit` [m].
std::string inUnits(double unit)
{
    const auto of = [&](double metres) { return text(metres / unit); };
    return "<CollisionPipeline/><MinProximityIntersection contactDistance=\"" + of(0.002) +
           "\"/><Node name=\"Beam\"><EulerImplicitSolver/>"
           "<RegularGridTopology n=\"5 3 3\" min=\"0 0 0\" max=\"" +
           of(0.2) + " " + of(0.1) + " " + of(0.1) + "\"/><MechanicalObject template=\"Vec3\" translation=\"0 " +
           of(0.5) + " 0\"/><UniformMass massDensity=\"" + text(1000.0 * unit * unit * unit) +
           "\"/><HexahedronFEMForceField youngModulus=\"" + text(20000.0 * unit) +
           "\" poissonRatio=\"0.3\"/><BoxROI name=\"box\" box=\"" + of(-0.01) + " " + of(0.4) + " " + of(-0.01) + " " +
           of(0.01) + " " + of(0.7) + " " + of(0.2) +
           "\"/><FixedProjectiveConstraint indices=\"@box.indices\"/><RestShapeSpringsForceField points=\"44\" "
           "stiffness=\"50\"/><ConstantForceField totalForce=\"0 " +
           of(-0.2) +
           " 0\"/><TriangleCollisionModel/></Node><Node name=\"Ball\"><EulerImplicitSolver/><MechanicalObject "
           "template=\"Rigid3\" position=\"" +
           of(1.0) + " 0 0 0 0 0 1\"/><UniformMass totalMass=\"2\"/></Node>";
}

TEST_CASE("a scene of SOFA in millimetres, kilograms and seconds is the same as in metres, if its unit is given")
{
    const Imported metres = scn(inUnits(1.0)),
                   small = scn(inUnits(1e-3), R"(gravity="0 -9810 0" dt="0.02")", {.unit = 1e-3});
    CHECK(small.scene.physics.gravity.y == Approx(-9.81));
    REQUIRE(small.notes.size() == metres.notes.size());
    for (std::size_t i = 0; i < small.notes.size(); ++i) { // apart from where it stands
        const std::string &one = metres.notes[i], &other = small.notes[i];
        CHECK(one.substr(one.find(": ")) == other.substr(other.find(": ")));
    }
    const SoftBodyDef &one = softOf(metres), &two = softOf(small);
    const TetMesh &mesh = meshOf(one), &other = meshOf(two);
    REQUIRE(other.nodes.size() == mesh.nodes.size());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) CHECK(distance(mesh.nodes[i], other.nodes[i]) < 1e-9);
    CHECK(std::get<FemMaterial>(two.material).youngModulus == Approx(20000));
    CHECK(std::get<physics::Density>(two.mass).value == Approx(1000));
    CHECK(two.collision.at(0).proximity == Approx(0.001));
    REQUIRE(two.attachments.size() == 2);
    CHECK(two.attachments[0].nodes == one.attachments[0].nodes);
    CHECK(two.attachments[0].nodes.size() == 9);
    CHECK(two.attachments[1].stiffness == 50.0); // mN/mm
    REQUIRE(two.forces.size() == one.forces.size());
    CHECK(two.forces[0].force.y == Approx(one.forces[0].force.y));
    CHECK(one.forces[0].force.y == Approx(-0.2 / 45));
    const auto& ball = std::get<RigidBodyDef>(small.scene.bodies.at(1).def);
    CHECK(ball.elements.at(0).position.x == Approx(1.0));
    CHECK(std::get<physics::GivenInertia>(ball.mass).mass == 2.0);
    CHECK(std::get<physics::GivenInertia>(ball.mass).moments.x == Approx(2e-6)); // a unit squared

    CHECK_THAT(errorOf(kBeam, {.unit = 0.0}), Catch::EndsWith("scene.scn: unit must be > 0 m, got 0"));
    const SceneFolder folder;
    CHECK_THROWS_WITH(
        loadAnyScene(folder.write("a.urdf", "<robot name=\"r\"><link name=\"l\"/></robot>"), {.unit = 0.1}),
        Catch::EndsWith("a.urdf: a unit is for scenes of SOFA (.scn): URDF and MJCF are in metres"));
}

TEST_CASE("a scene of SOFA with gravity along z is turned to have y up, and holds the same nodes")
{
    std::string inside = kBeam;
    const Imported imported = scn(inside, R"(gravity="0 0 -9.81")");
    CHECK(imported.scene.physics.gravity.y == Approx(-9.81));
    const SoftBodyDef& beam = softOf(imported);
    CHECK(transform(beam.pose, Vec3{0, 0, 1}).y == Approx(1));
    CHECK(beam.attachments.at(0).nodes.size() == 9);
}

TEST_CASE("collision meshes of SOFA follow a body where its state places them, and those of a grid where the grid is")
{
    const SceneFolder folder;
    folder.write("solid.obj", kObj);
    const auto lowest = [&](const std::string& topology, const std::string& child) {
        const auto file = folder.write(
            "scene.scn",
            "<Node name=\"root\"><CollisionPipeline/><Node name=\"B\"><EulerImplicitSolver/>" + topology +
                "<MechanicalObject dx=\"5\"/><UniformMass totalMass=\"1\"/><TetrahedronFEMForceField/>"
                "<Node name=\"S\"><MeshOBJLoader name=\"l\" filename=\"solid.obj\"/><MeshTopology src=\"@l\"/>"
                "<MechanicalObject " +
                child + "/><TriangleCollisionModel/><BarycentricMapping/></Node></Node></Node>");
        const Imported imported = loadScn(file);
        const auto& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(softOf(imported).collision.at(0).mesh);
        double least = 1e9;
        for (const Vec3& each : mesh.vertices) least = std::min(least, each.x);
        return least;
    };
    CHECK(lowest("<RegularGridTopology n=\"3 3 3\"/>", "") == 5);
    CHECK(lowest("<RegularGridTopology name=\"g\" n=\"3 3 3\"/><TetrahedronSetTopologyContainer name=\"t\"/>"
                 "<Hexa2TetraTopologicalMapping input=\"@g\" output=\"@t\"/>",
                 "") == 5);
}

TEST_CASE("what is not read of a scene of SOFA is told once, strict refuses it, and what is wrong has its place")
{
    const Imported imported = scn(
        std::string(kBeam) + "<Node name=\"a\"><PlaneForceField/></Node><Node name=\"b\"><PlaneForceField/></Node>");
    REQUIRE(imported.notes.size() == 1);
    CHECK(imported.notes[0].find("<PlaneForceField> is not read") != std::string::npos);
    CHECK(errorOf(std::string(kBeam) + "<PlaneForceField/>", {.strict = true})
              .find("<PlaneForceField> is not read (strict)") != std::string::npos);
    CHECK(errorOf("") == "scene.scn:1:2: Node 'root' has no body that is read");
    const auto beamWith = [](const std::string& component) {
        return errorOf(
            "<Node name=\"B\"><RegularGridTopology n=\"2 2 2\"/><MechanicalObject/><UniformMass totalMass=\"1\"/>"
            "<TetrahedronFEMForceField/>" +
            component + "</Node>");
    };
    CHECK(beamWith("<FixedConstraint indices=\"8\"/>").find("indices must be in [0, 8)") != std::string::npos);
    CHECK(beamWith("<FixedConstraint indices=\"3-\"/>").find("indices must consist of whole numbers and ranges") !=
          std::string::npos);
    CHECK(beamWith("<FixedConstraint indices=\"x\"/>").find("must consist of") != std::string::npos);
    CHECK(errorOf("<Node name=\"B\"><MeshGmshLoader name=\"l\" filename=\"none.msh\"/><MeshTopology "
                  "src=\"@l\"/><MechanicalObject/>"
                  "<UniformMass totalMass=\"1\"/><TetrahedronFEMForceField/></Node>")
              .find("must be a file in the folder of the scene, or in SOFA's folder share") != std::string::npos);
    CHECK(errorOf("<Node name=\"B\"><RegularGridTopology n=\"2 2 2\" min=\"1 0 0\" max=\"0 1 1\"/><MechanicalObject/>"
                  "<UniformMass totalMass=\"1\"/><TetrahedronFEMForceField/></Node>")
              .find("must have a size along each axis") != std::string::npos);
}

} // namespace import_scn_test
} // namespace filasofia::scene

#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/runtime/stepped_run.h"

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

namespace sensors_test {

using namespace filasofia;

namespace {

std::string temporary(const std::string& ending)
{
    return (std::filesystem::temp_directory_path() / text("filasofia_sensors_test_", getpid(), ending)).string();
}

std::vector<std::string> linesOf(const std::string& file)
{
    std::vector<std::string> lines;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// A line's numbers; NaN for an empty cell.
std::vector<double> numbersOf(const std::string& line)
{
    std::vector<double> numbers;
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
        end = line.find(',', begin);
        const std::string cell = line.substr(begin, end == std::string::npos ? end : end - begin);
        numbers.push_back(cell.empty() ? std::nan("") : std::stod(cell));
    }
    return numbers;
}

Vec3 vectorOf(const SensorReading& reading) { return {reading.values[0], reading.values[1], reading.values[2]}; }

/// A floor of stone, and a ball of 0.2 kg on it.
struct BallOnFloor {
    Simulation sim;
    BodyId floor = sim.add(RigidBodyDef{
        .name = "floor", .elements = {{{0, -0.05, 0}, {}}}, .mesh = shapes::box({1, 0.1, 1}), .collision = {{}}});
    BodyId ball = sim.add(RigidBodyDef{.name = "ball",
                                       .elements = {{{0, 0.0205, 0}, {}}},
                                       .mesh = shapes::sphere(0.02),
                                       .dynamic = true,
                                       .mass = TotalMass{0.2},
                                       .collision = {{}}});
};

std::string errorOf(Simulation& sim, SensorsDef def)
{
    try {
        const Sensors sensors(sim, std::move(def));
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

} // namespace

TEST_CASE("sensors: a table has a line in each period of its rate, with the positions of the frames", "[sensors]")
{
    const std::string file = temporary(".csv");
    Simulation sim;
    const auto pathAt = [](double time) { return Vec3{0.01 * std::sin(6.0 * time), 0.02 * time, 0}; };
    const BodyId probe = sim.add(RigidBodyDef{.name = "probe", .elements = {{}}});
    sim.everyStep([&](double time) { sim.physics().setPose(probe, {pathAt(time), {}}); });
    {
        const Sensors sensors(
            sim, {.sensors = {{"tip", PositionSensor{.body = probe, .tip = {0, 0, -0.1}}}, {"", VelocitySensor{probe}}},
                  .rate = 50,
                  .file = file});
        static_cast<void>(sim.run({.headless = true, .steps = 500}));
        CHECK(vectorOf(sensors.read().front()).y == Approx(0.02 * 0.5).epsilon(1e-9));
    }
    const std::vector<std::string> lines = linesOf(file);
    std::filesystem::remove(file);
    REQUIRE(lines.size() == 1 + 26); // at 1 ms, and at 20 ms, 40 ms, up to 500 ms
    CHECK(lines[0] == "time [s],\"tip x [m]\",\"tip y [m]\",\"tip z [m]\",\"sensor 2 x [m/s]\",\"sensor 2 y [m/s]\","
                      "\"sensor 2 z [m/s]\"");
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const std::vector<double> row = numbersOf(lines[i]);
        REQUIRE(row.size() == 7);
        CHECK(row[0] == Approx(i == 1 ? 0.001 : 0.02 * static_cast<double>(i - 1)).epsilon(1e-12));
        const Vec3 place = pathAt(row[0]) + Vec3{0, 0, -0.1};
        CHECK(distance({row[1], row[2], row[3]}, place) < 1e-12);
        if (i > 1) CHECK(row[5] == Approx(0.02).epsilon(1e-6));
    }
}

TEST_CASE("sensors: the force of a contact is the weight that it carries, and only that between the two", "[sensors]")
{
    BallOnFloor scene;
    const BodyId far = scene.sim.add(
        RigidBodyDef{.name = "far", .elements = {{{9, 0, 0}, {}}}, .mesh = shapes::sphere(0.02), .collision = {{}}});
    const Sensors sensors(scene.sim, {.sensors = {{"all", ContactForceSensor{scene.ball}},
                                                  {"floor", ContactForceSensor{scene.floor, scene.ball}},
                                                  {"far", ContactForceSensor{scene.ball, far}},
                                                  {"energy", EnergySensor{scene.ball}}}});
    for (const SensorReading& each : sensors.read()) CHECK(std::isnan(each.values.front())); // no step was made
    static_cast<void>(scene.sim.run({.headless = true, .steps = 1000}));
    const std::vector<SensorReading> now = sensors.read();
    const double weight = 0.2 * 9.81;
    CHECK(now[0].columns == std::vector<std::string>{"x [N]", "y [N]", "z [N]", "normal [N]"});
    CHECK(now[0].values[1] == Approx(weight).epsilon(1e-3));
    CHECK(now[0].values[3] == Approx(weight).epsilon(1e-3));
    CHECK(vectorOf(now[1]) == -vectorOf(now[0]));
    CHECK(now[2].values == std::vector<double>(4, 0.0));
    CHECK(now[3].values[0] < 1e-6);
    CHECK(now[3].values[2] == Approx(weight * 0.02).epsilon(0.05));
}

TEST_CASE("sensors: attachments carry the weight of what hangs on them", "[sensors]")
{
    Simulation sim({.physics = {.rate = 200_Hz}});
    const BodyId tissue = sim.add(SoftBodyDef{.name = "tissue",
                                              .mesh = shapes::block({0.04, 0.04, 0.04}, {4, 4, 4}),
                                              .material = FemMaterial{.youngModulus = 40_kPa},
                                              .rayleigh = {.mass = 20},
                                              .attachments = {{.box = Box{{-1, 0.019, -1}, {1, 1, 1}}}}});
    const BodyId pull = sim.add(RigidBodyDef{.name = "pull", .elements = {{{0, -0.02, 0}, {}}}});
    sim.physics().attach(tissue, {.box = Box{{-1, -1, -1}, {1, -0.019, 1}}, .to = pull});
    const Sensors sensors(sim, {.sensors = {{"both", AttachmentForceSensor{tissue}},
                                            {"pull", AttachmentForceSensor{tissue, pull}},
                                            {"pulled", AttachmentForceSensor{pull}},
                                            {"support", AttachmentForceSensor{.body = tissue, .space = true}},
                                            {"node", PositionSensor{.body = tissue, .node = 0}},
                                            {"middle", PositionSensor{.body = tissue}}}});
    sim.everyStep([&](double time) { // a millimetre downwards
        sim.physics().setPose(pull, {{0, -0.02 - std::min(1e-3, 1e-2 * time), 0}, {}});
    });
    static_cast<void>(sim.run({.headless = true, .steps = 800}));
    const frame::FrameRef frame = sim.physics().latest();
    const std::vector<SensorReading> now = sensors.read();
    // The nodes that are held carry themselves: an eighth of the block with 4 cells in its height, twice.
    const double weight = 1000.0 * 0.04 * 0.04 * 0.04 * 9.81;
    CHECK(now[0].values[1] == Approx(weight).epsilon(0.26));
    CHECK(now[1].values[1] < -0.5); // 40 kPa, by 1 mm of 40
    CHECK(vectorOf(now[2]) == -vectorOf(now[1]));
    CHECK(now[3].values[1] == Approx(now[0].values[1] - now[1].values[1]));
    CHECK(std::fabs(now[0].values[0]) < 0.01 * weight);
    const auto& positions = frame->softBody(tissue)->positions;
    CHECK(vectorOf(now[4]) == positions[0]);
    Vec3 sum;
    for (const Vec3& each : positions) sum += each;
    CHECK(distance(vectorOf(now[5]), sum / static_cast<double>(positions.size())) < 1e-15);
}

TEST_CASE("sensors: joints, blood, heat and electrodes are those of the simulation", "[sensors]")
{
    Simulation sim;
    const ArticulationDef arm{.joints = {{.kind = JointKind::Prismatic, .axis = {1, 0, 0}}}};
    const BodyId slide = sim.add(RigidBodyDef{.name = "slide",
                                              .elements = {{}, {}},
                                              .mesh = shapes::box({0.02, 0.02, 0.02}),
                                              .mass = TotalMass{0.1},
                                              .articulation = arm});
    sim.physics().setJoint(slide, 0, JointForce{0.05});
    const BodyId organ = sim.add(SoftBodyDef{.name = "organ", .mesh = shapes::block({0.02, 0.02, 0.02}, {3, 3, 3})});
    sim.bleed(organ);
    sim.burn(organ);
    const int electrode = sim.addElectrode(slide, {.mode = EnergyMode::Coagulate, .tip = {.to = {0.01, 0, 0}}});
    const Sensors sensors(sim, {.sensors = {{"joint", JointSensor{slide}},
                                            {"blood", BloodSensor{organ}},
                                            {"heat", HeatSensor{organ}},
                                            {"electrode", ElectrodeSensor{slide, electrode}}}});
    sim.activate(slide, true);
    sim.treat(organ, Injure{{0, 0.01, 0}, 5_mm});
    sim.treat(organ, Heat{.place = {0, 0.01, 0}, .radius = 5_mm, .power = 10});
    static_cast<void>(sim.run({.headless = true, .steps = 300}));
    const std::vector<SensorReading> now = sensors.read();
    const frame::FrameRef frame = sim.physics().latest();
    const frame::Joint& joint = frame->rigidBody(slide)->joints[0];
    CHECK(now[0].columns == std::vector<std::string>{"position [m]", "velocity [m/s]", "force [N]", "load [N]"});
    CHECK(now[0].values == std::vector<double>{joint.position, joint.velocity, joint.force, joint.load});
    CHECK(joint.position > 0.01);
    const BloodBalance blood = sim.blood(organ);
    CHECK(now[1].values == std::vector<double>{blood.welled, blood.onTissue, blood.rate});
    CHECK(blood.welled > 0.0);
    const HeatBalance heat = sim.heat(organ);
    CHECK(now[2].values == std::vector<double>{heat.hottest, heat.burnt, heat.charred, heat.delivered});
    CHECK(heat.hottest > 310.5);
    const EnergyBalance energy = sim.energy(slide);
    CHECK(now[3].values == std::vector<double>{energy.active, energy.inAir, energy.delivered});
    CHECK(energy.inAir > 0.0);
    CHECK(energy.delivered > 0.0);
    CHECK(sim.energy(slide).active > 0.2);
}

TEST_CASE("sensors: a body that was removed reads as NaN, and its cells are empty", "[sensors]")
{
    const std::string file = temporary("_removed.csv");
    BallOnFloor scene;
    // Before the sensors: they read a state of the step before, which has the ball.
    scene.sim.everyStep([&](double time) {
        if (std::fabs(time - 0.005) < 1e-9) scene.sim.physics().remove(scene.ball);
    });
    Sensors sensors(scene.sim, {.sensors = {{"ball", PositionSensor{.body = scene.ball}},
                                            {"force", ContactForceSensor{scene.ball}},
                                            {"energy", EnergySensor{scene.ball}},
                                            {"floor", PositionSensor{.body = scene.floor}}},
                                .rate = 1000,
                                .file = file});
    static_cast<void>(scene.sim.run({.headless = true, .steps = 10}));
    sensors.close();
    CHECK(sensors.lines() == 10);
    const std::vector<std::string> lines = linesOf(file);
    std::filesystem::remove(file);
    REQUIRE(lines.size() == 11);
    for (const std::size_t column : {1U, 4U, 8U}) {
        CHECK(std::isfinite(numbersOf(lines[1])[column]));
        CHECK(std::isnan(numbersOf(lines[10])[column]));
    }
    CHECK(numbersOf(lines[10]).at(12) == Approx(-0.05));
    CHECK(std::isnan(sensors.read()[0].values[0]));
}

TEST_CASE("sensors: what can read nothing is refused, by name, field and bound", "[sensors]")
{
    BallOnFloor scene;
    const BodyId soft = scene.sim.add(SoftBodyDef{.name = "soft", .mesh = shapes::block({1, 1, 1}, {1, 1, 1})});
    const auto wrong = [&](const SensorKind& kind) { return errorOf(scene.sim, {.sensors = {{"s", kind}}}); };
    CHECK(errorOf(scene.sim, {}) == "sensors: there must be 1 to 1000 sensors, got 0");
    CHECK(wrong(PositionSensor{}) == "sensors: sensors[0].body must be one of the simulation");
    CHECK(wrong(PositionSensor{.body = scene.ball, .element = 1}) ==
          "sensors: sensors[0].element must be in [0, 1), got 1");
    CHECK(wrong(PositionSensor{.body = soft, .node = 8}) == "sensors: sensors[0].node must be in [0, 8), got 8");
    CHECK_THAT(wrong(VelocitySensor{.body = scene.ball, .node = 0}),
               Catch::Contains("node must not be given for a rigid body"));
    CHECK_THAT(wrong(PositionSensor{.body = soft, .tip = {0, 0, 1}}),
               Catch::Contains("tip must not be given for soft body 'soft'"));
    CHECK(wrong(ContactForceSensor{soft, soft}) == "sensors: sensors[0].with must differ from body");
    CHECK(wrong(AttachmentForceSensor{soft, BodyId{99}}) == "sensors: sensors[0].to must be a body of the simulation");
    CHECK_THAT(wrong(JointSensor{scene.ball}),
               Catch::Contains("body must be an articulated one, got rigid body 'ball'"));
    CHECK_THAT(wrong(CavitySensor{soft}), Catch::Contains("body must have cavities, got soft body 'soft'"));
    CHECK(wrong(DuctSensor{soft}) == "sensors: sensors[0].body must have a duct, got soft body 'soft'");
    CHECK(wrong(ContactForceSensor{soft}) ==
          "sensors: sensors[0].body must collide, got soft body 'soft', which has no collision");
    CHECK_THAT(wrong(ContactForceSensor{scene.ball, soft}), Catch::Contains("with must collide, got soft body 'soft'"));
    CHECK_THAT(wrong(AttachmentForceSensor{.body = soft, .to = scene.ball, .space = true}),
               Catch::Contains("to must not be given with space"));
    CHECK_THAT(errorOf(scene.sim, {.sensors = {{"a\nb", EnergySensor{soft}}}}),
               Catch::Contains("sensors[0]: name must"));
    CHECK_THAT(wrong(BloodSensor{soft}), Catch::Contains("body must be one that bleeds, got soft body 'soft'"));
    CHECK_THAT(wrong(HeatSensor{soft}), Catch::Contains("body must be one that burns"));
    CHECK_THAT(wrong(ElectrodeSensor{scene.ball}), Catch::Contains("body must have an electrode"));
    CHECK(wrong(FluidSensor{}) == "sensors: sensors[0].type must not be FluidSensor: no fluid distends a cavity");
    CHECK(errorOf(scene.sim, {.sensors = {{"s", PositionSensor{.body = soft}}, {"s", EnergySensor{soft}}}}) ==
          "sensors: sensors[1].name must differ from those before it, got 's'");
    CHECK_THAT(errorOf(scene.sim, {.sensors = {{"s", PositionSensor{.body = soft}}}, .rate = 0}),
               Catch::Contains("rate must be in [0.001, 100000] Hz, got 0"));
    CHECK(errorOf(scene.sim, {.sensors = {{"s", PositionSensor{.body = soft}}}, .file = "a.txt"}) ==
          "sensors: file must end in .csv, got 'a.txt'");
    CHECK_THAT(errorOf(scene.sim, {.sensors = {{"s", PositionSensor{.body = soft}}}, .file = "/no folder/a.csv"}),
               Catch::Contains("/no folder/a.csv"));
}

TEST_CASE("sensors: a full disk ends the table and not the run, and a written table goes on in time only", "[sensors]")
{
    BallOnFloor scene;
    std::vector<std::string> failures;
    scene.sim.on<FileFailedEvent>([&](const FileFailedEvent& failure) { failures.push_back(failure.problem); });
    setLogSink([](LogLevel, std::string_view) {});
    const std::string file = temporary("_full.csv");
    std::filesystem::create_symlink("/dev/full", file);
    Sensors sensors(scene.sim, {.sensors = {{"ball", PositionSensor{.body = scene.ball}}}, .rate = 1000, .file = file});
    runtime::SteppedRun run(scene.sim);
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!sensors.failed() && std::chrono::steady_clock::now() < until) run.step();
    const auto state = run.save();
    CHECK_THROWS_WITH(run.restore(*state), Catch::Contains("where time only goes on"));
    run.step();
    static_cast<void>(run.end());
    sensors.close();
    setLogSink({});
    std::filesystem::remove(file);
    CHECK(sensors.failed());
    CHECK(sensors.lines() == 0);
    REQUIRE(failures.size() == 1);
    CHECK_THAT(failures[0], Catch::StartsWith("sensors: ") && Catch::EndsWith("; the run goes on without them"));
}

} // namespace sensors_test

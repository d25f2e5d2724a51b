#include "filasofia/runtime/engines.h"

#include "filasofia/filasofia.h"
#include "filasofia/runtime/replay.h"
#include "filasofia/sofa/sofa_engine.h"

#include <unistd.h>

#include <filesystem>

namespace engines_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

SoftBodyDef bunny()
{
    return {.name = "bunny",
            .mesh = asset("meshes/bunny_756.msh"),
            .material = FemMaterial{.law = Corotational{}},
            .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}}};
}

/// A recording of some steps, removed at the end.
struct RecordedRun {
    std::string file =
        (std::filesystem::temp_directory_path() / text("filasofia_engines_test_", getpid(), ".rec")).string();
    explicit RecordedRun(const record::RecordingHeader& header)
    {
        record::RecordingWriter writer(file, header);
        writer.write(physics::StepRecord{.report = {.step = 1, .dt = 1e-3}});
        writer.close();
    }
    ~RecordedRun() { std::filesystem::remove(file); }
};

} // namespace

TEST_CASE("engines are known by name, and an unknown one is refused with the known ones")
{
    CHECK(engineNames() == std::vector<std::string>{"native", "sofa"});
    const auto native = makeEngine("native", {});
    const physics::EngineInfo info = native->info();
    CHECK((info.name == "native" && info.repeatable && info.deadline && info.cuts && info.joints));
    CHECK_FALSE(info.version.empty());
    CHECK_THROWS_WITH(makeEngine("sofo", {}), "engine must be native or sofa, got 'sofo' (did you mean 'sofa'?)");
    CHECK_THROWS_WITH(Simulation({.engine = "bullet"}), "simulation: engine must be native or sofa, got 'bullet'");
}

TEST_CASE("an engine that is not built in says how to get it")
{
    if (sofaengine::isBuiltIn()) return;
    CHECK_THROWS_WITH(Simulation({.engine = "sofa"}), Catch::Contains("simulation: engine 'sofa' is not built in") &&
                                                          Catch::Contains("FILASOFIA_SOFA=ON"));
}

TEST_CASE("the option --engine chooses the engine of any simulator")
{
    const auto run = [](std::vector<const char*> words) {
        Simulation sim;
        sim.add(bunny());
        words.insert(words.begin(), "program");
        const int code = sim.run(static_cast<int>(words.size()), words.data());
        return std::pair(code, sim.physics().hash());
    };
    const auto plain = run({"--headless", "--steps", "5"});
    CHECK(plain.first == 0);
    CHECK(run({"--headless", "--steps", "5", "--engine", "native"}) == plain);
    CHECK(run({"--headless", "--steps", "5", "--engine", "bullet"}).first == 2);
    if (!sofaengine::isBuiltIn()) CHECK(run({"--headless", "--steps", "5", "--engine", "sofa"}).first == 2);
}

TEST_CASE("the engine cannot change during a run, nor after it")
{
    Simulation sim;
    sim.add(bunny());
    CHECK_THROWS_WITH(sim.useEngine("sofo"), Catch::Contains("must be native or sofa"));
    sim.useEngine("native");
    sim.run({.headless = true, .steps = 2});
    if (sofaengine::isBuiltIn())
        CHECK_THROWS_WITH(sim.useEngine("sofa"), Catch::Contains("cannot be replaced after a step"));
}

TEST_CASE("a recording names its engine, and one that does not repeat is not replayed")
{
    {
        const RecordedRun native({.period = 1e-3});
        CHECK(record::readRecording(native.file).header.engine == "native");
        CHECK(replay({.file = native.file}).made == 1);
    }
    for (const char* name : {"sofa", "bullet"}) {
        const RecordedRun other({.engine = name, .period = 1e-3});
        CHECK(record::readRecording(other.file).header.engine == name);
        CHECK_THROWS_WITH(replay({.file = other.file}),
                          other.file + ": was recorded with the engine '" + name +
                              "', which does not repeat its steps bit for bit: only a recording of the native engine "
                              "can be replayed");
    }
}

} // namespace engines_test

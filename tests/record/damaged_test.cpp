#include "filasofia/core/error.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "physics/fake_engine.h"
#include "record/runs.h"

#include <sys/stat.h>

using namespace filasofia;
using namespace filasofia::physics;

namespace {

/// The lines of a recording of two steps: header, mesh, step 1 (gravity, body), step 2 (every other command).
std::vector<std::string> smallRecording()
{
    const record::ScratchFile file("small.rec");
    {
        PhysicsServer server(engine::makeNativeEngine());
        server.keepLog(true);
        server.hashEveryStep(true);
        const BodyId soft = server.add(SoftBodyDef{
            .name = "liver",
            .mesh = oneTetrahedron(),
            .attachments = {{.nodes = {0}}, {.box = geometry::Box{{0, 0, 0}, {2, 2, 2}}, .stiffness = 10}}});
        const BodyId rigid = server.add(RigidBodyDef{.name = "forceps"});
        server.step(1e-3);
        server.setPose(rigid, {{1, 2, 3}, {}});
        server.setMaterial(soft, FemMaterial{.youngModulus = 5e3});
        server.setForces(soft, {{.node = 1, .force = {0, 1, 0}}});
        server.setPressure(soft, 1);
        server.reset();
        server.pause(true);
        server.remove(rigid);
        server.step(1e-3);
        record::RecordingWriter writer(file.path(), {});
        for (int step = 0; step < 2; ++step) {
            writer.write(*server.nextRecord());
            server.popRecord();
        }
    }
    return file.lines();
}

std::string joined(const std::vector<std::string>& lines)
{
    std::string all;
    for (const std::string& line : lines) all += line + '\n';
    return all;
}

/// The message with which a file of these bytes is refused, without the file's name; empty where it is not.
std::string refusal(const std::string& bytes)
{
    const record::ScratchFile file("damaged.rec");
    file.write(bytes);
    try {
        record::readRecording(file.path());
        return {};
    } catch (const Error& error) {
        const std::string said = error.what();
        REQUIRE(said.substr(0, file.name().size()) == file.name());
        return said.substr(file.name().size());
    }
}

/// The refusal of the small recording with the first `what` of a line (counted from 1) replaced.
std::string refusal(std::size_t line, const std::string& what, const std::string& by)
{
    auto lines = smallRecording();
    REQUIRE(lines.size() == 4);
    const auto place = lines[line - 1].find(what);
    REQUIRE(place != std::string::npos);
    lines[line - 1].replace(place, what.size(), by);
    return refusal(joined(lines));
}

} // namespace

TEST_CASE("the small recording itself is whole and can be made again")
{
    const record::ScratchFile file("whole.rec");
    file.write(joined(smallRecording()));
    CHECK_FALSE(record::replay(record::readRecording(file.path()).steps, *engine::makeNativeEngine()));
}

TEST_CASE("what is no recording says so")
{
    CHECK(refusal("") == ": is empty, no recording");
    CHECK_THAT(refusal("\n"), Catch::StartsWith(":1: this is no line of a recording"));
    CHECK_THAT(refusal("step,time\n1,2\n"), Catch::StartsWith(":1: this is no line of a recording"));
    CHECK(refusal("[1]\n") == ":1: a line must be an object");
    CHECK(refusal("{}\n") == ":1: this is no Filasofia recording");
    CHECK(refusal("{\"format\":\"something else\",\"version\":1}\n") == ":1: this is no Filasofia recording");
    CHECK_THROWS_WITH(record::readRecording("/no/such/file.rec"), "/no/such/file.rec: cannot be read");
    CHECK_THROWS_WITH(record::readRecording("/tmp"), "/tmp: is a folder");
    CHECK_THROWS_WITH(record::readRecording("/dev/zero"), "/dev/zero: is no regular file");
    const record::ScratchFile pipe("pipe.rec");
    REQUIRE(mkfifo(pipe.path().c_str(), 0600) == 0);
    CHECK_THROWS_WITH(record::readRecording(pipe.path()), pipe.name() + ": is no regular file");
}

TEST_CASE("a recording of another version says so")
{
    CHECK(refusal(1, "\"version\":3", "\"version\":1") ==
          ":1: the recording is of version 1, this Filasofia reads version 3");
    CHECK_THAT(refusal(1, "\"version\":3", "\"version\":\"1\""), Catch::Contains("version must be a whole number"));
}

TEST_CASE("a line without one of its fields names the field")
{
    CHECK(refusal(1, ",\"period\":0.001", "") == ":1: field 'period' is missing");
    CHECK(refusal(1, "\"revision\"", "\"x\"") == ":1: field 'revision' is missing");
    CHECK(refusal(1, "\"simd\"", "\"x\"") == ":1: field 'simd' is missing");
    for (const std::string field : {"step", "dt", "flags", "hash", "iterations", "commands"})
        CHECK(refusal(3, "\"" + field + "\"", "\"x\"") == ":3: field '" + field + "' is missing");
    CHECK(refusal(2, "\"tetrahedra\"", "\"x\"") == ":2: field 'tetrahedra' is missing");
    CHECK(refusal(3, "\"youngModulus\"", "\"x\"") ==
          ":3: field 'commands[1].AddBody.def.SoftBodyDef.material.FemMaterial.youngModulus' is missing");
}

TEST_CASE("a field that does not belong is named")
{
    CHECK(refusal(1, "\"period\"", "\"color\":3,\"period\"") == ":1: unknown field 'color'");
    CHECK(refusal(4, "\"dt\"", "\"color\":3,\"dt\"") == ":4: unknown field 'color'");
    CHECK(refusal(3, "\"gravity\":[", "\"color\":3,\"gravity\":[") ==
          ":3: unknown field 'color' in commands[0].SetGravity");
    CHECK(refusal(4, "\"SetPressure\"", "\"SetColor\"") == ":4: unknown field 'SetColor' in commands[3]");
}

TEST_CASE("a value of the wrong kind is named with what it must be")
{
    CHECK(refusal(3, "\"dt\":0.001", "\"dt\":\"soon\"") == ":3: dt must be a number, got \"soon\"");
    CHECK(refusal(3, "\"dt\":0.001", "\"dt\":null") == ":3: dt must be a number, got null");
    CHECK_THAT(refusal(3, "\"step\":1", "\"step\":-1"), Catch::Contains(":3: step must be a whole number in [0, "));
    CHECK_THAT(refusal(3, "\"step\":1", "\"step\":1.5"), Catch::Contains("got 1.5"));
    CHECK_THAT(refusal(3, "\"flags\":0", "\"flags\":4294967296"), Catch::Contains("flags must be a whole number"));
    CHECK_THAT(refusal(3, "\"hash\":\"", "\"hash\":\"x"), Catch::Contains("hash must be 16 hexadecimal digits"));
    CHECK_THAT(refusal(3, "\"iterations\":[", "\"iterations\":[-1,"), Catch::Contains("iterations must be >= 0"));
    CHECK(refusal(4, "\"paused\":true", "\"paused\":1") == ":4: commands[5].Pause.paused must be true or false, got 1");
    CHECK(refusal(3, "\"mesh\":0", "\"mesh\":1") == ":3: commands[1].AddBody.def.SoftBodyDef.mesh must be the number "
                                                    "of a mesh of its kind on a line before, got 1");
    CHECK(refusal(2, "\"mesh\":0", "\"mesh\":1") == ":2: mesh must be 0, the next number, got 1");
    CHECK_THAT(refusal(2, "[0,1,2,3]", "[0,1,2]"), Catch::StartsWith(":2: tetrahedra[0] must be a list of 4"));
    CHECK_THAT(refusal(2, "[1.0,0.0,0.0]", "[1.0]"), Catch::StartsWith(":2: nodes[1] must be a list of 3"));
    CHECK_THAT(refusal(4, "{\"Reset\":{}}", "\"Reset\""),
               Catch::Contains("commands[4] must be an object with one name"));
    CHECK_THAT(refusal(3, "\"dt\":0.001", "\"dt\":1e999"), Catch::StartsWith(":3: this is no line of a recording"));
}

TEST_CASE("a file that is cut off inside a line says after which step")
{
    const std::string whole = joined(smallRecording());
    CHECK(refusal(whole.substr(0, whole.size() - 5)) == ":4: the file is cut off after step 1");
    CHECK(refusal(whole.substr(0, whole.size() - 1)).empty()); // only the line break is gone
}

TEST_CASE("ids of attachments that run over are refused")
{
    auto lines = smallRecording();
    const std::string was = "\"attachments\":1";
    const auto place = lines[2].find(was);
    REQUIRE(place != std::string::npos);
    lines[2].replace(place, was.size(), "\"attachments\":4294967295"); // the body has two
    const record::ScratchFile file("ids.rec");
    file.write(joined(lines));
    CHECK_THROWS_WITH(record::replay(record::readRecording(file.path()).steps, *engine::makeNativeEngine()),
                      "step 1: attachment 4294967295: must be <= 4294967294: 2 ids follow from it");
}

TEST_CASE("the steps before a damaged line can be made again")
{
    auto lines = smallRecording();
    lines[3] = "{";
    const record::ScratchFile file("crashed.rec");
    file.write(joined(lines));
    record::RecordingReader reader(file.path());
    const auto engine = engine::makeNativeEngine();
    record::Replayer replayer(*engine);
    const auto step = reader.next();
    REQUIRE(step);
    replayer.step(*step);
    CHECK(engine->hash() == step->hash);
    CHECK_THROWS_WITH(reader.next(), Catch::Contains(":4: this is no line of a recording"));
}

TEST_CASE("whatever the bytes of a recording, it is read and made again or refused")
{
    const std::string whole = joined(smallRecording());
    const record::ScratchFile file("fuzzed.rec");
    std::mt19937 random(11);
    const auto below = [&](std::size_t bound) {
        return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
    };
    const std::string likely = "0123456789-.eE{}[]\",:";
    int refused = 0;
    for (int round = 0; round < 1500; ++round) {
        std::string bytes = whole;
        for (std::size_t changes = 1 + below(3); changes-- > 0;) {
            const std::size_t place = below(bytes.size());
            switch (below(4)) {
            case 0:
                bytes[place] = static_cast<char>(below(256));
                break;
            case 1:
                bytes[place] = likely[below(likely.size())];
                break;
            case 2:
                bytes.erase(place, 1 + below(8));
                break;
            default:
                bytes.insert(place, bytes.substr(below(bytes.size()), 1 + below(30)));
            }
        }
        file.write(bytes);
        try {
            record::replay(record::readRecording(file.path()).steps, *engine::makeNativeEngine());
        } catch (const Error&) {
            ++refused;
        }
    }
    CHECK(refused > 500);
}

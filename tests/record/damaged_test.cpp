#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "physics/fake_engine.h"
#include "record/runs.h"

#include <sys/stat.h>

namespace damaged_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

/// The lines of a recording of two steps: header, mesh, step 1 (gravity, body), step 2 (every other command), end.
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
    return file.records();
}

std::string joined(const std::vector<std::string>& lines)
{
    std::string all;
    for (const std::string& line : lines) all += line + '\n';
    return all;
}

/// The message with which a file of these bytes is refused, without the file's name and the part that is complete;
/// empty if it is accepted.
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
        return said.substr(file.name().size(), said.rfind("; it ") - file.name().size());
    }
}

/// The refusal of the small recording with the first `what` of a line (counted from 1) replaced.
std::string refusal(std::size_t line, const std::string& what, const std::string& by)
{
    auto lines = smallRecording();
    REQUIRE(lines.size() == 5);
    const auto place = lines[line - 1].find(what);
    REQUIRE(place != std::string::npos);
    lines[line - 1].replace(place, what.size(), by);
    return refusal(record::framed(joined(lines)));
}

} // namespace

TEST_CASE("the small recording itself is complete and can be replayed")
{
    const record::ScratchFile file("whole.rec");
    file.write(record::framed(joined(smallRecording())));
    CHECK_FALSE(record::replay(record::readRecording(file.path()).steps, *engine::makeNativeEngine()));
}

TEST_CASE("a file that is not a recording is refused as such")
{
    CHECK(refusal("") == ": must be a recording, got an empty file");
    for (const char* bytes :
         {"\n", "step,time\n1,2\n", "[1]\n", "{}\n", "{\"format\":\"something else\",\"version\":1}\n",
          "filasofia recording, version x\n", "filasofia recording, version 6", "{{{{{{{{"})
        CHECK_THAT(refusal(bytes),
                   Catch::StartsWith(": this is not a Filasofia recording") || Catch::StartsWith(": cut off at byte "));
    CHECK(refusal("filasofia rec") == ": cut off at byte 13, before the header of the recording");
    CHECK(refusal(record::openingLine()) == ": cut off at byte 31, before the end of the session");
    CHECK_THROWS_WITH(record::readRecording("/no/such/file.rec"), "/no/such/file.rec: no such file");
    CHECK_THROWS_WITH(record::readRecording("/tmp"), "/tmp: must be a file, got a directory");
    CHECK_THROWS_WITH(record::readRecording("/dev/zero"), "/dev/zero: is not a regular file");
    const record::ScratchFile pipe("pipe.rec");
    REQUIRE(mkfifo(pipe.path().c_str(), 0600) == 0);
    CHECK_THROWS_WITH(record::readRecording(pipe.path()), pipe.name() + ": is not a regular file");
}

TEST_CASE("a recording of another version is refused with that version and, if known, the program that wrote it")
{
    CHECK(refusal("filasofia recording, version 12\n???") ==
          ": the recording has version 12, but this Filasofia reads version 6");
    CHECK(refusal(R"({"format":"filasofia recording","version":3,"filasofia":"0.1.0","revision":"abc"})"
                  "\n") == ": the recording has version 3, but this Filasofia reads version 6; Filasofia "
                           "0.1.0, revision abc, wrote it and can replay it");
}

TEST_CASE("a record without one of its fields names the field")
{
    for (const std::string field :
         {"filasofia", "revision", "simd", "period", "contact", "seed", "session", "trainee", "date"})
        CHECK(refusal(1, "\"" + field + "\"", "\"x\"") == ": record 1: field '" + field + "' is missing");
    CHECK(refusal(3, "\"dt\"", "\"x\"") ==
          ": record 3: field 'dt' is missing"); // later steps use that of the step before
    for (const std::string field : {"hash", "commands"})
        CHECK(refusal(3, "\"" + field + "\"", "\"x\"") == ": record 3: unknown field 'x'");
    CHECK(refusal(2, "\"tetrahedra\"", "\"triangles\"") == ": record 2: field 'vertices' is missing");
    CHECK(refusal(2, "\"digest\"", "\"x\"") == ": record 2: field 'digest' is missing");
    CHECK(refusal(3, "\"youngModulus\"", "\"x\"") ==
          ": record 3: field 'commands[1].AddBody.def.SoftBodyDef.material.FemMaterial.youngModulus' is missing");
}

TEST_CASE("fields that a recording of another revision does not have get their defaults, which the log tells once")
{
    auto lines = smallRecording();
    const std::string friction = "\"friction\":0.3,",
                      revision = text("\"revision\":\"", record::sourceRevision(), "\"");
    for (const auto& [line, field] : {std::pair{2, friction}, {2, std::string("\"nodes\":[0],")}, {0, revision}}) {
        const auto place = lines[line].find(field);
        REQUIRE(place != std::string::npos);
        lines[line].replace(place, field.size(), field == revision ? "\"revision\":\"abc\"" : "");
    }
    const record::ScratchFile file("older.rec");
    file.write(record::framed(joined(lines)));
    std::vector<std::string> logged;
    setLogSink([&](LogLevel, std::string_view line) { logged.emplace_back(line); });
    const record::Recording read = record::readRecording(file.path());
    setLogSink({});
    const auto& def = *std::get<AddBody>(read.steps.front().commands[1]).def;
    CHECK(std::get<SoftBodyDef>(def).friction == SoftBodyDef{}.friction);
    CHECK(std::get<SoftBodyDef>(def).attachments.front().nodes.empty());
    const auto told = [&](const char* field) {
        return text(file.name(), ": another revision wrote it; it has no ", field, ", which gets its default");
    };
    CHECK(logged == std::vector{told("AttachmentDef.nodes"), told("SoftBodyDef.friction")});
    // What is newer than the reader is refused as always, and both programs are named.
    lines[2].insert(lines[2].find("\"pressure\""), "\"color\":3,");
    CHECK(refusal(record::framed(joined(lines))).find("unknown field 'color'") != std::string::npos);
    CHECK_THAT(refusal(record::framed(joined(lines))),
               Catch::EndsWith(text("revision abc, wrote it; this is revision ", record::sourceRevision(), ")")));
}

TEST_CASE("a field that does not belong is named")
{
    CHECK(refusal(1, "\"period\"", "\"color\":3,\"period\"") == ": record 1: unknown field 'color'");
    CHECK(refusal(4, "\"hash\"", "\"color\":3,\"hash\"") == ": record 4: unknown field 'color'");
    CHECK(refusal(3, "\"gravity\":[", "\"color\":3,\"gravity\":[") ==
          ": record 3: unknown field 'color' in commands[0].SetGravity");
    CHECK(refusal(4, "\"SetPressure\"", "\"SetColor\"") == ": record 4: unknown field 'SetColor' in commands[3]");
}

TEST_CASE("a value of the wrong kind is named with what it must be")
{
    CHECK(refusal(3, "\"dt\":0.001", "\"dt\":\"soon\"") == ": record 3: dt must be a number, got \"soon\"");
    CHECK(refusal(3, "\"dt\":0.001", "\"dt\":null") == ": record 3: dt must be a number, got null");
    CHECK_THAT(refusal(3, "\"dt\"", "\"step\":-1,\"dt\""),
               Catch::Contains(": record 3: step must be a whole number in [0, "));
    CHECK_THAT(refusal(3, "\"dt\"", "\"step\":1.5,\"dt\""), Catch::Contains("got 1.5"));
    CHECK_THAT(refusal(3, "\"dt\"", "\"flags\":4294967296,\"dt\""), Catch::Contains("flags must be a whole number"));
    CHECK_THAT(refusal(3, "\"hash\":\"", "\"hash\":\"x"), Catch::Contains("hash must be 16 hexadecimal digits"));
    CHECK_THAT(refusal(3, "\"iterations\":[", "\"iterations\":[-1,"), Catch::Contains("iterations must be >= 0"));
    CHECK(refusal(4, "\"paused\":true", "\"paused\":1") ==
          ": record 4: commands[5].Pause.paused must be true or false, got 1");
    CHECK(refusal(3, "\"mesh\":0", "\"mesh\":1") ==
          ": record 3: commands[1].AddBody.def.SoftBodyDef.mesh must be the number "
          "of a mesh of its kind on an earlier line, got 1");
    CHECK(refusal(2, "\"mesh\":0", "\"mesh\":1") == ": record 2: mesh must be 0, the number of the next mesh, got 1");
    CHECK_THAT(refusal(2, "\"nodes\":4", "\"nodes\":-4"),
               Catch::StartsWith(": record 2: nodes must be a whole number"));
    CHECK(refusal(2, "\"nodes\":4", "\"nodes\":999999999") == ": record 2: nodes must be <= 268435456, got 999999999");
    CHECK_THAT(refusal(2, "\"nodes\":4", "\"nodes\":3"), Catch::StartsWith(": record 2: mesh 0: its digest must be "));
    CHECK_THAT(refusal(2, "\"nodes\":4", "\"nodes\":200000000"), Catch::StartsWith(": cut off at byte "));
    CHECK_THAT(refusal(4, "{\"Reset\":{}}", "\"Reset\""),
               Catch::Contains("commands[4] must be an object with one member"));
    CHECK_THAT(refusal(3, "\"dt\":0.001", "\"dt\":1e999"), Catch::StartsWith(": record 3: this is not a record"));
}

TEST_CASE("the session's end tells how many steps there are, and nothing follows it")
{
    CHECK(refusal(5, "2", "3") == ": record 5: the end of the session announces 3 steps, but the file holds 2");
    CHECK(refusal(5, "\"end\"", "\"x\":1,\"end\"") == ": record 5: unknown field 'x'");
    const std::string whole = joined(smallRecording());
    CHECK(refusal(record::framed(whole + "{}\n")) == ": record 5: the file must end after the end of the session");
    CHECK(refusal(record::framed(whole.substr(0, whole.size() - 1))).starts_with(": cut off at byte "));
}

TEST_CASE("ids of attachments that overflow are refused")
{
    auto lines = smallRecording();
    const std::string was = "\"attachments\":1";
    const auto place = lines[2].find(was);
    REQUIRE(place != std::string::npos);
    lines[2].replace(place, was.size(), "\"attachments\":4294967295"); // the body has two
    const record::ScratchFile file("ids.rec");
    file.write(record::framed(joined(lines)));
    CHECK_THROWS_WITH(
        record::replay(record::readRecording(file.path()).steps, *engine::makeNativeEngine()),
        "step 1: attachment 4294967295: id must be <= 4294967294 to leave room for 2 ids, got 4294967295");
}

TEST_CASE("the steps before a damaged line can be replayed")
{
    auto lines = smallRecording();
    lines[3] = "{";
    const record::ScratchFile file("crashed.rec");
    file.write(record::framed(joined(lines)));
    record::RecordingReader reader(file.path());
    const auto engine = engine::makeNativeEngine();
    record::Replayer replayer(*engine);
    const auto step = reader.next();
    REQUIRE(step);
    replayer.step(*step);
    CHECK(engine->hash() == step->hash);
    for (int again = 0; again < 2; ++again)
        CHECK_THROWS_WITH(reader.next(), Catch::Contains(": record 4: this is not a record") &&
                                             Catch::EndsWith("; it is complete up to step 1"));
}

TEST_CASE("whatever the bytes of a recording, it is read and replayed or refused")
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
        file.write(record::framed(bytes, 1 + below(5000)));
        try {
            record::replay(record::readRecording(file.path()).steps, *engine::makeNativeEngine());
        } catch (const Error&) {
            ++refused;
        }
    }
    CHECK(refused > 500);
}

} // namespace damaged_test

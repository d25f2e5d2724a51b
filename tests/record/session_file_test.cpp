#include "filasofia/core/error.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/json_limits.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "filasofia/record/session_player.h"
#include "physics/fake_engine.h"
#include "record/round_trip.h"

#include <iostream>

namespace session_file_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::record_test;

namespace {

constexpr int kSteps = 6;

/// A small session in chunks of two steps: a body, what is drawn of it, commands, and an end. Returns its bytes.
std::string smallSession()
{
    const record::ScratchFile file("session.rec");
    PhysicsServer server(engine::makeNativeEngine());
    server.keepLog(true);
    server.hashEveryStep(true);
    const BodyId soft = server.add(SoftBodyDef{.mesh = oneTetrahedron(), .attachments = {{.nodes = {0}}}});
    record::RecordingWriter writer(
        file.path(), {.seed = 7, .session = "first", .trainee = "A \"B\"\n<b>", .date = "2026-11-20 18:05:31"});
    const auto surface = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}, .uv = {}});
    writer.write(record::SceneRecord{.words = R"({"shown":1})", .surfaces = {surface}});
    for (int step = 1; step <= kSteps; ++step) {
        server.setPressure(soft, step / 3.0);
        server.step(1e-3);
        writer.write(*server.nextRecord());
        server.popRecord();
        if (step % 2 == 0) writer.flush();
    }
    writer.write(record::SceneRecord{.words = R"({"gone":1})"});
    writer.close();
    return file.bytes();
}

/// The steps of a whole session's file.
std::vector<StepRecord> stepsOf(const std::string& bytes)
{
    const record::ScratchFile file("whole.rec");
    file.write(bytes);
    return record::readRecording(file.path()).steps;
}

bool same(const StepRecord& a, const StepRecord& b)
{
    return a.report.step == b.report.step && sameBits(a.report.dt, b.report.dt) && a.hash == b.hash &&
           a.commands.size() == b.commands.size();
}

/// Checks that what can be read of these bytes is the beginning of the session, and that an early end is reported.
/// Returns the number of steps.
std::size_t checkBeginning(const record::ScratchFile& file, const std::vector<StepRecord>& all)
{
    try {
        const record::Recording found = record::readUpToDamage(file.path());
        REQUIRE(found.steps.size() <= all.size());
        for (std::size_t i = 0; i < found.steps.size(); ++i) REQUIRE(same(found.steps[i], all[i]));
        REQUIRE_FALSE(found.damage.empty());
        REQUIRE(found.damage.substr(0, file.name().size()) == file.name());
        const auto tells = found.steps.empty() ? std::string("it has no complete step")
                                               : text("it is complete up to step ", found.steps.back().report.step);
        REQUIRE_THAT(found.damage, Catch::EndsWith(tells));
        return found.steps.size();
    } catch (const Error& refused) {
        REQUIRE_THAT(refused.what(), Catch::StartsWith(file.name()));
        return 0;
    }
}

/// The refusal of a recording of one step with these words.
std::string refusalOf(const std::string& words)
{
    const record::ScratchFile file("hostile.rec");
    std::string content;
    {
        record::RecordingWriter(file.path(), {}).close();
        content = file.content();
    }
    content.erase(content.find("{\"end\""));
    file.write(record::framed(content + words));
    return record::readUpToDamage(file.path()).damage.substr(file.name().size());
}

} // namespace

TEST_CASE("a session comes back whole: names, seed, scene and steps")
{
    const record::ScratchFile file("back.rec");
    file.write(smallSession());
    record::RecordingReader reader(file.path());
    CHECK(reader.header().seed == 7);
    CHECK(reader.header().session == "first");
    CHECK(reader.header().trainee == "A \"B\"\n<b>");
    CHECK(reader.header().date == "2026-11-20 18:05:31");
    CHECK(reader.takeScene().empty());
    REQUIRE(reader.next());
    const auto scene = reader.takeScene();
    REQUIRE(scene.size() == 1);
    CHECK(scene[0].words == R"({"shown":1})");
    REQUIRE(scene[0].surfaces.size() == 1);
    CHECK(scene[0].surfaces[0]->triangles.size() == 1);
    int steps = 1;
    for (; reader.next(); ++steps) CHECK(reader.takeScene().empty());
    CHECK(steps == kSteps);
    REQUIRE(reader.takeScene().size() == 1); // it came after the last step
    CHECK_FALSE(reader.next());
}

TEST_CASE("a session cut off at any byte is read up to there, and says so")
{
    const std::string whole = smallSession();
    const auto all = stepsOf(whole);
    REQUIRE(all.size() == kSteps);
    const record::ScratchFile file("cut.rec");
    std::size_t most = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
        file.write(whole.substr(0, length));
        const std::size_t steps = checkBeginning(file, all);
        REQUIRE(steps >= most); // complete steps stay complete
        most = steps;
    }
    CHECK(most == kSteps);
}

TEST_CASE("a session with any byte flipped is read up to there, and says so")
{
    const std::string whole = smallSession();
    const auto all = stepsOf(whole);
    const record::ScratchFile file("flipped.rec");
    for (std::size_t place = 0; place < whole.size(); ++place)
        for (const int bits : {0x01, 0x80, 0xff}) {
            std::string bytes = whole;
            bytes[place] = static_cast<char>(bytes[place] ^ bits);
            file.write(bytes);
            checkBeginning(file, all);
        }
}

TEST_CASE("chunks that are missing, doubled or exchanged are reported")
{
    const std::string content(100, 'x');
    const record::ScratchFile file("order.rec");
    const auto refusal = [&](const std::string& chunks) -> std::string {
        file.write(record::openingLine() + chunks);
        record::ChunkReader reader(file.name());
        std::string out;
        try {
            while (reader.next(out)) {
            }
        } catch (const Error& damage) {
            return std::string(damage.what()).substr(file.name().size());
        }
        return {};
    };
    const std::string first = record::chunkOf(0, content), second = record::chunkOf(1, content);
    CHECK(refusal(first + second).empty());
    CHECK(refusal(second) == ": damaged at byte 31: chunk 0 is missing; chunk 1 is in its place");
    CHECK_THAT(refusal(first + first), Catch::EndsWith(": chunk 1 is missing; chunk 0 is in its place"));
}

TEST_CASE("a chunk cannot grow beyond its announced size, nor announce too much")
{
    const record::ScratchFile file("bomb.rec");
    const auto refusal = [&](std::string chunk, std::uint32_t size) {
        for (int i = 0; i < 4; ++i) chunk[8 + i] = static_cast<char>(size >> (8 * i) & 0xff);
        // The checksum as zlib computes it, over the fields and the content.
        std::uint32_t crc = 0xffffffff;
        for (std::size_t i = 4; i < chunk.size(); ++i) {
            if (i >= 16 && i < 20) continue;
            crc ^= static_cast<unsigned char>(chunk[i]);
            for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
        }
        crc = ~crc;
        for (int i = 0; i < 4; ++i) chunk[16 + i] = static_cast<char>(crc >> (8 * i) & 0xff);
        file.write(record::openingLine() + chunk);
        record::ChunkReader reader(file.name());
        std::string content;
        CHECK_THROWS_WITH(reader.next(content), Catch::Contains("damaged at byte 31"));
        CHECK(content.empty());
    };
    const std::string bomb = record::chunkOf(0, std::string(record::kMaximumChunk, 'x')); // 100 bytes
    CHECK(bomb.size() < 200);
    refusal(bomb, 1000);                      // holds more
    refusal(bomb, record::kMaximumChunk - 1); // holds more
    refusal(bomb, record::kMaximumChunk + 1); // announces too much
    refusal(bomb, 0xffffffff);                // announces too much
    refusal(record::chunkOf(0, "x"), 2);      // holds less
}

TEST_CASE("lists in lists, long records and crowded objects are refused before anything is built from them")
{
    CHECK_THAT(refusalOf("{\"commands\":" + std::string(100000, '[') + "\n"),
               Catch::StartsWith(": record 2: lists and objects must be nested at most 32 deep"));
    CHECK_THAT(refusalOf("]\n"), Catch::StartsWith(": record 2: this is not a record"));
    std::string crowd = "{\"x\":0";
    for (int i = 0; i < 100; ++i) crowd += text(",\"x", i, "\":0");
    CHECK_THAT(refusalOf(crowd + "}\n"), Catch::StartsWith(": record 2: an object must have at most 64 members"));
    CHECK_THAT(refusalOf("{\"x\":\"" + std::string(record::kMaximumLine, ' ') + "\"}\n"),
               Catch::StartsWith(": record 2: a record must be <= 16777216 bytes"));
    CHECK_THAT(refusalOf(std::string(record::kMaximumLine + 200000, ' ')), Catch::Contains("a record does not end"));
    CHECK_THAT(refusalOf("{\"scene\":3,\"surfaces\":[]}\n"), Catch::Contains("scene must be an object, got 3"));
    CHECK_THAT(refusalOf("{\"scene\":{},\"surfaces\":[0]}\n"), Catch::Contains("must be the number of a mesh"));
}

TEST_CASE("a record that is too long is refused by the writer too")
{
    const record::ScratchFile file("long.rec");
    record::RecordingWriter writer(file.path(), {});
    const StepRecord step = stepWith(SetForces{BodyId{1}, std::vector<NodalForce>(400000, {1, kVec})});
    CHECK_THROWS_WITH(writer.write(step), Catch::Contains("a record must be <= 16777216 bytes"));
}

TEST_CASE("a session player returns every step with its frame, and says where the file ends early")
{
    const record::ScratchFile file("player.rec");
    const std::string whole = smallSession();
    const auto native = [](const record::RecordingHeader& header) {
        return engine::makeNativeEngine({.period = header.period, .contact = header.contact});
    };
    for (const bool cut : {false, true}) {
        file.write(cut ? whole.substr(0, whole.size() - 3) : whole);
        record::SessionPlayer session(file.path(), native);
        CHECK(session.header().seed == 7);
        std::uint64_t steps = 0;
        while (session.next()) {
            ++steps;
            CHECK(session.same());
            CHECK(session.report().step == steps);
            CHECK(session.frame().step == steps);
            REQUIRE(session.frame().softBody(BodyId{1}));
            CHECK(std::get<SetPressure>(session.recorded().commands.back()).pressure ==
                  static_cast<double>(steps) / 3.0);
        }
        CHECK(steps == kSteps);
        REQUIRE(session.bodies().size() == 1);
        CHECK(session.bodies()[0].id == BodyId{1});
        CHECK(session.damage().empty() == !cut);
        CHECK_FALSE(session.next());
    }
}

TEST_CASE("a server replays a recorded session, and knows its bodies")
{
    const auto steps = stepsOf(smallSession());
    PhysicsServer server(engine::makeNativeEngine());
    record::Replayer replayer(server);
    for (const StepRecord& step : steps) {
        replayer.step(step);
        CHECK(server.hash() == step.hash);
        CHECK(server.latest()->step == step.report.step);
    }
    CHECK(server.has(BodyId{1}));
    StepRecord wrong;
    wrong.report = {.step = kSteps + 1, .dt = 1e-3};
    wrong.report.solves.resize(1);
    wrong.commands.push_back(SetPressure{BodyId{9}, 0.0});
    CHECK_THROWS_WITH(replayer.step(wrong), Catch::Contains("body 9"));
}

TEST_CASE("a minute of a moving tool at 1 kHz takes less than a tenth of 50 MB")
{
    // What takes space: a hash per step, full-precision poses that never repeat, the dt of a live run, iterations.
    for (const int tools : {0, 1}) {
        const record::ScratchFile file("minute.rec");
        std::mt19937_64 random(3);
        std::normal_distribution<double> jitter;
        constexpr int kMinute = 60000;
        {
            record::RecordingWriter writer(file.path(), {});
            for (int i = 1; i <= kMinute; ++i) {
                StepRecord step;
                step.report = {.step = static_cast<std::uint64_t>(i),
                               .dt = 1e-9 * std::round(1e6 + 2e3 * jitter(random))};
                step.report.solves = {{.body = {}, .iterations = 4 + static_cast<int>(random() % 3)}};
                step.hash = random();
                const double t = i * 1e-3;
                for (int tool = 1; tool <= tools; ++tool)
                    step.commands.push_back(
                        SetPose{BodyId{static_cast<std::uint32_t>(tool)},
                                0,
                                {{0.1 * std::sin(t), 0.1 * std::cos(1.3 * t), 0.02 * std::sin(7 * t)},
                                 axisAngle({1, 2, 3}, 0.5 * std::sin(2 * t))}});
                writer.write(step);
                if (i % 250 == 0) writer.flush();
            }
        }
        const double perStep = static_cast<double>(file.bytes().size()) / kMinute;
        std::cout << "record: " << tools << " moving tools, " << perStep << " bytes a step (bound: 83)\n";
        CHECK(perStep * 600000 <= 50e6);
        CHECK(record::readRecording(file.path()).steps.size() == kMinute);
    }
}

} // namespace session_file_test

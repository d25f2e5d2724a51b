#include "trajectories.h"

#include "filasofia/core/error.h"
#include "filasofia/metric/sampling.h"
#include "filasofia/metric/session_file.h"

#include <unistd.h>

#include <fstream>
#include <limits>
#include <sstream>

namespace session_file_test {

using namespace filasofia;
using namespace filasofia::metric;

namespace {

/// A temporary file, removed with this object.
struct TemporaryFile {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("filasofia_session_test_" + std::to_string(getpid()) + ".jsonl");
    ~TemporaryFile() { std::filesystem::remove(path); }
    void write(std::string_view text) const { std::ofstream(path, std::ios::binary) << text; }
    [[nodiscard]] std::string read() const
    {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
};

Session little()
{
    Session session = sampled(100, 0.1, minimumJerk(0.1, 0.1), [](double t) { return Vec3{t, 1.0 / 3.0, 0}; });
    session.trainee = "=<script>\"Åsa\"\n";
    session.task = "polypectomy";
    session.date = "2026-11-20 18:05";
    session.seed = 18446744073709551615u;
    session.idealPath = 0.1;
    session.forceLimit = 2.0;
    session.targets = {"polyp"};
    session.steps = {"enter", "leave"};
    session.watched = {EventKind::Tear, EventKind::Perforation};
    session.events = {{0.02, EventKind::Tear, "polyp", 1e-5}, {0.05, EventKind::Step, "enter"}};
    session.tracks.push_back(session.tracks[0]);
    session.tracks[1].role = Role::Scope;
    session.tracks[1].force = false;
    return session;
}

std::string refusal(const TemporaryFile& file)
{
    try {
        readSession(file.path);
    } catch (const Error& error) {
        const std::string line = error.what();
        CHECK(line.starts_with(file.path.string()));
        return line.substr(file.path.string().size());
    }
    return "read";
}

} // namespace

TEST_CASE("a session reads back as it was, to the bit")
{
    const TemporaryFile file;
    const Session session = little();
    writeSession(file.path, session);
    const Session back = readSession(file.path);
    CHECK(back.trainee == session.trainee);
    CHECK(back.task == session.task);
    CHECK(back.date == session.date);
    CHECK(back.seed == session.seed);
    CHECK(back.idealPath == session.idealPath);
    CHECK(back.forceLimit == session.forceLimit);
    CHECK_FALSE(back.fieldOfView);
    CHECK(back.targets == session.targets);
    CHECK(back.steps == session.steps);
    CHECK(back.watched == session.watched);
    CHECK(back.complete);
    REQUIRE(back.events.size() == 2);
    CHECK(back.events[0].kind == EventKind::Tear);
    CHECK(back.events[0].amount == 1e-5);
    CHECK(back.events[1].what == "enter");
    REQUIRE(back.tracks.size() == 2);
    CHECK(back.tracks[1].role == Role::Scope);
    REQUIRE(back.tracks[0].samples.size() == session.tracks[0].samples.size());
    for (std::size_t i = 0; i < back.tracks[0].samples.size(); ++i) {
        const Sample &a = back.tracks[0].samples[i], &b = session.tracks[0].samples[i];
        CHECK(a.time == b.time);
        CHECK(a.pose == b.pose);
        CHECK(a.force == b.force);
        CHECK(a.contacts == b.contacts);
        CHECK(std::isnan(back.tracks[1].samples[i].force.x)); // was not observed
    }
    writeSession(file.path, back);
    const std::string once = file.read();
    writeSession(file.path, readSession(file.path));
    CHECK(file.read() == once);
}

TEST_CASE("NaN comes back as NaN")
{
    const TemporaryFile file;
    Session session = little();
    session.tracks[0].samples[3].pose.position.y = std::numeric_limits<double>::quiet_NaN();
    session.tracks[0].samples[4].force.x = std::numeric_limits<double>::infinity();
    writeSession(file.path, session);
    const Session back = readSession(file.path);
    CHECK(std::isnan(back.tracks[0].samples[3].pose.position.y));
    CHECK(std::isnan(back.tracks[0].samples[4].force.x));
}

TEST_CASE("a session cut off at any byte is read up to there, or refused in one line")
{
    const TemporaryFile file;
    writeSession(file.path, little());
    const std::string whole = file.read();
    const std::size_t head = whole.find('\n') + 1;
    std::size_t before = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        file.write(whole.substr(0, size));
        if (size + 1 < head) { // without its line break a header is still complete
            CHECK(refusal(file) != "read");
            continue;
        }
        const Session part = readSession(file.path);
        CHECK_FALSE(part.complete);
        CHECK(part.tracks[0].samples.size() >= before);
        before = part.tracks[0].samples.size();
    }
    CHECK(before == little().tracks[0].samples.size());
}

TEST_CASE("a file that is not a session is refused by file and line")
{
    const TemporaryFile file;
    CHECK(refusal(file) == ": no such file");
    file.write("");
    CHECK(refusal(file) == ": must be a session, got an empty file");
    file.write("hello\n");
    CHECK(refusal(file) == ", line 1: must be a JSON object");
    file.write("{}\n");
    CHECK(refusal(file) == ", line 1: this is not a Filasofia session");
    file.write("{\"format\":\"filasofia session\",\"version\":2}\n");
    CHECK(refusal(file) == ", line 1: the session has version 2, but this program reads version 1");
    const std::string head = headLine(little());
    const auto second = [&](const std::string& line) {
        file.write(head + line + "\n");
        return refusal(file);
    };
    CHECK(second("{\"t\":0}") == ", line 2: 's' must be a list of samples of 2 tracks");
    CHECK(second("{\"s\":[]}") == ", line 2: field 't', the time, is missing");
    CHECK(second("{\"t\":0,\"s\":[[1],[2]]}") ==
          ", line 2: a sample must have 7, 11 or 14 numbers, of which the eleventh is the number of contacts");
    CHECK(second("{\"t\":0,\"event\":\"party\"}") ==
          ", line 2: the kind of an event must be one of Filasofia's, got 'party'");
    CHECK(second(endLine(0) + eventLine({})) == ", line 3: there must be no line after the end");
    CHECK(second(std::string(200'000, '[')) == ", line 2: must be a JSON object");
    CHECK(second(std::string(2'000'000, ' ')) == ", line 2: must be shorter than 1 MiB, as every line of a session");
    CHECK(second("{\"t\":1e999,\"s\":[]}") == ", line 2: must be a JSON object");
}

TEST_CASE("events that come a little late are put where they belong")
{
    const TemporaryFile file;
    file.write(headLine({}) + eventLine({2.0, EventKind::Note, "b"}) + eventLine({1.0, EventKind::Note, "a"}) +
               endLine(3));
    const Session session = readSession(file.path);
    REQUIRE(session.events.size() == 2);
    CHECK(session.events[0].what == "a");
    CHECK(session.lost == 3);
}

TEST_CASE("what was taken back is not in a session, and the lines after it are")
{
    const std::string head = headLine(little());
    const auto line = [](double time) {
        return text(R"({"t":)", time, R"(,"s":[[0,0,0,1,0,0,0],[0,0,0,1,0,0,0]]})", "\n");
    };
    const auto event = [](double time) { return eventLine({.time = time, .kind = EventKind::Step, .what = "enter"}); };
    const auto read = [](const std::string& lines) {
        std::istringstream stream(lines);
        return readSession(stream, "a");
    };
    const Session session = read(head + line(1) + event(1.5) + line(2) + event(2.5) + line(3) + backLine(1.5) +
                                 line(2.25) + event(2.5) + endLine(0));
    REQUIRE(session.tracks[1].samples.size() == 2);
    CHECK(session.tracks[1].samples[1].time == 2.25);
    REQUIRE(session.events.size() == 2);
    CHECK(session.events[0].time == 1.5);
    CHECK(read(head + line(0) + backLine(-1) + endLine(0)).tracks[0].samples.empty());
    CHECK_THROWS_WITH(read(head + "{\"back\":\"x\"}\n"), "a, line 2: 'back' must be a number");
}

TEST_CASE("a sample has a body's pose and the forces on it")
{
    frame::Frame frame;
    frame.time = 1.5;
    frame.rigidBodies = {{.id = {1}, .poses = {{{1, 0, 0}, axisAngle({0, 0, 1}, kPi / 2)}}}};
    frame.softBodies = {{.id = {2}, .positions = {{0, 0, 0}, {2, 0, 0}}}};
    frame.contacts = {{.first = {1}, .second = {2}, .point = {1, 1, 0}, .normal = {0, 1, 0}, .normalForce = 2.0},
                      {.first = {2}, .second = {1}, .point = {1, 2, 0}, .normal = {0, 1, 0}, .normalForce = 5.0},
                      {.first = {2}, .second = {2}, .normal = {1, 0, 0}, .normalForce = 9.0}};
    const Sample tool = sampleOf(frame, {.body = {1}, .tip = {0.5, 0, 0}});
    CHECK(tool.time == 1.5);
    CHECK(distance(tool.pose.position, {1, 0.5, 0}) < 1e-15);
    CHECK(tool.force == Vec3{0, -3, 0});
    CHECK(tool.contacts == 2);
    CHECK(tool.point == Vec3{1, 2, 0}); // the stronger one
    CHECK(sampleOf(frame, {.body = {2}}).pose.position == Vec3{1, 0, 0});
    CHECK(sampleOf(frame, {.body = {2}}).force ==
          Vec3{0, 3, 0}); // contact of the body with itself exerts no force on it
    CHECK(std::isnan(sampleOf(frame, {.body = {7}}).pose.position.x));
    CHECK(std::isnan(sampleOf(frame, {.body = {1}, .element = 4}).force.x));
}

TEST_CASE("an attachment to another body exerts a force and counts as a contact, one to space does not")
{
    frame::Frame frame;
    frame.rigidBodies = {{.id = {1}, .poses = {{}}}};
    frame.softBodies = {{.id = {2}, .positions = {{0, 0, 0}}}};
    frame.contacts = {{.first = {1}, .second = {2}, .point = {1, 1, 0}, .normal = {0, 1, 0}, .normalForce = 2.0}};
    frame.attachments = {{.id = {1}, .body = {2}, .to = {1}, .force = {0, 3, 0}, .points = 4},
                         {.id = {2}, .body = {1}, .to = {}, .force = {9, 0, 0}, .points = 1},
                         {.id = {3}, .body = {2}, .to = {5}, .force = {0, 0, 7}, .points = 2},
                         {.id = {4}, .body = {2}, .to = {2}, .force = {5, 5, 5}, .points = 2}};
    const Sample tool = sampleOf(frame, {.body = {1}});
    CHECK(tool.force == Vec3{0, -1, 0});
    CHECK(tool.contacts == 2);
    CHECK(tool.point == Vec3{1, 1, 0});
    CHECK(sampleOf(frame, {.body = {2}}).force == Vec3{0, 1, 7});
}

TEST_CASE("between two samples no impact is missed: the force is the mean over the steps")
{
    StepSampler sampler({.body = {1}});
    frame::Frame frame;
    frame.rigidBodies = {{.id = {1}, .poses = {{}}}};
    for (const double force : {0.0, 8.0, 0.0, 2.0, 0.0}) {
        frame.time += 1e-3;
        frame.rigidBodies[0].poses[0].position.x = frame.time;
        frame.contacts.clear();
        if (force > 0.0)
            frame.contacts = {
                {.first = {1}, .second = {2}, .point = {force, 0, 0}, .normal = {0, 1, 0}, .normalForce = force}};
        sampler.add(frame, 1e-3);
    }
    const Sample sample = sampler.take();
    CHECK(sample.time == frame.time);
    CHECK(sample.pose.position.x == frame.time);
    CHECK(sample.force.y == exactly(2.0));
    CHECK(sample.contacts == 1);
    CHECK(sample.point.x == 8.0);
    frame.contacts.clear();
    sampler.add(frame, 1e-3);
    CHECK(sampler.take().force == Vec3{}); // nothing is left of it
}

TEST_CASE("samples in another JSON format are read as the same samples")
{
    const TemporaryFile file;
    const std::string head = headLine(little());
    file.write(head + "{\"t\":0.5,\"s\":[[1,2e-3,3,1,0,0,0,4,5,6,2,7,8,9],[null,2,3,1,0,0,0]]}\n" +
               "{ \"s\" : [[1,0.002,3,1,0,0,0,4,5,6,2,7,8,9], [null,2,3,1,0,0,0]], \"t\": 5e-1 }\n" + endLine(0));
    const Session session = readSession(file.path);
    for (const Track& track : session.tracks) {
        REQUIRE(track.samples.size() == 2);
        const Sample &a = track.samples[0], &b = track.samples[1];
        CHECK(a.time == b.time);
        CHECK(a.pose.position.y == b.pose.position.y);
        CHECK(std::isnan(a.pose.position.x) == std::isnan(b.pose.position.x));
        CHECK(a.contacts == b.contacts);
        CHECK(std::isnan(a.force.x) == std::isnan(b.force.x));
    }
    CHECK(session.tracks[0].samples[0].point == Vec3{7, 8, 9});
    for (const char* line : {"{\"t\":0,\"s\":[[inf,0,0,1,0,0,0],[0,0,0,1,0,0,0]]}", "{\"t\":0,\"s\":[[0,0,0,1,0,0,0]",
                             "{\"t\":0,\"s\":[[0,0,0,1,0,0,0],[0,0,0,1,0,0,0]]}]"}) {
        file.write(head + line + "\n");
        CHECK(refusal(file) == ", line 2: must be a JSON object");
    }
}

TEST_CASE("bytes changed at random are a session or an error, and whatever is read can be measured")
{
    const TemporaryFile file;
    writeSession(file.path, little());
    const std::string whole = file.read();
    std::mt19937 random(5);
    int refused = 0;
    for (int round = 0; round < 1500; ++round) {
        std::string text = whole;
        for (int change = 0; change < 1 + round % 3; ++change) {
            char& letter = text[random() % text.size()];
            letter = round % 2 == 0 ? static_cast<char>(random() % 256) : "0123456789-+.e[]{},:\"n"[random() % 22];
        }
        file.write(text);
        try {
            for (const Value& value : measure(readSession(file.path)))
                CHECK((value.value ? std::isfinite(*value.value) : !value.reason.empty()));
        } catch (const Error&) {
            ++refused;
        }
    }
    CHECK(refused > 100);
    CHECK(refused < 1450);
}

} // namespace session_file_test

#include "filasofia/prefab/trainer.h"

#include "filasofia/core/error.h"
#include "filasofia/prefab/metric_tracker.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iostream>

namespace trainer_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

/// A trainer without pictures. It records what it was called with and what it printed about wrong words.
struct Program {
    TrainerDef def{.name = "drill",
                   .about = "A drill.",
                   .cases = {"tooth", "bone"},
                   .difficulties = {"easy", "hard"},
                   .motions = {"expert"},
                   .problem = [](int caseIndex, int seed) {
                       return caseIndex == 1 && seed == 3 ? std::string("too hard") : std::string();
                   }};
    std::vector<Training> trained;
    int steps = 0; ///< in the last session
    std::string said;

    int run(std::vector<const char*> words)
    {
        words.insert(words.begin(), "drill");
        std::ostringstream errors, output;
        auto* const cerr = std::cerr.rdbuf(errors.rdbuf());
        auto* const cout = std::cout.rdbuf(output.rdbuf());
        const int code = runTrainer(static_cast<int>(words.size()), words.data(), def, [&](const Training& training) {
            trained.push_back(training);
            Simulation sim;
            TrainingSession session(sim, training);
            const int problem = session.run(7);
            if (const auto frame = sim.physics().latest()) steps = static_cast<int>(frame->step);
            return problem;
        });
        std::cerr.rdbuf(cerr);
        std::cout.rdbuf(cout);
        said = errors.str();
        return code;
    }
};

} // namespace

TEST_CASE("a trainer's session gets what the command line says")
{
    Program program;
    CHECK(program.run({"--headless", "--case", "bone", "--difficulty=hard", "--seed", "42", "--trainee", "A. B.",
                       "--session", "a.jsonl"}) == 0);
    REQUIRE(program.trained.size() == 1);
    const Training& training = program.trained[0];
    CHECK(training.caseIndex == 1);
    CHECK(training.difficulty == 1);
    CHECK(training.seed == 42);
    CHECK(training.trainee == "A. B.");
    CHECK(training.motion.empty());
    CHECK(training.devices == 0);
    CHECK(training.file == "a.jsonl");
    CHECK(program.steps == 7);
}

TEST_CASE("a planned motion runs to its end, unless --steps is less")
{
    Program program;
    CHECK(program.run({"--headless", "--motion", "expert"}) == 0);
    CHECK(program.trained.back().motion == "expert");
    CHECK(program.trained.back().file == "drill_tooth_1_1.jsonl");
    CHECK(program.steps == 7);
    CHECK(program.run({"--headless", "--motion", "expert", "--steps=3"}) == 0);
    CHECK(program.steps == 3);
}

TEST_CASE("a device's motion file is passed on, and the session uses a device")
{
    Program program;
    const std::string file = (std::filesystem::temp_directory_path() / "filasofia_no_motion.csv").string();
    std::ofstream(file) << "x";
    CHECK(program.run({"--headless", "--motion", file.c_str()}) == 2); // there is no haptic interface for it
    std::filesystem::remove(file);
    REQUIRE(program.trained.size() == 1);
    CHECK(program.trained[0].devices == 1);
    CHECK(program.trained[0].motion.empty());
}

TEST_CASE("unknown words are refused in one line, before any session")
{
    Program program;
    const auto refused = [&](std::vector<const char*> words, const std::string& because) {
        INFO(because);
        CHECK(program.run(std::move(words)) == 2);
        CHECK(program.said == because + "\n");
    };
    refused({"--case", "hip"}, "drill: --case must be tooth or bone, got 'hip'");
    refused({"--difficulty", "9"}, "drill: --difficulty must be easy or hard, got 9");
    refused({"--motion", "wild"}, "drill: --motion must be hand, expert or a motion file, but there is no file 'wild'");
    refused({"--trainee", "--seed", "3"}, "drill: --trainee needs a value");
    refused({"--seed"}, "drill: --seed needs a value");
    refused({"--seed", "-1"}, "drill: --seed must be a whole number in [0, 999999999], got -1");
    refused({"--pictures", "/nowhere"}, "drill: --pictures must be a folder, got '/nowhere'");
    refused({"--check-seeds", "0"}, "drill: --check-seeds must be a whole number in [1, 1000000], got 0");
    CHECK(program.trained.empty());
    program.def.cases = {};
    refused({}, "trainer: cases and difficulties must have at least one entry each");
    program.def.cases = {"a tooth"};
    refused({}, "trainer: cases must be words without spaces, got 'a tooth'");
}

TEST_CASE("a user's last option that lacks its value does not take one of our words")
{
    Program program;
    CHECK(program.run({"--headless", "--picture"}) == 2);
    CHECK(program.said.find("--picture") != std::string::npos);
    CHECK(program.said.find("seed") == std::string::npos);
}

TEST_CASE("a session that is refused leaves no file behind, unless it was named or holds something")
{
    const TrainerDef def = Program().def;
    const auto leaves = [&](std::vector<const char*> words, int steps) {
        std::string file;
        CHECK(runTrainer(static_cast<int>(words.size()), words.data(), def, [&](const Training& training) -> int {
                  Simulation sim;
                  const BodyId body = sim.add(physics::RigidBodyDef{});
                  MetricTracker tracker(sim, {.bodies = {{.body = body}}, .file = file = training.file});
                  if (steps > 0) sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
                  throw Error("drill: no bone");
              }) == 2);
        return std::filesystem::remove(file);
    };
    CHECK_FALSE(leaves({"drill", "--headless"}, 0));
    CHECK(leaves({"drill", "--headless"}, 20));
    CHECK(leaves({"drill", "--headless", "--session", "named.jsonl"}, 0));
}

TEST_CASE("the option --check-seeds checks the patients of many seeds without a session")
{
    Program program;
    CHECK(program.run({"--check-seeds", "5"}) == 0);
    CHECK(program.run({"--case", "bone", "--check-seeds", "5"}) == 1);
    CHECK(program.trained.empty());
}

TEST_CASE("no session is overwritten")
{
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "filasofia_unused_session";
    std::filesystem::create_directory(folder);
    const std::string stem = (folder / "s").string();
    CHECK(unusedSessionFile(stem) == stem + "_1.jsonl");
    std::ofstream(stem + "_1.jsonl") << "x";
    CHECK(unusedSessionFile(stem) == stem + "_2.jsonl");
    std::filesystem::remove_all(folder);
}

} // namespace trainer_test

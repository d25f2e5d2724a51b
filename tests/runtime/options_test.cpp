#include "filasofia/runtime/options.h"

#include <catch2/catch.hpp>

#include <iostream>
#include <sstream>

namespace options_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

struct Words {
    std::string size = "small", name;
    std::vector<OwnOption> options = {{"--size", &size, "which one", {"small", "medium", "large"}},
                                      {"--name", &name, "of whom"}};
    std::vector<std::string> take(std::vector<const char*> words)
    {
        words.insert(words.begin(), "program");
        return takeOptions("tool", static_cast<int>(words.size()), words.data(), options);
    }
};

} // namespace

TEST_CASE("a program's own options are taken off the command line, the rest is left in its order")
{
    Words words;
    CHECK(words.take({"--steps", "3", "--size", "large", "--headless", "--name=a=b c"}) ==
          std::vector<std::string>{"program", "--steps", "3", "--headless"});
    CHECK(words.size == "large");
    CHECK(words.name == "a=b c");
    Words untouched;
    CHECK(untouched.take({}) == std::vector<std::string>{"program"});
    CHECK(untouched.size == "small");
}

TEST_CASE("an option without value, given twice or of no such choice is refused in one line")
{
    CHECK_THROWS_WITH(Words().take({"--size"}), "tool: --size needs a value");
    CHECK_THROWS_WITH(Words().take({"--size", "large", "--size=large"}),
                      "tool: --size must be given once, with one value");
    CHECK_THROWS_WITH(Words().take({"--size", "huge"}), "tool: --size must be small, medium or large, got 'huge'");
    CHECK_THROWS_WITH(Words().take({"--size="}), "tool: --size must be small, medium or large, got ''");
}

TEST_CASE("help names every option with its choices and its default")
{
    const Words words;
    const std::string help = optionHelp(words.options);
    CHECK_THAT(help, Catch::Contains("--size small, medium or large"));
    CHECK_THAT(help, Catch::Contains("which one (small)\n"));
    CHECK_THAT(help, Catch::Contains("of whom\n"));
}

TEST_CASE("a simulation runs with a command line in parts")
{
    Simulation sim;
    CHECK(run(sim, {"program", "--headless", "--steps", "2"}) == 0);
    CHECK(sim.physics().latest()->step == 2);
    CHECK(run(sim, {"program", "--steps", "-2"}) == 2);
}

TEST_CASE("the help of a run leaves out the program's own options")
{
    const auto helpOf = [](const std::vector<OwnOption>& own) {
        Simulation sim;
        std::ostringstream said;
        std::streambuf* before = std::cout.rdbuf(said.rdbuf());
        const int code = run(sim, {"program", "--help"}, own);
        std::cout.rdbuf(before);
        CHECK(code == 0);
        return said.str();
    };
    std::string seed;
    const std::string all = helpOf({}),
                      rest = helpOf({{"--seed", &seed, "which patient"}, {"--case", &seed, "no run's"}});
    CHECK_THAT(all, Catch::Contains("--seed N"));
    CHECK_THAT(all, Catch::Contains("--steps N"));
    CHECK_THAT(rest, !Catch::Contains("--seed N"));
    CHECK_THAT(rest, Catch::Contains("--steps N"));
}

} // namespace options_test

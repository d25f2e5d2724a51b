#include "filasofia/scene/case_file.h"

#include "filasofia/core/error.h"

#include <catch2/catch.hpp>

#include <array>
#include <filesystem>
#include <fstream>

namespace case_file_test {

using namespace filasofia;
using prefab::TrainerCase;
using prefab::Training;

namespace {

struct Rules {
    double depth = 0.002;
    int holes = 3;
    bool water = true;
};
constexpr auto fields(const Rules*)
{
    return describe("Rules", field("depth", &Rules::depth, "m", closed(0.001, 0.02), "of a hole"),
                    field("holes", &Rules::holes, "-", closed(1, 9), "to be drilled"),
                    field("water", &Rules::water, "that cools"));
}
constexpr std::array<Rules, 2> kRules = {{{}, {.depth = 0.004, .holes = 5}}};
struct Bone {
    double modulus = 1e9;
};
constexpr auto fields(const Bone*)
{
    return describe("Bone", field("modulus", &Bone::modulus, "Pa", closed(1e6, 1e11), "Young's modulus"));
}

prefab::TrainerDef drill()
{
    prefab::TrainerDef def{.name = "drill", .cases = {"tooth", "bone"}, .difficulties = {"easy", "hard"}};
    def.settings = prefab::settingsOf<Rules>(kRules);
    for (const auto& each : prefab::settingsOf<Bone>(std::array<Bone, 2>(), {"bone"})) def.settings.push_back(each);
    def.readCase = scene::loadCase;
    return def;
}

/// A folder with case files, which is gone at the end.
struct Folder {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / "filasofia_case_file_test";
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& text) const
    {
        std::ofstream(path / name) << text;
        return path / name;
    }
};

} // namespace

TEST_CASE("a case file changes settings of a trainer's case, with units, and leaves the others as they are")
{
    const Folder folder;
    const TrainerCase read =
        scene::loadCase(folder.write("deep.json", R"({"trainer": "drill", "case": "bone", "seed": 12, // this patient
            "settings": {"depth": "3 mm", "water": false, "modulus": "2 GPa"}})"),
                        drill());
    CHECK(read.name == "deep");
    CHECK(read.base == 1);
    CHECK(read.seed == 12);
    const Training training{.difficulty = 1, .chosen = read};
    const Rules rules = training.rules(kRules[1]);
    CHECK(rules.depth == 0.003);
    CHECK(rules.holes == 5);
    CHECK_FALSE(rules.water);
    CHECK(training.rules(Bone{}).modulus == 2e9);
}

TEST_CASE("what is wrong in a case file is named with its place, bound and value")
{
    const Folder folder;
    const auto refused = [&](const std::string& text, const std::string& because) {
        const auto file = folder.write("wrong.json", text);
        CHECK_THROWS_WITH(scene::loadCase(file, drill()), file.string() + because);
    };
    refused("[]", ":1:1: a case must be an object, got []");
    refused("{}", ":1:1: a case must have the field 'trainer', got an object");
    refused(R"({"trainer": "saw", "case": "bone"})",
            ":1:13: trainer must be 'drill', whose case this is to be, got \"saw\"");
    refused(R"({"trainer": "drill", "case": "bones"})",
            ":1:30: case must be one of the trainer's own, got \"bones\" (did you mean 'bone'?)");
    const auto setting = [](const std::string& text) {
        return R"({"trainer": "drill", "case": "tooth", "settings": {)" + text + "}}";
    };
    refused(setting(R"("depth": "3 cm")"), ":1:61: settings.depth must be in [0.001, 0.02] m, got \"3 cm\"");
    refused(setting(R"("depth": "3 Pa")"), ":1:61: settings.depth must be in m or a unit like it, got \"3 Pa\"");
    refused(setting(R"("holes": 2.5)"), ":1:61: settings.holes must be a whole number, got 2.5");
    refused(setting(R"("holes": 10)"), ":1:61: settings.holes must be in [1, 9], got 10");
    refused(setting(R"("water": 1)"), ":1:61: settings.water must be true or false, got 1");
    refused(setting(R"("modulus": 1e9)"), ":1:63: unknown field 'modulus' in settings (it has depth, holes, water)");
    refused(R"({"trainer": "drill", "case": "bone", "seed": -1})", ":1:46: seed must be in [0, 999999999], got -1");
    refused(R"({"trainer": "drill", "case": "bone", "seed": 1, "picture": "none.png"})",
            ":1:60: picture must be a file that exists, got \"none.png\"");
}

TEST_CASE("a trainer's --new-case writes a file that changes nothing, and --case begins it under its name")
{
    const Folder folder;
    const std::string file = (folder.path / "mine.json").string(), session = (folder.path / "s.jsonl").string();
    std::vector<Training> trained;
    const auto run = [&](std::vector<const char*> words) {
        words.insert(words.begin(), "drill");
        return runTrainer(static_cast<int>(words.size()), words.data(), drill(), [&](const Training& training) {
            trained.push_back(training);
            return 0;
        });
    };
    REQUIRE(run({"--case", "bone", "--difficulty", "hard", "--new-case", file.c_str()}) == 0);
    CHECK(trained.empty());
    CHECK(run({"--new-case", file.c_str()}) == 2); // it is there
    REQUIRE(run({"--headless", "--case", file.c_str(), "--session", session.c_str()}) == 0);
    REQUIRE(trained.size() == 1);
    const Training& training = trained.front();
    CHECK(training.caseIndex == 1);
    CHECK(training.chosen.name == "mine");
    CHECK(training.task("drilling bone") == "mine easy");
    CHECK(training.rules(Rules{}).depth == 0.004); // that of "hard", which the file says
    CHECK(training.rules(Rules{}).holes == 5);
    CHECK(training.chosen.settings.size() == 4);
}

TEST_CASE("a case that has a patient of its own is that patient")
{
    const Folder folder;
    const std::string file =
        folder.write("seventh.json", R"({"trainer": "drill", "case": "tooth", "seed": 7})").string();
    int seed = 0;
    const auto run = [&](std::vector<const char*> words) {
        words.insert(words.begin(), {"drill", "--headless", "--case", file.c_str(), "--session", "x.jsonl"});
        return runTrainer(static_cast<int>(words.size()), words.data(), drill(), [&](const Training& training) {
            seed = training.seed;
            return 0;
        });
    };
    CHECK(run({}) == 0);
    CHECK(seed == 7);
    CHECK(run({"--seed", "8"}) == 2);
}

TEST_CASE("case files in the folder of the assets are among a trainer's cases, and none may have the name of its own")
{
    const Folder folder;
    std::filesystem::create_directories(folder.path / "cases/drill");
    static_cast<void>(folder.write("cases/drill/molar.json", R"({"trainer": "drill", "case": "tooth"})"));
    REQUIRE(setenv("FILASOFIA_ASSETS", folder.path.c_str(), 1) == 0);
    std::string name;
    const auto run = [&](const char* chosen) {
        const char* const words[] = {"drill", "--headless", "--case", chosen, "--session", "x.jsonl"};
        return runTrainer(6, words, drill(), [&](const Training& training) {
            name = training.chosen.name;
            return 0;
        });
    };
    CHECK(run("molar") == 0);
    CHECK(name == "molar");
    CHECK(run("premolar") == 2);
    static_cast<void>(folder.write("cases/drill/bone.json", R"({"trainer": "drill", "case": "tooth"})"));
    CHECK(run("molar") == 2);
    unsetenv("FILASOFIA_ASSETS");
}

} // namespace case_file_test

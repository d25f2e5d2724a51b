#include "filasofia/core/suggestion.h"

namespace suggestion_test {

using namespace filasofia;

TEST_CASE("the distance of two words counts letters that are missing, added, wrong or swapped")
{
    CHECK(editDistance("roughness", "roughness") == 0);
    CHECK(editDistance("rougness", "roughness") == 1);
    CHECK(editDistance("roughhness", "roughness") == 1);
    CHECK(editDistance("rouhgness", "roughness") == 1);
    CHECK(editDistance("", "abc") == 3);
}

TEST_CASE("a slip is told the nearest known word, another word none")
{
    const std::vector<std::string> known = {"roughness", "wetness", "bump"};
    CHECK(didYouMean("wettness", known) == " (did you mean 'wetness'?)");
    CHECK(didYouMean("colour", known).empty());
    CHECK(didYouMean("xyz", {"abc"}).empty());
    CHECK(didYouMean("bump", {}).empty());
    const std::vector<std::string> body = {"mesh", "mass", "material", "pose"};
    for (const char* word : {"totalMass", "total_mass", "massDensity"})
        CHECK(didYouMean(word, body) == " (did you mean 'mass'?)");
    CHECK(didYouMean("youngModulus", body) == " (did you mean 'material'?)");
    CHECK(didYouMean("totalMass", {"radius"}).empty());
}

TEST_CASE("short words must be nearer, and a field that is near none gets the list of all")
{
    CHECK(didYouMean("mass", {"class", "value"}).empty()); // two letters of four are another word
    CHECK(didYouMean("clas", {"class", "value"}) == " (did you mean 'class'?)");
    CHECK(didYouMeanOneOf("mass", {"class", "value"}) == " (it has class, value)");
    CHECK(didYouMeanOneOf("valeu", {"class", "value"}) == " (did you mean 'value'?)");
    CHECK(didYouMeanOneOf("mass", {}).empty());
    CHECK(didYouMeanOneOf("mass", std::vector<std::string>(12, "a")).size() > 30);
    CHECK(didYouMeanOneOf("mass", std::vector<std::string>(13, "a")).empty());
}

} // namespace suggestion_test

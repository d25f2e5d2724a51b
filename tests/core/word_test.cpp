#include "filasofia/core/word.h"

#include "filasofia/core/error.h"
#include "filasofia/core/listed.h"

namespace word_test {

using namespace filasofia;

namespace {

struct Def {
    int steps = 0;
    double rate = 0.0;
    double free = 0.0;
};
constexpr auto fields(const Def*)
{
    return describe("Def", field("steps", &Def::steps, "-", nonNegative(), "how many"),
                    field("rate", &Def::rate, "Hz", closed(1, 100), "how often"));
}

} // namespace

TEST_CASE("a list has the words between its commas, empty ones too, and none if it is empty")
{
    CHECK(listed("").empty());
    CHECK(listed("mouse") == std::vector<std::string>{"mouse"});
    CHECK(listed("a,b:c d,") == std::vector<std::string>{"a", "b:c d", ""});
}

TEST_CASE("a word that is a number within its bounds is read")
{
    CHECK(wholeNumber("n", "12", {closed(0, 12), "-"}) == 12);
    CHECK(wholeNumber("n", "-3", {}) == -3);
    CHECK(wholeNumber("n", "+7", {}) == 7);
    CHECK(realNumber("n", "1e-3", {positive(), "s"}) == 1e-3);
    CHECK(realNumber("n", "+0.25", {}) == 0.25);
}

TEST_CASE("a word that is not a number, or out of bounds, is refused with name, bound and word")
{
    const Bound threads{closed(0, 256), "-"};
    for (const std::string word : {"abc", "", " 3", "3 ", "0x10", "3abc", "+-3", "1e2 "})
        CHECK_THROWS_WITH(wholeNumber("run: --threads", word, threads),
                          "run: --threads must be a whole number in [0, 256], got '" + word + "'");
    for (const std::string word : {"-1", "257", "10000", "1.5", "1e2", "99999999999999999999"})
        CHECK_THROWS_AS(wholeNumber("run: --threads", word, threads), Error);
    CHECK_THROWS_WITH(wholeNumber("n", "-1", threads), "n must be a whole number in [0, 256], got -1");
    CHECK_THROWS_WITH(wholeNumber("n", "3000000000", {nonNegative(), "-"}),
                      "n must be a whole number in [0, 2147483647], got 3000000000");
    CHECK_THROWS_WITH(realNumber("n", "0", {closed(1, 9), "Hz"}), "n must be in [1, 9] Hz, got 0");
    CHECK_THROWS_WITH(realNumber("n", "fast", {closed(1, 9), "Hz"}), "n must be in [1, 9] Hz, got 'fast'");
    for (const std::string word : {"nan", "inf", "-inf"})
        CHECK_THROWS_WITH(realNumber("n", word, {}), "n must be finite, got " + word);
}

TEST_CASE("the bound of an option is that of the Def's field")
{
    CHECK(boundOf(&Def::rate).unit == "Hz");
    CHECK(boundOf(&Def::rate).range.high == 100);
    CHECK(boundOf(&Def::steps).range.low == 0);
    CHECK_FALSE(boundOf(&Def::steps).range.lowOpen);
    CHECK(boundOf(&Def::free).range.text("") == "must be finite");
}

TEST_CASE("an endless word is shown by its beginning and a usual one whole")
{
    const auto many = [](std::size_t count) { return std::string(count, '7'); };
    CHECK(shortened(many(80)) == many(80));
    CHECK(shortened(many(1000)) == text(many(40), "…"));
    CHECK(shortened(text(many(39), "é", many(60))) == text(many(39), "…")); // not half an é
    CHECK_THROWS_WITH(wholeNumber("n", many(1000), {closed(0, 9), "-"}),
                      text("n must be a whole number in [0, 9], got '", many(40), "…'"));
    CHECK_THROWS_WITH(wholeNumber("n", text("x", many(1000)), {closed(0, 9), "-"}),
                      text("n must be a whole number in [0, 9], got 'x", many(39), "…'"));

    const std::string path = text("/", many(150));
    CHECK(withShortWords(text(path, ":  cannot be read")) == text(path, ":  cannot be read"));
    CHECK(withShortWords(text("run: '", many(1000), " is long ")) == text("run: '", many(39), "… is long "));
    CHECK(withShortWords("").empty());
}

} // namespace word_test

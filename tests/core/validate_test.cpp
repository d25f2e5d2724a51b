#include "filasofia/core/validate.h"

#include <limits>

namespace validate_test {

using namespace filasofia;

namespace {

struct Part {
    double size = 1.0;
};
constexpr auto fields(const Part*) { return describe("Part", field("size", &Part::size, "m", positive(), "how long")); }

struct Other {
    int count = 3;
};
constexpr auto fields(const Other*)
{
    return describe("Other", field("count", &Other::count, "-", closed(1, 10), "how many"));
}

struct Thing {
    std::string name;
    double poisson = 0.3;
    Part part;
    std::vector<Part> parts;
    std::optional<double> mass;
    std::variant<Part, Other> choice;
    bool flag = false;
};
constexpr auto fields(const Thing*)
{
    return describe("Thing", field("name", &Thing::name, "its name"),
                    field("poisson", &Thing::poisson, "-", closedOpen(0, 0.5), "Poisson's ratio"),
                    field("part", &Thing::part, ""), field("parts", &Thing::parts, ""),
                    field("mass", &Thing::mass, "kg", positive(), "total mass"), field("choice", &Thing::choice, ""),
                    field("flag", &Thing::flag, ""));
}

} // namespace

TEST_CASE("a Def within its bounds is valid") { CHECK_NOTHROW(validate(Thing{}, "thing 'a'")); }

TEST_CASE("an error names object, field, bound and value, wherever the field lies")
{
    Thing thing;
    thing.poisson = 0.5;
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': poisson must be in [0, 0.5), got 0.5");
    thing = {};
    thing.part.size = -1;
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': part.size must be > 0 m, got -1");
    thing = {};
    thing.parts = {{}, {0.0}};
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': parts[1].size must be > 0 m, got 0");
    thing = {};
    thing.mass = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': mass must be > 0 kg and finite, got inf");
    thing.mass = -std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': mass must be > 0 kg, got -inf");
    thing = {};
    thing.choice = Other{11};
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': choice.count must be in [1, 10], got 11");
    thing = {};
    thing.poisson = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(validate(thing, "thing 'a'"), "thing 'a': poisson must be in [0, 0.5), got nan");
}

TEST_CASE("bounds read as people write them")
{
    CHECK(positive().text("Pa") == "must be > 0 Pa");
    CHECK(nonNegative().text("s") == "must be >= 0 s");
    CHECK(finite().text("m") == "must be finite");
    CHECK(closed(1, 10).text("-") == "must be in [1, 10]");
    CHECK(positiveOrInfinite().contains(std::numeric_limits<double>::infinity()));
    CHECK(!finite().contains(std::numeric_limits<double>::quiet_NaN()));
}

} // namespace validate_test

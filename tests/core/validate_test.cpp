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

namespace {

struct Vector {
    double x = 0.0, y = 0.0;
};
constexpr auto fields(const Vector*)
{
    return describe("Vector", field("x", &Vector::x, "", finite(), ""), field("y", &Vector::y, "", finite(), ""));
}

/// Numbers whose units have a largest magnitude.
struct Quantities {
    Vector gravity = {};
    double modulus = 1e4, stiffness = std::numeric_limits<double>::infinity(), pressure = 0.0, size = 1.0, place = 0.0;
    double friction = 0.5;
};
constexpr auto fields(const Quantities*)
{
    using T = Quantities;
    return describe("Quantities", field("gravity", &T::gravity, "m/s^2", finite(), ""),
                    field("modulus", &T::modulus, "Pa", positive(), ""),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), ""),
                    field("pressure", &T::pressure, "Pa", finite(), ""), field("size", &T::size, "m", positive(), ""),
                    field("place", &T::place, "m", finite(), ""),
                    field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction), ""));
}

} // namespace

TEST_CASE("a finite number far beyond what its unit can mean is refused, infinite ones and far places are not")
{
    const auto says = [](auto change) -> std::string {
        Quantities it;
        change(it);
        try {
            validate(it, "it");
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    CHECK(says([](Quantities&) {}).empty());
    CHECK(says([](Quantities& q) { q.modulus = 1e13; }).empty());
    CHECK(says([](Quantities& q) { q.modulus = 1e300; }) == "it: modulus must be <= 1e+13 Pa, got 1e+300");
    CHECK(says([](Quantities& q) { q.modulus = -1e300; }) == "it: modulus must be > 0 Pa, got -1e+300");
    CHECK(says([](Quantities& q) { q.modulus = std::numeric_limits<double>::infinity(); }) ==
          "it: modulus must be > 0 Pa and finite, got inf");
    CHECK(says([](Quantities& q) { q.pressure = -1e300; }) ==
          "it: pressure must be in [-1e+13, 1e+13] Pa, got -1e+300");
    CHECK(says([](Quantities& q) { q.stiffness = 1e300; }) == "it: stiffness must be <= 1e+15 N/m, got 1e+300");
    CHECK(says([](Quantities& q) { q.gravity.y = -1e5; }).empty());
    CHECK(says([](Quantities& q) { q.gravity.y = -1e30; }) ==
          "it: gravity.y must be in [-100000, 100000] m/s^2, got -1e+30");
    CHECK(says([](Quantities& q) { q.size = 1e300; }) == "it: size must be <= 1e+09 m, got 1e+300");
    CHECK(says([](Quantities& q) { q.place = 1e300; }).empty());
    CHECK(says([](Quantities& q) { q.friction = 1e30; }) == "it: friction must be <= 1000, got 1e+30");
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

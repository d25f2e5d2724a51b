#include "physics/fake_engine.h"

#include "filasofia/core/validate.h"

#include <limits>

namespace defs_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Numbers near the ends of a range that lie outside it.
std::vector<double> outside(const Range& range)
{
    std::vector<double> values{kNan};
    for (double value : {range.low, range.low - 1.0, -1e300, -kInf, range.high, range.high + 1.0, 1e300, kInf})
        if (!range.contains(value)) values.push_back(value);
    return values;
}

template <class Value> bool representable(double value)
{
    return std::is_floating_point_v<Value> || std::abs(value) < 1e9;
}

/// Sets every numeric field of Def, also in lists, to each number outside its range and expects an Error. Returns how
/// many it tried.
template <class Def> int checkEveryField()
{
    int tried = 0;
    const std::string object = "thing 'x'";
    validate(Def{}, object); // the defaults are legal
    forEachField<Def>([&](const auto& each) {
        using Member = std::remove_cvref_t<decltype(Def{}.*(each.member))>;
        const auto expect = [&](const Def& def, const std::string& path, double value) {
            const std::string bound = text(object, ": ", path, " ", each.range.refusal(each.unit, value));
            checkError([&] { validate(def, object); }, {bound, text(", got ", value == 0.0 ? 0.0 : value)});
            ++tried;
        };
        for (double value : outside(each.range)) {
            Def def;
            const std::string name(each.name);
            if constexpr (std::is_arithmetic_v<Member> && !std::is_same_v<Member, bool>) {
                if (!representable<Member>(value)) continue;
                def.*(each.member) = static_cast<Member>(value);
                expect(def, name, value);
            } else if constexpr (std::is_same_v<Member, std::vector<int>>) {
                if (!representable<int>(value)) continue;
                def.*(each.member) = {3, static_cast<int>(value)};
                expect(def, name + "[1]", value);
            }
        }
    });
    return tried;
}

template <class Change> std::string refusal(Change change)
{
    SoftBodyDef def;
    change(def);
    try {
        validate(def, "soft body 'liver'");
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

} // namespace

TEST_CASE("absurd numbers are refused when a body is made, with object, field, bound and value")
{
    CHECK(refusal([](SoftBodyDef& def) { def.material = FemMaterial{.youngModulus = 1e300}; }) ==
          "soft body 'liver': material.youngModulus must be <= 1e+13 Pa, got 1e+300");
    CHECK(refusal([](SoftBodyDef& def) { def.mass = Density{1e30}; }) ==
          "soft body 'liver': mass.value must be <= 10000000 kg/m^3, got 1e+30");
    CHECK(refusal([](SoftBodyDef& def) { def.pressure = -1e20; }) ==
          "soft body 'liver': pressure must be in [-1e+13, 1e+13] Pa, got -1e+20");
    CHECK(refusal([](SoftBodyDef& def) { def.velocity.z = 1e7; }) ==
          "soft body 'liver': velocity.z must be in [-100000, 100000] m/s, got 10000000");
    CHECK(refusal([](SoftBodyDef& def) { def.friction = 1e9; }) ==
          "soft body 'liver': friction must be <= 1000, got 1e+09");
    CHECK(refusal([](SoftBodyDef& def) { def.rayleigh.mass = 1e20; }) ==
          "soft body 'liver': rayleigh.mass must be <= 1e+09 1/s, got 1e+20");
    CHECK(refusal([](SoftBodyDef& def) { def.attachments = {{.nodes = {0}, .stiffness = 1e300}}; }) ==
          "soft body 'liver': attachments[0].stiffness must be <= 1e+15 N/m, got 1e+300");
    CHECK(refusal([](SoftBodyDef& def) { def.attachments = {{.nodes = {0}, .stiffness = kHard}}; }) == "accepted");
}

TEST_CASE("every number of every def has a range, and outside it is an Error with object, field, bound and value")
{
    CHECK(checkEveryField<FemMaterial>() >= 8);
    CHECK(checkEveryField<MassSpringMaterial>() >= 8);
    CHECK(checkEveryField<Density>() >= 4);
    CHECK(checkEveryField<TotalMass>() >= 4);
    CHECK(checkEveryField<Rayleigh>() >= 8);
    CHECK(checkEveryField<ConjugateGradient>() >= 8);
    CHECK(checkEveryField<AttachmentDef>() >= 5);
    CHECK(checkEveryField<NodalForce>() >= 1);
    CHECK(checkEveryField<SoftBodyDef>() >= 3);
    CHECK(checkEveryField<PhysicsServerDef>() >= 2);
    CHECK(checkEveryField<Vec3>() >= 9);
    CHECK(checkEveryField<Quat>() >= 12);
}

TEST_CASE("a number deep inside a soft body is named by its whole path")
{
    CHECK(refusal([](SoftBodyDef&) {}) == "accepted");
    CHECK(refusal([](SoftBodyDef& d) { d.material = FemMaterial{.youngModulus = 0}; }) ==
          "soft body 'liver': material.youngModulus must be > 0 Pa, got 0");
    CHECK(refusal([](SoftBodyDef& d) { d.material = FemMaterial{.poissonRatio = 0.5}; }) ==
          "soft body 'liver': material.poissonRatio must be in [0, 0.5), got 0.5");
    CHECK(refusal([](SoftBodyDef& d) { d.material = MassSpringMaterial{.damping = -1}; }) ==
          "soft body 'liver': material.damping must be >= 0 N s/m, got -1");
    CHECK(refusal([](SoftBodyDef& d) { d.mass = Density{-2}; }) ==
          "soft body 'liver': mass.value must be > 0 kg/m^3, got -2");
    CHECK(refusal([](SoftBodyDef& d) { d.mass = TotalMass{kInf}; }) ==
          "soft body 'liver': mass.value must be > 0 kg and finite, got inf");
    CHECK(refusal([](SoftBodyDef& d) { d.pose.position.y = kNan; }) ==
          "soft body 'liver': pose.position.y must be finite, got nan");
    CHECK(refusal([](SoftBodyDef& d) { d.rayleigh.stiffness = -0.5; }) ==
          "soft body 'liver': rayleigh.stiffness must be >= 0 s, got -0.5");
    CHECK(refusal([](SoftBodyDef& d) { d.solver = ConjugateGradient{.tolerance = 1}; }) ==
          "soft body 'liver': solver.tolerance must be in (0, 1), got 1");
    CHECK(refusal([](SoftBodyDef& d) { d.solver = ConjugateGradient{.maxIterations = 0}; }) ==
          "soft body 'liver': solver.maxIterations must be in [1, 100000], got 0");
    CHECK(refusal([](SoftBodyDef& d) {
              d.attachments = {{.nodes = {1}}, {.nodes = {2, -1}}};
          }) == "soft body 'liver': attachments[1].nodes[1] must be >= 0, got -1");
    CHECK(refusal([](SoftBodyDef& d) { d.attachments = {{.nodes = {1}, .stiffness = 0}}; }) ==
          "soft body 'liver': attachments[0].stiffness must be > 0 N/m, got 0");
    CHECK(refusal([](SoftBodyDef& d) {
              d.attachments = {{.box = geometry::Box{{0, 0, 0}, {1, kInf, 1}}}};
          }) == "soft body 'liver': attachments[0].box.high.y must be finite, got inf");
    CHECK(refusal([](SoftBodyDef& d) {
              d.forces = {{0, {0, 0, kNan}}};
          }) == "soft body 'liver': forces[0].force.z must be finite, got nan");
    CHECK(refusal([](SoftBodyDef& d) { d.pressure = -kInf; }) ==
          "soft body 'liver': pressure must be finite, got -inf");
}

TEST_CASE("infinite stiffness is legal for an attachment and means a hard pin")
{
    CHECK(refusal([](SoftBodyDef& d) { d.attachments = {{.nodes = {1}, .stiffness = kHard}}; }) == "accepted");
}

} // namespace defs_test

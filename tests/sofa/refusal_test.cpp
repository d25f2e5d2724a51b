#include "sofa/sofa_stage.h"

namespace refusal_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

SoftBodyDef tissue()
{
    return {.name = "tissue", .mesh = bar(1, 1, 1, {0.01, 0.01, 0.01}), .material = FemMaterial{.law = Corotational{}}};
}

void refuses(const SoftBodyDef& def, const std::string& says)
{
    const auto server = serverWith("sofa");
    CHECK_THROWS_WITH(server->add(def),
                      Catch::StartsWith("soft body 'tissue': " + says) && Catch::Contains("with the engine 'sofa'"));
}
void refuses(const RigidBodyDef& def, const std::string& says)
{
    const auto server = serverWith("sofa");
    CHECK_THROWS_WITH(server->add(def),
                      Catch::StartsWith("rigid body 'tool': " + says) && Catch::Contains("with the engine 'sofa'"));
}

} // namespace

TEST_CASE("what the engine says of itself")
{
    const auto info = runtime::makeEngine("sofa", {})->info();
    CHECK((info.name == "sofa" && !info.version.empty()));
    CHECK((info.joints && info.cuts));
    CHECK_FALSE((info.repeatable || info.deadline));
    CHECK_THROWS_WITH(runtime::makeEngine("sofa", {.period = 0.0}), Catch::Contains("period must be in (0, 10] s"));
}

TEST_CASE("a soft body that asks for what SOFA lacks is refused when it is added")
{
    SoftBodyDef def = tissue();
    auto& material = std::get<FemMaterial>(def.material);
    SECTION("law")
    {
        material.law = Fung{};
        refuses(def, "material.law Fung");
    }
    SECTION("fibres")
    {
        material.fibres = {{}};
        refuses(def, "material.fibres");
    }
    SECTION("relaxation")
    {
        material.relaxation = {{}};
        refuses(def, "material.relaxation");
    }
    SECTION("yield")
    {
        material.yieldStress = 1e3;
        refuses(def, "material.yieldStress");
    }
    SECTION("region")
    {
        material.regions = {{.where = Listed{{0}}, .restScale = 0.9}};
        refuses(def, "material.regions[0].restScale");
    }
    SECTION("uneven")
    {
        material.law = NeoHookean{};
        material.regions = {{.where = Listed{{0}}, .youngModulus = 1.0}};
        refuses(def, "material: a NeoHookean law");
    }
    SECTION("collision")
    {
        def.collision = {{.proximity = 0.0}};
        refuses(def, "collision[0].proximity must be > 0 m");
    }
}

TEST_CASE("a rigid body or a rod that asks for what SOFA lacks is refused")
{
    RigidBodyDef def{.name = "tool", .dynamic = true, .mass = GivenInertia{}};
    SECTION("damping")
    {
        def.angularDamping = 1.0;
        refuses(def, "an angularDamping");
    }
    SECTION("rod")
    {
        const auto server = serverWith("sofa");
        CHECK_THROWS_WITH(server->add(RodBodyDef{.name = "thread", .points = {{0, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0}}}),
                          Catch::Contains("a rod is not available with the engine 'sofa'"));
    }
}

TEST_CASE("a command that SOFA cannot carry out is refused at its caller")
{
    const auto server = serverWith("sofa");
    const BodyId body = server->add(tissue());
    const auto refused = [&](auto&& act, const std::string& says) {
        CHECK_THROWS_WITH(act(), Catch::Contains(says) && Catch::Contains("not available with the engine 'sofa'"));
    };
    refused([&] { server->setTissue(body, {.where = Listed{{0}}, .youngModulus = 1e3}); },
            "soft body 'tissue': SetTissue");
    server->step(1e-3);
    CHECK(server->latest()->softBodies.size() == 1);
}

TEST_CASE("a body that SOFA cannot make is refused when it is added, and the others go on")
{
    const auto server = serverWith("sofa");
    const BodyId body = server->add(tissue());
    // Each number is in its range, but not what SOFA makes of both.
    SoftBodyDef odd = tissue();
    std::get<FemMaterial>(odd.material).youngModulus = 1e300;
    odd.mass = TotalMass{1e-300};
    try {
        server->add(odd);
    } catch (const Error& error) {
        CHECK_THAT(error.what(), Catch::StartsWith("soft body 'tissue': "));
    }
    const StepReport report = server->step(1e-3);
    CHECK_FALSE(report.has(StepFlag::TuneRejected)); // what was accepted was made
    CHECK(server->latest()->softBody(body)->positions[0].y < 0.0);
}

} // namespace refusal_test

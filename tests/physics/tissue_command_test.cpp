#include "physics/fake_engine.h"

#include <thread>

namespace tissue_command_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

struct Liver {
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    BodyId id;

    explicit Liver(const FemMaterial& material)
    {
        geometry::TetMesh mesh = *oneTetrahedron();
        mesh.labels = {7};
        mesh.labelNames = {{7, "tumour"}};
        id = server.add(SoftBodyDef{
            .name = "liver", .mesh = std::make_shared<const geometry::TetMesh>(mesh), .material = material});
    }
    void refused(const TissueRegion& region, std::vector<std::string> parts)
    {
        parts.insert(parts.begin(), "soft body 'liver': region");
        checkError([&] { server.setTissue(id, region); }, parts);
    }
};

const FemMaterial kMuscle{.fibres = {FibreFamily{}}};

} // namespace

TEST_CASE("a change of tissue reaches the engine with tetrahedra instead of names, unless it is a place")
{
    Liver liver{FemMaterial{}};
    liver.server.setTissue(liver.id, {.where = Labelled{"tumour"}, .youngModulus = 5e3});
    liver.server.setTissue(liver.id, {.where = NearSurface{1.0}, .restScale = 0.9});
    liver.server.setTissue(liver.id, {.where = Ball{{}, 1.0}, .poissonRatio = 0.3});
    liver.server.step(1e-3);
    const std::size_t first = liver.calls.commands.size() - 3;
    for (std::size_t k : {0u, 1u}) {
        const auto& set = command<SetTissue>(liver.calls, first + k);
        CHECK(set.id == liver.id);
        CHECK(set.region.where == RegionShape(Listed{{0}}));
    }
    CHECK(command<SetTissue>(liver.calls, first).region.youngModulus == 5e3);
    CHECK_FALSE(command<SetTissue>(liver.calls, first).region.restScale);
    CHECK(command<SetTissue>(liver.calls, first + 1).region.restScale == 0.9);
    CHECK(command<SetTissue>(liver.calls, first + 2).region.where == RegionShape(Ball{{}, 1.0}));
}

TEST_CASE("a change of tissue that is not possible is refused where it is asked for")
{
    Liver liver{FemMaterial{}};
    const RegionShape all = Listed{{0}};
    liver.refused({.where = all, .youngModulus = 0.0}, {"youngModulus", "> 0 Pa", "got 0"});
    liver.refused({.where = all, .poissonRatio = 0.5}, {"poissonRatio", "got 0.5"});
    liver.refused({.where = all, .restScale = 3.0}, {"restScale", "[0.5, 2]", "got 3"});
    liver.refused({.where = all, .density = 1e3}, {"density cannot change during a run"});
    liver.refused({.where = all, .tearingThreshold = 1e3}, {"tearingThreshold", "dynamicTopology"});
    liver.refused({}, {"where", "at least one tetrahedron"});
    liver.refused({.where = Listed{{1}}}, {"where", "[0, 1)", "got 1"});
    liver.refused({.where = Labelled{"cyst"}}, {"where", "'cyst'", "'tumour'"});
    liver.refused({.where = AtInterface{{"tumour"}, {"tumour"}}}, {"where", "second", "another label", "got 7"});
    liver.refused({.where = Ball{{}, -1.0}}, {"radius", "got -1"});
    liver.refused({.where = geometry::Box{{1, 0, 0}, {0, 1, 1}}}, {"where", "high must be >= low"});
    checkError([&] { liver.server.setTissue(liver.id, {.where = all}, TissueFactors{.restScale = 0.4}); },
               {"soft body 'liver': factors: restScale must be in [0.5, 2], got 0.4"});
    liver.server.step(1e-3);
    CHECK(liver.calls.commands.size() == 2); // gravity and the body

    const BodyId rigid = liver.server.add(RigidBodyDef{.name = "tool"});
    checkError([&] { liver.server.setTissue(rigid, {.where = all}); }, {"rigid body 'tool'", "must be a soft body"});
    const BodyId springs =
        liver.server.add(SoftBodyDef{.name = "net", .mesh = oneTetrahedron(), .material = MassSpringMaterial{}});
    checkError([&] { liver.server.setTissue(springs, {.where = all}); }, {"soft body 'net'", "FemMaterial"});
}

TEST_CASE("the stress of fibres is refused for a family that the present material does not have")
{
    Liver liver{FemMaterial{}};
    const auto refused = [&](int family, double stress, const std::vector<std::string>& parts) {
        checkError([&] { liver.server.setFibreStress(liver.id, family, stress); }, parts);
    };
    refused(0, 1e3, {"soft body 'liver'", "family", "[0, 0)", "got 0"});
    liver.server.setMaterial(liver.id, kMuscle);
    CHECK_NOTHROW(liver.server.setFibreStress(liver.id, 0, 1e3));
    refused(1, 1e3, {"family", "[0, 1)", "got 1"});
    refused(-1, 1e3, {"family", ">= 0", "got -1"});
    refused(0, -1.0, {"stress", "got -1"});
    refused(0, 2e9, {"stress", "[0, 1e+09] Pa"});
}

TEST_CASE("a material set by the stepping thread decides which families other threads may name")
{
    Liver liver{kMuscle};
    liver.server.step(1e-3);
    std::thread([&] { liver.server.setFibreStress(liver.id, 0, 1e3); }).join();
    {
        const PhysicsServer::Stepping here(liver.server);
        liver.server.setMaterial(liver.id, FemMaterial{}); // takes what has arrived first: that came before
    }
    liver.server.step(1e-3);
    CHECK(command<SetFibreStress>(liver.calls, liver.calls.commands.size() - 2).stress == 1e3);
    std::thread([&] {
        checkError([&] { liver.server.setFibreStress(liver.id, 0, 1e3); }, {"family", "[0, 0)"});
    }).join();
    {
        const PhysicsServer::Stepping here(liver.server);
        liver.server.setMaterial(liver.id, kMuscle);
    }
    CHECK_NOTHROW(liver.server.setFibreStress(liver.id, 0, 2e3));
    liver.server.step(1e-3);
    CHECK(command<SetFibreStress>(liver.calls, liver.calls.commands.size() - 1).stress == 2e3);
}

TEST_CASE("a stress of fibres that is asked for while the stepping thread builds a material without comes before it")
{
    Liver liver{kMuscle};
    liver.server.step(1e-3);
    liver.calls.build = [&] {
        liver.calls.build = {};
        std::thread([&] { liver.server.setFibreStress(liver.id, 0, 1e3); }).join();
    };
    {
        const PhysicsServer::Stepping here(liver.server);
        liver.server.setMaterial(liver.id, FemMaterial{});
        std::thread([&] {
            checkError([&] { liver.server.setFibreStress(liver.id, 0, 1e3); }, {"family", "[0, 0)"});
        }).join();
    }
    liver.server.step(1e-3);
    REQUIRE(liver.calls.commands.size() == 4);
    CHECK(std::holds_alternative<SetFibreStress>(liver.calls.commands[2]));
    CHECK(std::holds_alternative<SetMaterial>(liver.calls.commands[3]));
}

TEST_CASE("a material with other densities is refused, since mass does not change")
{
    const auto with = [](double density) {
        return FemMaterial{.regions = {{.where = Labelled{"tumour"}, .density = density}}};
    };
    Liver liver{with(2e3)};
    FemMaterial stiffer = with(2e3);
    stiffer.youngModulus = 1e5;
    stiffer.regions.push_back({.where = Labelled{.label = 7}, .youngModulus = 1e6});
    CHECK_NOTHROW(liver.server.setMaterial(liver.id, stiffer)); // names and numbers mean the same
    for (const FemMaterial& other : {with(3e3), FemMaterial{}})
        checkError([&] { liver.server.setMaterial(liver.id, other); },
                   {"soft body 'liver': material.regions", "densities", "mass cannot change"});
}

} // namespace tissue_command_test

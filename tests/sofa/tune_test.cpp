#include "sofa/sofa_stage.h"

#include "filasofia/sofa/tune.h"

#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/core/behavior/ForceField.h>
#include <sofa/simulation/Node.h>

namespace tune_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

using Vec3Types = ::sofa::defaulttype::Vec3Types;
using State = ::sofa::component::statecontainer::MechanicalObject<Vec3Types>;

/// A component that throws in a step, or that makes numbers which are none.
class BadForces final : public ::sofa::core::behavior::ForceField<Vec3Types> {
public:
    SOFA_CLASS(BadForces, SOFA_TEMPLATE(::sofa::core::behavior::ForceField, Vec3Types));
    bool throws = false;
    int calls = 0;

    void addForce(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& f, const DataVecCoord& /*x*/,
                  const DataVecDeriv& /*v*/) override
    {
        if (++calls > 1) return; // once is enough
        if (throws) throw std::runtime_error("out of order");
        (*f.beginEdit())[0][0] = std::nan("");
        f.endEdit();
    }
    void addDForce(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& /*df*/,
                   const DataVecDeriv& /*dx*/) override
    {
    }
    void buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* /*matrix*/) override {}
    void buildDampingMatrix(::sofa::core::behavior::DampingMatrix* /*matrix*/) override {}
    SReal getPotentialEnergy(const ::sofa::core::MechanicalParams* /*params*/, const DataVecCoord& /*x*/) const override
    {
        return 0.0;
    }
    using ForceField::addDForce;
    using ForceField::addForce;
    using ForceField::getPotentialEnergy;
};

SoftBodyDef tissue()
{
    return {.name = "tissue", .mesh = bar(2, 1, 1, {0.02, 0.01, 0.01}), .material = FemMaterial{.law = Corotational{}}};
}

} // namespace

TEST_CASE("tune() reads and changes SOFA's data between two steps")
{
    const auto server = serverWith("sofa", 1e-3, {});
    const BodyId body = server->add(tissue());
    server->step(1e-3);
    std::size_t nodes = 0;
    sofaengine::tune(*server, [&](::sofa::simulation::Node& root, const sofaengine::NodeOf& nodeOf) {
        CHECK(root.getName() == "root");
        CHECK(nodeOf(BodyId{99}) == nullptr);
        auto* state = dynamic_cast<State*>(nodeOf(body)->getMechanicalState());
        REQUIRE(state != nullptr);
        nodes = state->getSize();
        ::sofa::helper::WriteAccessor v(state->v);
        for (auto& each : v) each = {0.1, 0, 0};
    });
    CHECK(server->step(1e-3).has(StepFlag::Tuned));
    CHECK(nodes == 12);
    CHECK(server->latest()->softBody(body)->velocities[0].x == Approx(0.1).epsilon(1e-3));
}

TEST_CASE("a tune() that throws is undone")
{
    const auto server = serverWith("sofa");
    const BodyId body = server->add(tissue());
    server->step(1e-3);
    const auto before = server->latest()->softBody(body)->velocities;
    sofaengine::tune(*server, [&](::sofa::simulation::Node& root, const sofaengine::NodeOf&) {
        root.setGravity({100, 0, 0});
        throw std::runtime_error("no");
    });
    CHECK(server->step(1e-3).has(StepFlag::TuneRejected));
    CHECK(std::abs(server->latest()->softBody(body)->velocities[0].x) < 1e-3); // 0.1 if the gravity had stayed
    CHECK(server->latest()->softBody(body)->velocities[0].y < before[0].y);
}

TEST_CASE("a tune() that leaves a number which is none is undone")
{
    const auto server = serverWith("sofa", 1e-3, {});
    const BodyId body = server->add(tissue());
    server->step(1e-3);
    sofaengine::tune(*server, [&](::sofa::simulation::Node&, const sofaengine::NodeOf& nodeOf) {
        ::sofa::helper::WriteAccessor x(dynamic_cast<State*>(nodeOf(body)->getMechanicalState())->x);
        x[3] = {0, std::nan(""), 0};
    });
    CHECK(server->step(1e-3).has(StepFlag::TuneRejected));
    for (const Vec3 each : server->latest()->softBody(body)->positions) CHECK(length(each) < 0.1);
    CHECK(server->step(1e-3).flags == 0);
}

TEST_CASE("a component that throws, or makes numbers which are none, ends as a flag, with the state put back")
{
    const bool throws = GENERATE(true, false);
    CAPTURE(throws);
    const auto server = serverWith("sofa");
    const BodyId body = server->add(tissue());
    server->step(1e-3);
    const auto before = server->latest()->softBody(body)->positions;
    sofaengine::tune(*server, [&](::sofa::simulation::Node&, const sofaengine::NodeOf& nodeOf) {
        auto bad = ::sofa::core::objectmodel::New<BadForces>();
        bad->throws = throws;
        nodeOf(body)->addObject(bad);
        bad->init();
    });
    CHECK(server->step(1e-3).has(StepFlag::Undone));
    CHECK(server->latest()->softBody(body)->positions == before);
    const StepReport after = server->step(1e-3);
    CHECK_FALSE(after.has(StepFlag::Undone));
    CHECK(server->latest()->softBody(body)->positions[0].y < before[0].y);
}

TEST_CASE("tune() of another engine is refused")
{
    const auto server = serverWith("native");
    CHECK_THROWS_WITH(sofaengine::tune(*server, [](auto&, const auto&) {}), "tune: the engine 'sofa' is not in use");
    CHECK_THROWS_WITH(sofaengine::tune(*serverWith("sofa"), {}), Catch::Contains("must not be empty"));
}

} // namespace tune_test

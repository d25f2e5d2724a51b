#include "filasofia/engine/body/tissue.h"

#include "filasofia/engine/body/elements.h"

#include "filasofia/geometry/shapes.h"

#include "engine/elastic/laws.h"
#include "engine/stage.h"

namespace tissue_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

/// A block with label 1 below z = 0 and 2 above.
geometry::TetMesh labelled()
{
    geometry::TetMesh mesh = *shapes::block({0.02, 0.02, 0.04}, {3, 3, 6});
    for (const geometry::Tetrahedron& t : mesh.tetrahedra) {
        double z = 0.0;
        for (int node : t) z += mesh.nodes[static_cast<std::size_t>(node)].z;
        mesh.labels.push_back(z < 0.0 ? 1 : 2);
    }
    return mesh;
}

Vec3 centreOf(const geometry::Tetrahedron& t, const std::vector<Vec3>& x)
{
    return 0.25 * (x[t[0]] + x[t[1]] + x[t[2]] + x[t[3]]);
}

SoftBodyDef body(const FemMaterial& material)
{
    return {.name = "organ",
            .mesh = shared(labelled()),
            .pose = {{}, axisAngle({0, 1, 0}, 0.5)},
            .material = material,
            .mass = Density{1000.0},
            .gravity = false};
}

const TissueRegion kUpper{.where = Labelled{.label = 2}, .youngModulus = 40e3, .poissonRatio = 0.3, .density = 2000.0};

double largestSpeed(const SoftState& state)
{
    double most = 0.0;
    for (const Vec3& v : state.v) most = std::max(most, length(v));
    return most;
}

} // namespace

TEST_CASE("tissue: regions and the field of stiffness reach the elements, wherever the body is turned")
{
    const geometry::TetMesh mesh = labelled();
    FemMaterial material{.youngModulus = 10e3, .poissonRatio = 0.45, .regions = {kUpper}};
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) material.stiffnessField.push_back(1.0 + 0.001 * double(t));
    Stage stage;
    stage.add(body(material));
    stage.step(0.001);
    double mass = 0.0;
    for (double each : stage.model().masses) mass += each;
    CHECK(std::abs(mass - 0.5 * (1000.0 + 2000.0) * 0.02 * 0.02 * 0.04) < 1e-9);
    for (const FemElement& e : stage.model().elements) {
        const bool upper = mesh.labels[static_cast<std::size_t>(e.tetrahedron)] == 2;
        CHECK(e.youngModulus == (upper ? 40e3 : 10e3 * (1.0 + 0.001 * e.tetrahedron)));
        CHECK(e.poissonRatio == (upper ? 0.3 : 0.45));
        CHECK(e.density == (upper ? 2000.0 : 1000.0));
    }
}

TEST_CASE("tissue: a later region counts where two overlap, and a new material replaces all")
{
    FemMaterial material{.regions = {kUpper, {.where = geometry::Box{{-1, -1, 0.01}, {1, 1, 1}}, .youngModulus = 5e3}}};
    Stage stage;
    const BodyId id = stage.add(body(material));
    stage.step(0.001);
    std::set<double> found;
    for (const FemElement& e : stage.model().elements) found.insert(e.youngModulus);
    CHECK(found == std::set<double>{5e3, 10e3, 40e3});
    stage.post(SetMaterial{id, FemMaterial{.youngModulus = 7e3}});
    stage.step(0.001);
    for (const FemElement& e : stage.model().elements) CHECK(e.youngModulus == 7e3);
}

TEST_CASE("tissue: a stiffer half bends less, with both solvers alike")
{
    FemMaterial material{.youngModulus = 5e3, .poissonRatio = 0.4};
    std::vector<std::vector<Vec3>> ends;
    for (const bool stiff : {false, true})
        for (const Solver& solver : {Solver{Cholesky{}}, Solver{ConjugateGradient{.tolerance = 1e-6}}}) {
            material.regions.clear();
            if (stiff) material.regions = {{.where = Labelled{.label = 1}, .youngModulus = 100e3}};
            SoftBodyDef def = body(material);
            def.pose = {};
            def.solver = solver;
            def.gravity = true;
            def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.0199}}}};
            Stage stage;
            stage.add(def);
            stage.post(SetGravity{{9.81, 0, 0}});
            stage.run(60, 0.005);
            ends.push_back(stage.soft().x);
        }
    const auto most = [](const std::vector<Vec3>& x) {
        double out = 0.0;
        for (const Vec3& each : x) out = std::max(out, each.x - 0.01);
        return out;
    };
    CHECK(most(ends[2]) < 0.6 * most(ends[0]));
    for (int pair : {0, 2})
        for (std::size_t i = 0; i < ends[0].size(); ++i)
            CHECK(distance(ends[static_cast<std::size_t>(pair)][i], ends[static_cast<std::size_t>(pair) + 1][i]) <
                  1e-3 * most(ends[0]));
}

TEST_CASE("tissue: a burn changes the elements that are in it now, shrinks them, and is healed by a reset")
{
    for (const bool assembled : {false, true}) {
        SoftBodyDef def = body({.youngModulus = 10e3, .poissonRatio = 0.4});
        def.pose = {};
        def.solver = ConjugateGradient{.tolerance = 1e-5, .assembled = assembled};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.0199}}}};
        Stage stage;
        const BodyId id = stage.add(def);
        stage.step(0.005);
        const std::vector<Vec3> rest = stage.soft().x;
        const TissueRegion burn{
            .where = Ball{.centre = {0, 0, 0.02}, .radius = 0.011}, .youngModulus = 60e3, .restScale = 0.8};
        stage.post(SetTissue{id, burn});
        const StepReport report = stage.step(0.005);
        CHECK(!report.has(StepFlag::NothingChanged));
        CHECK(!report.has(StepFlag::NotConverged));
        int burnt = 0;
        for (const FemElement& e : stage.model().elements)
            if (e.youngModulus == 60e3) ++burnt;
        CHECK(burnt > 20);
        CHECK(burnt < 200);
        stage.run(200, 0.005);
        double lowered = 0.0; // the top sinks as the burn shrinks
        for (std::size_t i = 0; i < rest.size(); ++i) lowered = std::max(lowered, rest[i].z - stage.soft().x[i].z);
        CHECK(lowered > 1e-3);
        CHECK(largestSpeed(stage.soft()) < 1e-4);
        stage.post(SetTissue{id, {.where = burn.where, .youngModulus = 70e3}}); // what is not given stays
        stage.step(0.005);
        int stillShrunk = 0;
        for (const FemElement& e : stage.model().elements) stillShrunk += e.restScale == 0.8;
        CHECK(stillShrunk == burnt);
        stage.post(Reset{});
        stage.run(2, 0.005);
        for (const FemElement& e : stage.model().elements) {
            CHECK(e.youngModulus == 10e3);
            CHECK(e.restScale == 1.0);
        }
        for (std::size_t i = 0; i < rest.size(); ++i) CHECK(distance(stage.soft().x[i], rest[i]) < 1e-9);
    }
}

TEST_CASE("tissue: factors are of what the material says of each tetrahedron, however often they are set")
{
    FemMaterial material{.youngModulus = 10e3, .poissonRatio = 0.4, .tearingThreshold = 1e5};
    material.regions = {{.where = Listed{{0, 1}}, .youngModulus = 30e3, .tearingThreshold = 2e5, .restScale = 1.1}};
    SoftBodyDef def = body(material);
    def.dynamicTopology = true;
    Stage stage;
    const BodyId id = stage.add(def);
    const auto set = [&](const TissueFactors& factors, std::vector<int> where) {
        stage.post(SetTissue{id, {.where = Listed{std::move(where)}}, factors});
        stage.step(1e-4);
    };
    set({.youngModulus = 5.0, .tearingThreshold = 0.9, .restScale = 0.95}, {0, 2});
    set({.youngModulus = 2.0, .tearingThreshold = 0.5, .restScale = 0.9}, {0, 2});
    const auto of = [&](int tetrahedron) { // elements have an order of their own
        return *std::ranges::find(stage.model().elements, tetrahedron, &FemElement::tetrahedron);
    };
    CHECK(of(0).youngModulus == 2.0 * 30e3);
    CHECK(of(0).tearingThreshold == 0.5 * 2e5);
    CHECK(of(0).restScale == Approx(0.9 * 1.1));
    CHECK(of(1).youngModulus == 30e3);
    CHECK(of(2).youngModulus == 2.0 * 10e3);
    CHECK(of(2).restScale == 0.9);
    CHECK(of(3).tearingThreshold == 1e5);
    CHECK(stage.model().tearingThreshold == 0.5 * 1e5);
    set({}, {0, 2});
    CHECK(of(2).youngModulus == 10e3);
    CHECK(of(2).restScale == 1.0);
    CHECK(of(0).restScale == 1.1);
}

TEST_CASE("tissue: if the terms that relax change, the new ones begin with the present stress")
{
    const auto with = [](const std::vector<PronyTerm>& terms) {
        return FemMaterial{.youngModulus = 10e3, .poissonRatio = 0.4, .relaxation = terms};
    };
    const PronyTerm little{.share = 0.2, .time = 0.05}, much{.share = 0.8, .time = 0.05};
    Stage stage;
    SoftBodyDef def = body(with({little}));
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}}}; // it is held as it is
    const BodyId id = stage.add(def);
    stage.step(0.0);
    for (Vec3& x : stage.soft().x) x.z *= 1.2;
    const auto part = [&] { // relative to the stress of sudden strain
        const Corners x = cornersOf(stage.model().elements[0].nodes, stage.soft().x);
        const Deformation at{gradient(stage.model().elements[0], x), toMat3(rotationOf(stage.soft().rotations, 0))};
        const Mat3 all = stressAt(NeoHookean{}, lameOf(stage.model().elements[0]), at);
        return tissueStress(stage.model(), stage.soft(), relaxationWithin(stage.model(), 0.0), 0, at)[2][2] / all[2][2];
    };
    const auto change = [&](const FemMaterial& material) {
        stage.post(SetMaterial{id, material});
        stage.step(0.005);
    };
    stage.run(200, 0.005);
    CHECK(part() == Approx(0.8).margin(1e-3));
    FemMaterial same = with({little});
    same.validStrain = 0.5;
    change(same); // the terms go on
    CHECK(part() == Approx(0.8).margin(1e-3));
    for (const auto& terms : {std::vector{much}, {little, little}, {much}}) {
        change(with(terms));
        CHECK(part() == Approx(1.0).margin(1e-3));
        stage.run(200, 0.005);
        CHECK(part() == Approx(terms.size() == 2 ? 0.6 : 0.2).margin(1e-3));
    }
}

TEST_CASE("tissue: the local change of a burn is what a new system for the same elements computes")
{
    const TissueRegion burn{
        .where = Ball{.centre = {0, 0, 0.02}, .radius = 0.011}, .youngModulus = 60e3, .restScale = 0.8};
    std::vector<std::vector<Vec3>> ends;
    for (const bool rebuilt : {false, true}) {
        SoftBodyDef def = body({.youngModulus = 10e3, .poissonRatio = 0.4});
        def.pose = {};
        def.solver = ConjugateGradient{.tolerance = 1e-6};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.0199}}}};
        Stage stage;
        const BodyId id = stage.add(def);
        stage.step(0.005);
        stage.post(SetTissue{id, burn});
        stage.step(0.0);
        if (rebuilt) stage.world.scene().soft[0].system.outdated = true;
        stage.run(40, 0.005);
        ends.push_back(stage.soft().x);
    }
    for (std::size_t i = 0; i < ends[0].size(); ++i) CHECK(distance(ends[0][i], ends[1][i]) < 1e-6);
}

TEST_CASE("tissue: a change that reaches nothing is reported")
{
    Stage stage;
    const BodyId id = stage.add(body({}));
    stage.step(0.005);
    stage.post(SetTissue{id, {.where = Ball{.centre = {5, 0, 0}, .radius = 0.1}, .youngModulus = 1e3}});
    CHECK(stage.step(0.005).has(StepFlag::NothingChanged));
    CHECK(!stage.model().patched);
}

TEST_CASE("tissue: each region tears at its own stress")
{
    const auto torn = [](double lower, double upper) {
        SoftBodyDef def = body({.youngModulus = 10e3,
                                .poissonRatio = 0.3,
                                .tearingThreshold = lower,
                                .regions = {{.where = Labelled{.label = 2}, .tearingThreshold = upper}}});
        def.pose = {};
        def.dynamicTopology = true;
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.0199}}},
                           {.box = geometry::Box{{-1, -1, 0.0199}, {1, 1, 1}}}};
        Stage stage;
        stage.add(def);
        stage.step(0.002);
        for (Vec3& x : stage.soft().x) x.z *= 1.3; // about 3 kPa everywhere
        std::array<bool, 2> at{};
        for (int step = 0; step < 10; ++step)
            for (const Rupture& each : stage.step(0.002).topology.ruptures)
                if (std::abs(each.place.z) > 0.004) at[each.place.z > 0.0 ? 1 : 0] = true; // not between the two
        return at;
    };
    CHECK(torn(1e9, 1e9) == std::array{false, false});
    CHECK(torn(1e3, 1e9) == std::array{true, false});
    CHECK(torn(1e9, 1e3) == std::array{false, true});
}

TEST_CASE("tissue: strain beyond the range of the material is reported, with the worst element, by both solvers")
{
    for (const auto& [name, law] : everyLaw())
        for (const bool assembled : {false, true}) {
            INFO(name);
            SoftBodyDef def = body({.youngModulus = 10e3, .poissonRatio = 0.3, .law = law, .validStrain = 0.25});
            def.pose = {};
            def.solver = ConjugateGradient{.assembled = assembled};
            Stage stage;
            stage.add(def);
            CHECK(!stage.step(0.001).has(StepFlag::BeyondStrain));
            SoftState& state = stage.soft();
            for (Vec3& x : state.x) x.z *= x.z > 0.0 ? 1.3 : 1.2;
            const std::vector<Vec3> before = state.x;
            const StepReport report = stage.step(0.001);
            CHECK(report.has(StepFlag::BeyondStrain));
            CHECK(report.beyondStrain.count == static_cast<int>(stage.model().elements.size()) / 2);
            CHECK(std::abs(report.beyondStrain.strain - 0.3) < 1e-6);
            CHECK(report.beyondStrain.valid == 0.25);
            CHECK(report.beyondStrain.place.z > 0.0);
            const int worst = report.beyondStrain.element;
            const auto& mesh = std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh);
            CHECK(distance(centreOf(mesh->tetrahedra.at(worst), before), report.beyondStrain.place) < 1e-9);
            for (Vec3& x : state.x) x = 0.7 * x; // as much too short as it was too long
            CHECK(stage.step(0.001).has(StepFlag::BeyondStrain));
        }
}

TEST_CASE("tissue: beyond the limit of its law, tissue is reported, also where principal stretches have no bound")
{
    constexpr double limit = 0.5; // [-] i1 - 3 is 0.49 at 1.454 times the length and a constant volume
    const auto reportOf = [&](double length, double valid, bool assembled) {
        SoftBodyDef def =
            body({.youngModulus = 10e3, .poissonRatio = 0.3, .law = Gent{.limit = limit}, .validStrain = valid});
        def.pose = {};
        def.solver = ConjugateGradient{.assembled = assembled};
        Stage stage;
        stage.add(def);
        stage.step(0.001);
        const double across = 1.0 / std::sqrt(length);
        for (Vec3& x : stage.soft().x) x = {across * x.x, across * x.y, length * x.z};
        const StepReport report = stage.step(0.001);
        CHECK(report.has(StepFlag::BeyondStrain) == (report.beyondStrain.count > 0));
        if (report.beyondStrain.count > 0)
            CHECK(report.beyondStrain.count == static_cast<int>(stage.model().elements.size()));
        return report.beyondStrain;
    };
    const double reach = std::sqrt(1.0 + 0.98 * limit / 3.0) - 1.0;
    const auto mean = [](double length) { return std::sqrt((length * length + 2.0 / length) / 3.0) - 1.0; };
    for (const bool assembled : {false, true}) {
        const double none = std::numeric_limits<double>::infinity();
        CHECK(reportOf(1.44, none, assembled).count == 0);
        const StrainedElements beyond = reportOf(1.46, none, assembled);
        CHECK(beyond.count > 0);
        CHECK(beyond.valid == Approx(reach));
        CHECK(beyond.strain == Approx(mean(1.46)));
        // With both, the one that is exceeded by more.
        CHECK(reportOf(1.46, 0.3, assembled).strain == Approx(0.46));
        CHECK(reportOf(1.46, 0.455, assembled).strain == Approx(mean(1.46)));
    }
}

} // namespace tissue_test

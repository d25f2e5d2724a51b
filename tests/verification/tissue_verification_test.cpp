#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/geometry/shapes.h"

#include "verification/verification.h"

/// Tissue that relaxes, has fibres, contracts and shrinks, against closed forms.
namespace tissue_verification_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

const std::vector<PronyTerm> kTerms{{.share = 0.3, .time = 0.05}, {.share = 0.2, .time = 0.4}};
constexpr double kHalf = 0.02; ///< [m] half the height

SoftBodyDef column(const FemMaterial& material, const Solver& solver)
{
    return {.mesh = shapes::block({0.02, 0.02, 2.0 * kHalf}, {3, 3, 6}),
            .material = material,
            .mass = Density{10.0}, // light: waves have passed long before the tissue has relaxed
            .rayleigh = {0.0, 1e-3},
            .gravity = false,
            .solver = solver};
}

double relaxationAt(double t)
{
    double out = 1.0;
    for (const PronyTerm& term : kTerms) out -= term.share * (1.0 - std::exp(-t / term.time));
    return out;
}

double heightOf(const std::vector<Vec3>& x)
{
    const geometry::Box box = geometry::boxAround(x);
    return box.high.z - box.low.z;
}

} // namespace

TEST_CASE("relaxation: a column that is stretched and held pulls less and less, as its Prony series says")
{
    for (const auto& [name, law] : everyLaw()) {
        FemMaterial material{.youngModulus = 10e3, .poissonRatio = 0.4, .law = law};
        SoftBodyDef def = column(material, Cholesky{});
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.99 * kHalf}}},
                           {.box = geometry::Box{{-1, -1, 0.99 * kHalf}, {1, 1, 1}}}};
        Stage stage;
        const BodyId id = stage.add(def);
        stage.step(0.01);
        for (Vec3& x : stage.soft().x) x.z *= 1.3;
        stage.run(60, 0.01); // to equilibrium
        const auto pull = [&] { return stage.world.scene().attachmentReports[1].force.z; };
        const double first = pull();
        material.relaxation = kTerms;
        stage.post(SetMaterial{id, material});
        double worst = 0.0, time = 0.0;
        for (int step = 0; step < 100; ++step) {
            stage.step(0.01);
            time += 0.01;
            worst = std::max(worst, std::abs(pull() / first - relaxationAt(time)));
        }
        verify(text("relaxation of a stretched column over 1 s, ", name, ", error of the force relative to the first"),
               worst, 1e-3);
    }
}

TEST_CASE("relaxation: a column under a constant load creeps as the compliance of its Prony series says")
{
    constexpr double kShare = 0.4, kTime = 0.2;
    Stage stage;
    SoftBodyDef def = column({.youngModulus = 10e3,
                              .poissonRatio = 0.0,
                              .law = Corotational{},
                              .relaxation = {{.share = kShare, .time = kTime}}},
                             Cholesky{});
    def.rayleigh = {0.0, 0.0};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.99 * kHalf}}}};
    const BodyId id = stage.add(def);
    std::vector<NodalForce> load;
    const geometry::TetMesh& mesh = *std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        if (mesh.nodes[i].z > 0.99 * kHalf) load.push_back({static_cast<int>(i), {0, 0, 1e-4}});
    stage.post(SetForces{id, load});
    constexpr double kStep = 1e-3;
    stage.step(kStep);
    // The first few steps are the wave of the sudden load.
    double first = 0.0, worst = 0.0;
    for (int step = 2; step <= 1000; ++step) {
        stage.step(kStep);
        const double longer = heightOf(stage.soft().x) - 2.0 * kHalf, time = step * kStep;
        const double compliance = (1.0 - kShare * std::exp(-(1.0 - kShare) * time / kTime)) / (1.0 - kShare);
        if (step == 200) first = longer / compliance;
        if (step > 200) worst = std::max(worst, std::abs(longer / first / compliance - 1.0));
    }
    verify("creep of a column under a constant load, from 0.2 to 1 s, relative error of its extension", worst, 1e-3);
}

TEST_CASE("fibres: the default solver and a direct one move a column with fibres and relaxation alike")
{
    for (const auto& [name, law] : everyLaw()) {
        FemMaterial material{.youngModulus = 10e3, .poissonRatio = 0.4, .law = law};
        material.fibres = {{.stiffness = 5e3, .exponent = 2.0, .dispersion = 0.1, .direction = Along{{1, 0, 1}}},
                           {.stiffness = 3e3, .activeStress = 2e3, .direction = Around{.pitch = 0.5}}};
        material.relaxation = kTerms;
        std::vector<std::vector<Vec3>> ends;
        for (const Solver& solver : {Solver{Cholesky{}}, Solver{ConjugateGradient{.tolerance = 1e-6}}}) {
            Stage stage;
            SoftBodyDef def = column(material, solver);
            def.mass = Density{1000.0};
            def.gravity = true;
            def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.99 * kHalf}}}};
            stage.add(def);
            stage.post(SetGravity{{9.81, 0, 0}});
            stage.run(100, 0.005);
            ends.push_back(stage.soft().x);
        }
        double apart = 0.0, moved = 0.0;
        for (std::size_t i = 0; i < ends[0].size(); ++i) {
            apart = std::max(apart, distance(ends[0][i], ends[1][i]));
            moved = std::max(moved, std::abs(ends[0][i].x));
        }
        verify(text("fibres and relaxation, ", name, ", default solver against Cholesky, relative difference"),
               apart / moved, 1e-4);
    }
}

TEST_CASE("active stress: a free column shortens by the stress over Young's modulus")
{
    Stage stage;
    const BodyId id = stage.add(column(
        {.youngModulus = 10e3, .poissonRatio = 0.3, .fibres = {{.stiffness = 0.0, .direction = Along{{0, 0, 1}}}}},
        Cholesky{}));
    stage.run(5, 0.01);
    CHECK(std::abs(heightOf(stage.soft().x) - 2.0 * kHalf) < 1e-9);
    stage.post(SetFibreStress{id, 0, 20.0});
    stage.run(100, 0.01);
    const double strain = heightOf(stage.soft().x) / (2.0 * kHalf) - 1.0;
    verify("active stress of 0.2 % of Young's modulus, relative error of the shortening",
           std::abs(strain / -2e-3 - 1.0), 1e-2);
}

TEST_CASE("rest scale: a free body shrinks to its scale and is at rest there, with every law and both solvers")
{
    for (const auto& [name, law] : everyLaw())
        for (const Solver& solver : {Solver{Cholesky{}}, Solver{ConjugateGradient{}}}) {
            INFO(name);
            FemMaterial material{.youngModulus = 10e3, .poissonRatio = 0.3, .law = law};
            material.regions = {{.where = geometry::Box{{-1, -1, -1}, {1, 1, 1}}, .restScale = 0.9}};
            Stage stage;
            stage.add(column(material, solver));
            stage.run(100, 0.01);
            CHECK(std::abs(heightOf(stage.soft().x) / (2.0 * kHalf) - 0.9) < 1e-3);
        }
}

TEST_CASE("plasticity: tissue sheared to and fro bears its yield stress, and keeps what has flowed")
{
    constexpr double kYield = 200.0, kYoung = 20e3, kNu = 0.3, kMost = 0.1;
    const double mu = lame(kYoung, kNu).mu, limit = kYield / std::sqrt(3.0);
    double worst = 0.0, worstStay = 0.0;
    for (const auto& [name, law] : everyLaw()) {
        Stage stage;
        stage.add(SoftBodyDef{
            .mesh = shapes::block({0.01, 0.01, 0.01}, {2, 2, 2}),
            .material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu, .law = law, .yieldStress = kYield},
            .gravity = false});
        stage.step(1e-9);
        const auto shearTo = [&](double shear) {
            SoftState& state = stage.soft();
            for (std::size_t i = 0; i < state.x.size(); ++i)
                state.x[i] = stage.model().rest[i] + shear * stage.model().rest[i].z * Vec3{1, 0, 0};
            for (auto* list : {&state.v, &state.dv, &state.residual}) std::ranges::fill(*list, Vec3{});
            stage.step(1e-9);
            const FemElement& element = stage.model().elements[0];
            return endStress(stage.model(), state, 0, gradient(element, cornersOf(element.nodes, state.x)))[0].z;
        };
        // mu times the shear since the stress was zero, but no more than the limit
        double zeroAt = 0.0, before = 0.0, stress = 0.0, stays = -1.0;
        for (int i = 1; i <= 300; ++i) {
            const double shear = kMost * (i <= 100 ? 0.01 * i : 2.0 - 0.01 * i);
            const double expected = std::clamp(mu * (shear - zeroAt), -limit, limit);
            zeroAt = shear - expected / mu;
            const double last = stress;
            stress = shearTo(shear);
            worst = std::max(worst, std::abs(stress - expected) / limit);
            if (i > 100 && last > 0.0 && stress <= 0.0 && stays < 0.0)
                stays = before + (shear - before) * last / (last - stress);
            before = shear;
        }
        worstStay = std::max(worstStay, std::abs(stays - (kMost - limit / mu)) / kMost);
    }
    verify("ideal plasticity in shear to 0.1 and back, every law, error of the stress over its limit", worst, 0.02);
    verify("the same, error of the shear that stays over 0.1", worstStay, 0.01);
}

} // namespace tissue_verification_test

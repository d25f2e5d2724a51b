#include "verification/verification.h"

namespace momentum_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

struct Momenta {
    Vec3 linear, angular;
    double speed = 0.0; ///< [kg m/s] sum of m |v|
};

Momenta momenta(const SoftModel& model, const SoftState& state)
{
    Momenta sum;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
        const Vec3 p = model.masses[i] * state.v[i];
        sum.linear += p;
        sum.angular += cross(state.x[i], p);
        sum.speed += length(p);
    }
    return sum;
}

/// A bunny released in a stretched state, spinning about an axis through its middle.
Stage spinning(const Solver& solver)
{
    Stage stage;
    // Soft, so that the step sizes below resolve its fastest vibration.
    SoftBodyDef def{.mesh = bunnyFile(756),
                    .material = FemMaterial{.youngModulus = 1e3},
                    .rayleigh = {0, 0},
                    .gravity = false,
                    .solver = solver};
    stage.add(def);
    stage.step(0.0);
    for (std::size_t i = 0; i < stage.soft().x.size(); ++i) {
        const Vec3 p = stage.soft().x[i] - Vec3{-0.02, 0.1, 0};
        stage.soft().x[i] += Vec3{0.1 * p.x, 0, 0.05 * p.y};
        stage.soft().v[i] = cross({2.0, 10.0, 3.0}, p) + Vec3{0.5, 0, 0.1};
    }
    return stage;
}

double angularDrift(double dt)
{
    Stage stage = spinning(Cholesky{});
    const Momenta before = momenta(stage.model(), stage.soft());
    stage.run(static_cast<int>(std::lround(0.1 / dt)), dt);
    return length(momenta(stage.model(), stage.soft()).angular - before.angular) / length(before.angular);
}

/// The torque of a deformed bunny's internal forces, over the sum of the absolute torques.
double relativeTorque(const SoftMaterial& material, const Solver& solver, std::mt19937& random)
{
    Stage stage;
    SoftBodyDef def{.mesh = bunnyFile(756),
                    .material = material,
                    .rayleigh = {0, 0},
                    .gravity = false,
                    .integrator = ExplicitEuler{},
                    .solver = solver};
    stage.add(def);
    stage.step(0.0);
    for (Vec3& x : stage.soft().x) x += randomVec3(random, 0.01);
    const std::vector<Vec3> forces = forcesNow(stage);
    Vec3 torque;
    double terms = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        torque += cross(stage.soft().x[i], forces[i]);
        terms += length(cross(stage.soft().x[i], forces[i]));
    }
    return length(torque) / terms;
}

/// Boxes, each hung up by the node in one corner and released.
struct Hung {
    std::array<int, 3> cells;
    int count = 1; ///< number of boxes in one body
    double cell = 0.004;
    double youngModulus = 2e4;
    double dt = 1e-3;

    [[nodiscard]] double length() const { return cell * cells[0]; }
    [[nodiscard]] SoftBodyDef def() const
    {
        const geometry::TetMesh box = boxMesh(cells, {cell * cells[0], cell * cells[1], cell * cells[2]});
        geometry::TetMesh mesh;
        std::vector<int> corners;
        for (int i = 0; i < count; ++i) {
            const int first = static_cast<int>(mesh.nodes.size());
            corners.push_back(first);
            for (Vec3 p : box.nodes) mesh.nodes.push_back(p + Vec3{0, 0, 2.0 * cell * cells[2] * i});
            for (auto [a, b, c, d] : box.tetrahedra)
                mesh.tetrahedra.push_back({first + a, first + b, first + c, first + d});
        }
        return {.mesh = shared(std::move(mesh)),
                .material = FemMaterial{.youngModulus = youngModulus, .poissonRatio = 0.3},
                .rayleigh = {0, 0},
                .attachments = {{.nodes = corners}}};
    }
};

/// The largest energy that it has in 4 s without the elastic energy (which was 0 at first and is never less), over the
/// energy of a fall by its length.
double energyFromNowhere(const Hung& hung)
{
    Stage stage;
    stage.add(hung.def());
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.step(0.0);
    const std::vector<Vec3> start = stage.soft().x;
    double mass = 0.0, highest = 0.0;
    for (double each : stage.model().masses) mass += each;
    for (int i = 0; i < 4.0 / hung.dt; ++i) {
        stage.step(hung.dt);
        double energy = 0.0;
        for (std::size_t k = 0; k < start.size(); ++k) {
            const Vec3 v = stage.soft().v[k];
            energy += stage.model().masses[k] * (0.5 * dot(v, v) + 9.81 * (stage.soft().x[k].y - start[k].y));
        }
        highest = std::max(highest, energy / (mass * 9.81 * hung.length()));
    }
    return highest;
}

} // namespace

TEST_CASE("a free body without damping keeps its linear momentum")
{
    struct Case {
        Solver solver;
        const char* name;
        double bound;
    };
    const Case cases[] = {
        {Cholesky{}, "Cholesky", 1e-9},
        {ConjugateGradient{.maxIterations = 2000, .tolerance = 1e-12, .assembled = true}, "CG at 1e-12", 1e-9},
        {ConjugateGradient{}, "the default solver, in float", 1e-5}};
    for (const auto& [solver, name, bound] : cases) {
        Stage stage = spinning(solver);
        const Momenta before = momenta(stage.model(), stage.soft());
        stage.run(200, 0.002);
        const Momenta after = momenta(stage.model(), stage.soft());
        verify(text("linear momentum after 200 steps, ", name, ", relative change"),
               length(after.linear - before.linear) / length(before.linear), bound);
    }
}

TEST_CASE("internal forces produce no torque")
{
    for (const auto& [solver, name, bound] :
         {std::tuple{Solver{Cholesky{}}, "double", 1e-10}, std::tuple{Solver{ConjugateGradient{}}, "float", 1e-7}})
        for (const SoftMaterial& material : {SoftMaterial{FemMaterial{}}, SoftMaterial{MassSpringMaterial{}}}) {
            std::mt19937 random(51);
            double worst = 0.0;
            for (int k = 0; k < 5; ++k) worst = std::max(worst, relativeTorque(material, solver, random));
            const bool elements = std::holds_alternative<FemMaterial>(material);
            verify(text("torque of internal forces over its terms, ", elements ? "elements" : "springs", ", ", name),
                   worst, bound);
        }
}

TEST_CASE("the drift of angular momentum halves with dt under implicit Euler")
{
    const double coarse = angularDrift(0.0005), middle = angularDrift(0.00025), fine = angularDrift(0.000125);
    tell("angular momentum lost in 0.1 s at dt = 0.25 ms, relative", middle);
    verifyWithin("angular momentum drift, ratio of dt = 0.5 ms to 0.25 ms", coarse / middle, 1.7, 2.3);
    verifyWithin("angular momentum drift, ratio of dt = 0.25 ms to 0.125 ms", middle / fine, 1.7, 2.3);
}

TEST_CASE("a body that hangs by one node and swings never has more energy than at first, however small it is")
{
    for (const auto& [cells, count] :
         {std::pair{std::array{1, 1, 1}, 1}, {{2, 1, 1}, 1}, {{3, 2, 2}, 1}, {{1, 1, 1}, 9}})
        verify(text("energy gained by ", count, " boxes of ", cells[0], " x ", cells[1], " x ", cells[2],
                    " cells, over a fall by their length"),
               energyFromNowhere({.cells = cells, .count = count}), 0.03);
}

TEST_CASE("a few stiff elements that hang by one node gain no energy in long steps")
{
    for (double dt : {1e-3, 5e-3}) {
        verify(text("energy gained by a rod of 1 MPa in steps of ", dt, " s, over a fall by its length"),
               energyFromNowhere({.cells = {4, 1, 1}, .youngModulus = 1e6, .dt = dt}), 0.1);
        verify(text("energy gained by a thread of 30 cells in steps of ", dt, " s, over a fall by its length"),
               energyFromNowhere({.cells = {30, 1, 1}, .cell = 0.002, .youngModulus = 1e6, .dt = dt}), 0.1);
    }
}

} // namespace momentum_test

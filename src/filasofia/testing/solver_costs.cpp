#include "filasofia/testing/solver_costs.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/step/stages.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

// Additions and multiplications of one element; a fused multiply-add is two. The search for the rotation takes two
// iterations of 180 in a body that moves.
constexpr double kElementPassFlops = 735.0;
constexpr double kProductFlops = 135.0;

} // namespace

SolverCosts measureSolver(const physics::SoftBodyDef& def, Vec3 gravity, double period, int threads, int warmUp,
                          int repeats, const std::function<std::int64_t()>& now)
{
    const std::unique_ptr<physics::BuiltBody> built = buildBody(def, period);
    auto& body = dynamic_cast<BuiltSoftBody&>(*built);
    FILASOFIA_ASSERT(warmUp >= 0 && repeats > 0);
    if (!body.system.matrixFree || body.model.elements.empty() ||
        !std::holds_alternative<physics::ImplicitEuler>(body.model.integrator))
        fail("soft body '", def.name,
             "': only the default solver and integrator of a body of elements can be measured");
    Model model;
    State state;
    Systems systems;
    Coupling coupling; // nothing touches it
    state.gravity = gravity;
    model.softBodies.push_back(std::move(body.model));
    state.softBodies.push_back(std::move(body.state));
    systems.push_back(std::move(body.system));
    WorkerPool pool(threads);
    for (int i = 0; i < warmUp; ++i) {
        physics::StepReport report;
        assemble(model, period, state, systems, pool);
        advance(model, period, nullptr, physics::ExactContact{}, systems, coupling, state, pool, report);
    }

    const auto median = [&](const auto& part) {
        std::vector<double> times;
        for (int i = 0; i < repeats; ++i) {
            const std::int64_t start = now();
            part();
            times.push_back(1e-9 * static_cast<double>(now() - start));
        }
        std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
        return times[static_cast<std::size_t>(repeats / 2)];
    };
    MatrixFreeSystem& system = *systems.front().matrixFree;
    const SoftModel& soft = model.softBodies.front();
    const std::vector<Vec3>& given = systems.front().forces;
    linalg::NodeArray p = system.unknowns(), q = p;
    for (int i = 0; i < 16 * p.blocks(); ++i) p[i][i % 3] = 1.0f;
    SolverCosts costs{.elements = static_cast<int>(soft.elements.size()),
                      .nodes = static_cast<int>(soft.rest.size()),
                      .coarseNodes = system.coarseNodes()};
    costs.elementPass = median([&] { system.assemble(soft, given, period, 1.0, state.softBodies.front(), pool); });
    costs.product = median([&] { system.multiply(p, q, pool); });
    costs.preconditioner = median([&] { system.precondition(q, p, pool); });
    costs.flops = costs.elements * (kElementPassFlops + 2.0 * kProductFlops);
    return costs;
}

std::vector<std::string> simdTargets() { return linalg::simdTargets(); }

} // namespace filasofia::engine

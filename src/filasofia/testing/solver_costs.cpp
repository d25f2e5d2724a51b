#include "filasofia/testing/solver_costs.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/step/advance.h"
#include "filasofia/engine/step/assemble.h"

#include <algorithm>
#include <utility>

namespace filasofia::testing {
using namespace engine;
namespace {

// Additions and multiplications per element; a fused multiply-add counts as two. The search for the rotation takes two
// iterations of 180 operations if the body moves.
constexpr double kElementPassFlops = 735.0;
constexpr double kProductFlops = 135.0;

} // namespace

SolverCosts measureSolver(const physics::SoftBodyDef& bodyDef, const SolverCostsDef& def)
{
    const std::unique_ptr<physics::BuiltBody> built = buildBody(bodyDef, def.period);
    SoftBody& body = dynamic_cast<BuiltSoftBody&>(*built).body;
    FILASOFIA_ASSERT(def.warmUp >= 0 && def.repeats > 0);
    if (!body.system.matrixFree || body.model.elements.empty() ||
        !std::holds_alternative<physics::ImplicitEuler>(body.model.integrator))
        fail("soft body '", bodyDef.name, "': only a FEM body with the default solver and integrator can be measured");
    Scene scene;
    Coupling coupling; // without constraints
    scene.gravity = def.gravity;
    scene.soft.push_back(std::move(body));
    WorkerPool pool(def.threads);
    const physics::ContactMethod method = physics::ExactContact{};
    for (int i = 0; i < def.warmUp; ++i) {
        physics::StepReport report;
        const StepContext context{def.period, nullptr, method, pool, report};
        assemble(context, scene);
        advance(context, scene, coupling);
    }

    const auto median = [&](const auto& part) {
        std::vector<double> times;
        for (int i = 0; i < def.repeats; ++i) {
            const std::int64_t start = def.now();
            part();
            times.push_back(1e-9 * static_cast<double>(def.now() - start));
        }
        std::nth_element(times.begin(), times.begin() + def.repeats / 2, times.end());
        return times[static_cast<std::size_t>(def.repeats / 2)];
    };
    SoftBody& measured = scene.soft.front();
    const SoftModel& soft = measured.model;
    MatrixFreeSystem& system = *measured.system.matrixFree;
    const std::vector<Vec3>& given = measured.system.forces;
    linalg::NodeArray p = system.unknowns(), q = p;
    for (int i = 0; i < 16 * p.blocks(); ++i) p[i][i % 3] = 1.0f;
    SolverCosts costs{.elements = static_cast<int>(soft.elements.size()),
                      .nodes = static_cast<int>(soft.rest.size()),
                      .coarseNodes = system.coarseNodes()};
    costs.elementPass = median([&] { system.assemble(soft, given, def.period, 1.0, measured.state, pool); });
    costs.product = median([&] { system.multiply(p, q, pool); });
    costs.preconditioner = median([&] { system.precondition(q, p, pool); });
    costs.flops = costs.elements * (kElementPassFlops + 2.0 * kProductFlops);
    return costs;
}

} // namespace filasofia::testing

#include "sofa/sofa_stage.h"

#include "filasofia/sofa/compliant_factor.h"
#include "filasofia/sofa/tune.h"

#include <sofa/linearalgebra/FullMatrix.h>
#include <sofa/simulation/Node.h>

#include <random>

namespace compliant_factor_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;
using sofaengine::CompliantFactor;
using Dense = ::sofa::linearalgebra::FullMatrix<SReal>;

namespace {

/// Rows of a few numbers each, some in the same places, as contacts have them.
CompliantFactor::JMatrixType rowsLike(int rows, int numbers, int entries, std::mt19937& random)
{
    CompliantFactor::JMatrixType j;
    j.resize(rows, numbers);
    for (int r = 0; r < rows; ++r) {
        if (r % 7 == 3) continue; // rows of other bodies are empty here
        for (int e = 0; e < entries; ++e)
            j.set(r, static_cast<int>(random() % static_cast<unsigned>(r % 2 == 0 ? 30 : numbers)),
                  static_cast<double>(random()) / 4e9 - 0.5);
    }
    return j;
}

} // namespace

TEST_CASE("how far constraints move each other is what SOFA's own factor says")
{
    const auto server = serverWith("sofa");
    const SoftBodyDef def{.name = "tissue",
                          .mesh = bar(5, 4, 3, {0.05, 0.04, 0.03}),
                          .material = FemMaterial{.law = Corotational{}},
                          .solver = Cholesky{}};
    const BodyId body = server->add(def);
    server->step(1e-3);
    sofaengine::tune(*server, [&](::sofa::simulation::Node&, const sofaengine::NodeOf& nodeOf) {
        auto* own = nodeOf(body)->getTreeObject<CompliantFactor>();
        REQUIRE(own != nullptr);
        auto* matrix = dynamic_cast<sofaengine::Blocks*>(own->getLinearSystem()->getSystemBaseMatrix());
        REQUIRE(matrix != nullptr);
        const int numbers = static_cast<int>(matrix->colSize());
        std::mt19937 random(1);
        for (const int rows : {1, 3, 40, 150}) {
            CAPTURE(rows);
            const auto j = rowsLike(rows, numbers, rows == 1 ? 1 : 9, random);
            Dense here, sofas;
            here.resize(rows, rows);
            sofas.resize(rows, rows);
            own->addJMInvJtLocal(matrix, &here, &j, 0.5);
            own->CompliantFactor::Factor::addJMInvJtLocal(matrix, &sofas, &j, 0.5);
            double largest = 0.0, apart = 0.0;
            for (int r = 0; r < rows; ++r)
                for (int s = 0; s < rows; ++s) {
                    largest = std::max(largest, std::abs(sofas.element(r, s)));
                    apart = std::max(apart, std::abs(sofas.element(r, s) - here.element(r, s)));
                }
            CHECK(largest > 0.0);
            CHECK(apart < 1e-12 * largest);
        }
        CompliantFactor::JMatrixType none;
        none.resize(3, numbers);
        Dense zero;
        zero.resize(3, 3);
        CHECK(own->addJMInvJtLocal(matrix, &zero, &none, 1.0));
    });
    CHECK_FALSE(server->step(1e-3).has(StepFlag::TuneRejected));
}

} // namespace compliant_factor_test

#include "engine/sheets.h"
#include "engine/stage.h"

namespace shell_tearing_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

TEST_CASE("a strip of a shell tears at its threshold for every step length")
{
    const double youngModulus = 20e3, threshold = 4e3, side = 0.04;
    for (double dt : {1e-3, 5e-4}) {
        SoftBodyDef def{.mesh = shared(sheetMesh({16, 6}, side, 0.015)),
                        .material = ShellMaterial{.youngModulus = youngModulus,
                                                  .poissonRatio = 0.0,
                                                  .thickness = 1e-3,
                                                  .tearingThreshold = threshold},
                        .gravity = false,
                        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
                        .dynamicTopology = true};
        Stage stage;
        const BodyId strip = stage.add(def);
        const BodyId clamp = stage.add(RigidBodyDef{.name = "clamp", .elements = {Pose{.position = {side, 0, 0}}}});
        stage.post(Attach{
            AttachmentId{9},
            strip,
            {.box = geometry::Box{{side - 1e-6, -1, -1}, {side + 1e-6, 1, 1}}, .stiffness = kHard, .to = clamp}});
        stage.step(dt);
        double stretch = 1.0, area = 0.0;
        for (; stretch < 1.6 && area == 0.0; stretch += 0.1 * dt) {
            stage.post(SetPose{clamp, 0, Pose{.position = {side * stretch, 0, 0}}});
            for (const Rupture& each : stage.step(dt).topology.ruptures) {
                CHECK(each.kind == Rupture::Kind::Tear);
                area += each.area;
            }
        }
        // Uniaxial, nu = 0: psi depends on det C alone, so mu (l - (1+q)^2/(q+l^2)^2 l) per area at rest, with q = 1;
        // the Cauchy stress divides by width 1 and the stretch of the thickness 2 l / (1 + l^2).
        double expected = 1.0;
        const auto stress = [&](double l) {
            const double mu = 0.5 * youngModulus;
            return mu * (l - 4.0 * l / ((1 + l * l) * (1 + l * l))) * (1 + l * l) / (2 * l);
        };
        while (stress(expected) < threshold) expected += 1e-5;
        INFO("stretch " << stretch << ", expected " << expected);
        CHECK(area > 0.0);
        CHECK(std::abs((stretch - 1.0) / (expected - 1.0) - 1.0) < 0.05);
        int detached = 0;
        for (int i = 0; i < 1500 && detached == 0; ++i) {
            stage.post(SetPose{clamp, 0, Pose{.position = {side * (stretch += 2e-4), 0, 0}}});
            const StepReport report = stage.step(1e-3);
            CHECK(report.flags == 0);
            for (const Rupture& each : report.topology.ruptures) detached += static_cast<int>(each.detached.size());
        }
        CHECK(detached > 0);
        check(stage.model(), stage.soft());
    }
}

} // namespace shell_tearing_test

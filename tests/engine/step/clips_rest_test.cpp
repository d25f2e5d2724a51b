#include "engine/stage.h"
#include "engine/step/clip_body.h"

namespace clips_rest_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

TEST_CASE("a clipped vessel rests, also if nothing damps its stiffness")
{
    // The step did not know how stiff a leg under tension is across itself: nodes went to and fro by 1.3 mm for ever.
    for (const double rate : {500.0, 2000.0}) {
        CAPTURE(rate);
        Stage stage({.period = 1.0 / rate, .threads = 1});
        std::vector<Vec3> line;
        for (int i = 0; i <= 30; ++i) line.push_back({-0.02 + 0.04 / 30 * i, 0, 0});
        SoftBodyDef vessel{.name = "vessel",
                           .mesh = shapes::vessel(line, 1.2e-3, 0.6e-3, {8, 1}),
                           .material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4},
                           .rayleigh = {20.0, 0.0},
                           .gravity = false};
        vessel.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-0.0199, 1, 1}}},
                              {.box = geometry::Box{{0.0199, -1, -1}, {1, 1, 1}}}};
        const BodyId tissue = stage.add(vessel), clip = stage.add(clipBody());
        stage.step(1.0 / rate);
        stage.post(ApplyClip{AttachmentId{++stage.lastAttachment}, clip, tissue, {}});
        stage.run(static_cast<int>(1.5 * rate), 1.0 / rate);
        double fastest = 0.0;
        for (const Vec3 v : stage.soft().v) fastest = std::max(fastest, length(v));
        CHECK(fastest < 1e-3);
    }
}

} // namespace clips_rest_test

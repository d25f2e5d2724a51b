#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

#include <algorithm>

namespace slippery_test {

using namespace filasofia;
using namespace filasofia::engine;

// Tissue without friction: nothing but its own damping stops what its contacts drive.
namespace {

/// [m/s] The highest speed of a node in a fifth of a second, 1.5 s after a ball has been pressed into a block.
double speedUnderBall(double young, double damping, double rate)
{
    Stage stage;
    stage.add(physics::SoftBodyDef{.mesh = geometry::shapes::block({0.044, 0.02, 0.046}, {11, 5, 12}),
                                   .material = physics::FemMaterial{.youngModulus = young, .poissonRatio = 0.45},
                                   .rayleigh = {.stiffness = damping},
                                   .gravity = false,
                                   .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0099, 1}}}},
                                   .collision = {{}},
                                   .friction = 0.0});
    const BodyId ball = stage.add(physics::RigidBodyDef{.elements = {{{0, 0.0205, 0}, {}}},
                                                        .mesh = geometry::shapes::sphere(0.01, 12),
                                                        .collision = {{}},
                                                        .friction = 0.0});
    double fastest = 0.0;
    const int down = static_cast<int>(0.5 * rate), all = static_cast<int>(2.2 * rate);
    for (int i = 1; i <= all; ++i) {
        const double y = 0.0205 - 0.0105 * std::min(1.0, static_cast<double>(i) / down);
        stage.post(physics::SetPose{ball, 0, {{0.0007, y, 0.0003}, {}}});
        stage.step(1.0 / rate);
        if (i > 2.0 * rate)
            for (const Vec3 v : stage.soft().v) fastest = std::max(fastest, length(v));
    }
    return fastest;
}

} // namespace

TEST_CASE("a ball pressed into tissue without friction comes to rest, whatever the stiffness, the damping and the rate")
{
    struct Case {
        double young, damping, rate;
    };
    for (const auto& [young, damping, rate] : {Case{20e3, 0.01, 100.0},
                                               {20e3, 0.01, 250.0},
                                               {5e3, 0.01, 500.0},
                                               {200e3, 0.01, 500.0},
                                               {20e3, 0.001, 1000.0}}) {
        CAPTURE(young, damping, rate);
        CHECK(speedUnderBall(young, damping, rate) < 1e-3);
    }
}

} // namespace slippery_test

#pragma once

#include "filasofia/core/units.h"
#include "filasofia/geometry/knot_determinant.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/simulation.h"
#include "filasofia/testing/linking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace filasofia::prefab {

/// Two bars, and a thread below both whose ends stand up. Hands tie it above them; then the bars are drawn apart.
class TiedBars {
public:
    /// The ends of the thread are at first here [m]. If it is not straight at rest it is as it lies.
    TiedBars(double friction, const std::array<Vec3, 2>& ends, bool straight = true,
             const runtime::SimulationDef& simulation = {})
        : sim(simulation)
    {
        for (const int i : {0, 1}) {
            physics::RigidBodyDef bar{.name = i == 0 ? "left bar" : "right bar", .elements = {poseOf(i)}};
            bar.mesh = geometry::shapes::cylinder(2_mm, 40_mm, 64);
            bar.collision = {{.proximity = 0.1_mm}};
            bar.friction = 0.05;
            bars[static_cast<std::size_t>(i)] = sim.add(bar);
        }
        physics::RodBodyDef def{.name = "thread", .spacing = 0.4_mm, .radius = 0.15_mm, .youngModulus = 50_MPa};
        def.points = {ends[0],
                      {-6.4_mm, -2_mm, 0},
                      {-5.8_mm, -3.8_mm, 0},
                      {-4_mm, -4.5_mm, 0},
                      {4_mm, -4.5_mm, 0},
                      {5.8_mm, -3.8_mm, 0},
                      {6.4_mm, -2_mm, 0},
                      ends[1]};
        def.attachments = {{.ball = physics::Ball{kLowest, 0.3_mm}}};
        def.straight = straight;
        def.gravity = false;
        def.yieldStrain = 0.1;
        def.rayleigh.mass = 20.0; // the air
        def.friction = friction;
        def.collision = physics::RodCollision{};
        thread = sim.add(def);
    }
    /// Ties with these hands, lets go, and draws the bars apart, as fast as 20 mm/s and with so much force [N] each,
    /// for 0.5 s. `watch` sees each frame.
    template <class Hands, class Watch> void tieAndLoad(Hands& knot, double load, int steps, Watch watch)
    {
        prepare(knot, load, watch);
        sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
        throws = knot.tied();
        hardest = knot.largestForce();
    }
    template <class Hands, class Watch> void prepare(Hands& knot, double load, Watch watch)
    {
        sim.everyStep([this, &knot, load, watch, tied = 1e9](double time) mutable {
            const auto frame = sim.physics().latest();
            if (!frame) return;
            if (time > 0.01) knot.begin();
            count(*frame);
            watch(*frame);
            if (knot.tied() > std::ssize(windings)) {
                windings.push_back(winding());
                determinants.push_back(geometry::knotDeterminantOpen(before_, {1, 0, 0}, {0, 1, 0}));
            }
            if (knot.done()) tied = std::min(tied, time);
            if (time > tied + 0.1) knot.release();
            if (time > tied + 0.15) pull(*frame, load);
            if (time > tied + 0.65) loaded.push_back(distance(place_[0], place_[1]));
            if (time > tied + 0.75) sim.finish("loaded");
        });
    }

    runtime::Simulation sim;
    BodyId thread = {};
    std::array<BodyId, 2> bars = {};
    int throws = 0, passes = 0;
    double hardest = 0.0;
    std::vector<double> windings;  ///< [-] how often the strands wind around each other, after each throw
    std::vector<int> determinants; ///< [-] what knot the thread forms, after each throw
    std::vector<double> loaded;    ///< [m] between the bars under load, from step to step
    double force = 0.0;            ///< [N] on the left bar, in the last step

private:
    static constexpr Vec3 kLowest{0, -4.5_mm, 0}; ///< [m], where the thread is held below both bars
    Pose poseOf(int bar) const { return {place_[static_cast<std::size_t>(bar)], axisAngle({1, 0, 0}, 90_deg)}; }
    void count(const frame::Frame& frame)
    {
        const std::vector<Vec3>& now = frame.softBody(thread)->positions;
        if (!before_.empty()) passes += std::abs(passes_.count({before_, now}, {before_, now}));
        before_ = now;
    }
    [[nodiscard]] double winding() const
    {
        double sum = 0.0;
        const auto lowest = std::ranges::min_element(before_, {}, [](Vec3 x) { return distance(x, kLowest); });
        const auto middle = static_cast<std::size_t>(lowest - before_.begin());
        for (std::size_t i = 1; i < middle; ++i)
            for (std::size_t k = middle + 1; k < before_.size(); ++k)
                sum += testing::gaussIntegral(before_[i - 1], before_[i], before_[k - 1], before_[k]);
        return sum / (4.0 * std::numbers::pi);
    }
    void pull(const frame::Frame& frame, double load)
    {
        for (const int i : {0, 1}) {
            const BodyId bar = bars[static_cast<std::size_t>(i)];
            double across = 0.0;
            for (const frame::Contact& each : frame.contacts)
                if (each.first == bar || each.second == bar) across += std::abs(each.normal.x) * each.normalForce;
            if (i == 0) force = across;
            place_[static_cast<std::size_t>(i)].x +=
                (i == 0 ? -1.0 : 1.0) * std::clamp((load - across) / 3000.0, -2e-5, 2e-5);
            sim.physics().setPose(bar, poseOf(i));
        }
    }

    std::array<Vec3, 2> place_ = {Vec3{-4_mm, -2_mm, 0}, Vec3{4_mm, -2_mm, 0}};
    std::vector<Vec3> before_;
    testing::PassCounter passes_;
};

} // namespace filasofia::prefab

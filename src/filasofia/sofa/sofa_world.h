#pragma once

#include "filasofia/sofa/graph_owner.h"
#include "filasofia/sofa/scene_state.h"
#include "filasofia/sofa/sofa_engine.h"
#include "filasofia/sofa/step_flags.h"

namespace filasofia::sofaengine {

/// The engine: a root node, and a node per body below it.
class SofaWorld final : public physics::PhysicsEngine, public GraphOwner {
public:
    explicit SofaWorld(const SofaEngineDef& def);
    ~SofaWorld() override;
    SofaWorld(const SofaWorld&) = delete;
    SofaWorld& operator=(const SofaWorld&) = delete;

    [[nodiscard]] physics::EngineInfo info() const override;
    [[nodiscard]] std::unique_ptr<physics::BuiltBody> build(const physics::BodyDef& def) const override;
    void check(const physics::Command& command, const physics::BodyDef* def) const override;
    physics::StepReport step(const physics::StepInput& in) override;
    void capture(frame::Frame& out) const override;
    void record(physics::StepRecord& out) const override;
    [[nodiscard]] std::uint64_t hash() const override;
    [[nodiscard]] std::shared_ptr<const physics::EngineState> save() const override;
    void restore(const physics::EngineState& state) override;

    [[nodiscard]] ::sofa::simulation::Node& root() const override { return *scene_.root; }
    [[nodiscard]] ::sofa::simulation::Node* nodeOf(BodyId id) const override;

private:
    using Now = std::function<std::int64_t()>; ///< [ns]
    void advance(double dt, const Now& now, physics::StepReport& report);
    void move(double dt); ///< throws what SOFA throws
    /// Returns bodies to where they were, at rest: all after a step that failed, else those whose numbers are none.
    void putBack(bool failed, const SceneMotion& before, physics::StepReport& report);
    void readConstraints(bool failed, double dt, physics::StepReport& report);

    SofaScene scene_;
    std::vector<physics::Intersection> intersections_; ///< the last answer
    bool looksAgain_ = true;                           ///< for intersections, in the next step
    SceneWatch watch_;                                 ///< for bodies that never rest
    double time_ = 0.0;                                ///< [s]
    std::uint64_t steps_ = 0;
};

} // namespace filasofia::sofaengine

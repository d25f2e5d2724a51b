#pragma once

#include "filasofia/core/background.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/engine/topology/ruptures.h"
#include "filasofia/engine/step/stages.h"

namespace filasofia::engine {

/// The native engine: model, state, and the one function that makes a step of them.
class World final : public physics::PhysicsEngine {
public:
    explicit World(const NativeEngineDef& def = {});
    [[nodiscard]] std::unique_ptr<physics::BuiltBody> build(const physics::BodyDef& def) const override;
    physics::StepReport step(const physics::StepInput& in) override;
    void capture(frame::Frame& out) const override;
    void record(physics::StepRecord& out) const override;
    [[nodiscard]] std::uint64_t hash() const override;

    [[nodiscard]] Model& model() { return model_; }
    [[nodiscard]] State& state() { return state_; }

private:
    double period_;
    physics::ContactMethod contact_;
    std::unique_ptr<WorkerPool> pool_;
    std::unique_ptr<BackgroundThread> background_; ///< for what a step needs not, but a later one
    Model model_;
    State state_;
    Systems systems_;
    Ruptures ruptures_;
    Coupling coupling_; ///< of the step being made, and memory that is kept
};

} // namespace filasofia::engine

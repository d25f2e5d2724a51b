#pragma once

#include "filasofia/core/background.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/engine/topology/ruptures.h"

namespace filasofia::engine {

/// The native engine: a scene, and the one function that makes a step of it.
class World final : public physics::PhysicsEngine {
public:
    explicit World(const NativeEngineDef& def = {});
    [[nodiscard]] std::unique_ptr<physics::BuiltBody> build(const physics::BodyDef& def) const override;
    physics::StepReport step(const physics::StepInput& in) override;
    void capture(frame::Frame& out) const override;
    void record(physics::StepRecord& out) const override;
    [[nodiscard]] std::uint64_t hash() const override;

    [[nodiscard]] Scene& scene() { return scene_; }

private:
    double period_;
    physics::ContactMethod contact_;
    std::unique_ptr<WorkerPool> pool_;
    std::unique_ptr<BackgroundThread> background_; ///< for what a later step needs, and this one does not
    Scene scene_;
    std::vector<Blade> blades_; ///< cutting collision models, from step to step
    Coupling coupling_;         ///< of the step being made, and memory that is kept
};

} // namespace filasofia::engine

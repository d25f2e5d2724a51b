#pragma once

#include "filasofia/core/background.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/engine/scene/rest_watch.h"
#include "filasofia/engine/topology/ruptures.h"

namespace filasofia::engine {

/// The native engine: a scene, and step(), which advances it.
class World final : public physics::PhysicsEngine {
public:
    explicit World(const NativeEngineDef& def = {});
    [[nodiscard]] physics::EngineInfo info() const override;
    [[nodiscard]] std::unique_ptr<physics::BuiltBody> build(const physics::BodyDef& def) const override;
    physics::StepReport step(const physics::StepInput& in) override;
    void capture(frame::Frame& out) const override;
    void record(physics::StepRecord& out) const override;
    [[nodiscard]] std::uint64_t hash() const override;
    [[nodiscard]] physics::MechanicalEnergy energyOf(BodyId body) const override;
    [[nodiscard]] std::shared_ptr<const physics::EngineState> save() const override;
    void restore(const physics::EngineState& state) override;

    [[nodiscard]] Scene& scene() { return scene_; }

private:
    double period_;
    physics::ContactMethod contact_;
    std::unique_ptr<WorkerPool> pool_;
    std::unique_ptr<BackgroundThread> background_; ///< for work that only a later step needs
    Scene scene_;
    std::vector<Blade> blades_; ///< cutting collision models, kept from step to step
    RestWatch rest_;
    Coupling coupling_; ///< constraints of the current step, and scratch memory that is reused
};

} // namespace filasofia::engine

#pragma once

#include "filasofia/sofa/graph_owner.h"
#include "filasofia/sofa/item_view.h"
#include "filasofia/sofa/loaded_graph.h"

#include "filasofia/physics/physics_engine.h"

namespace filasofia::sofaengine {

/// The engine of a loaded scene: SOFA moves everything, and bodies are how its objects are seen.
class LoadedWorld final : public physics::PhysicsEngine, public GraphOwner {
public:
    /// `def`: where the scene comes from. If it has cut its meshes, a reset loads it again.
    LoadedWorld(::sofa::simulation::Node::SPtr root, std::vector<LoadedItem> items, LoadDef def);
    ~LoadedWorld() override;
    LoadedWorld(const LoadedWorld&) = delete;
    LoadedWorld& operator=(const LoadedWorld&) = delete;

    [[nodiscard]] physics::EngineInfo info() const override;
    [[nodiscard]] std::unique_ptr<physics::BuiltBody> build(const physics::BodyDef& def) const override;
    void check(const physics::Command& command, const physics::BodyDef* def) const override;
    physics::StepReport step(const physics::StepInput& in) override;
    void capture(frame::Frame& out) const override;
    void record(physics::StepRecord& out) const override;
    [[nodiscard]] std::uint64_t hash() const override;
    [[nodiscard]] std::shared_ptr<const physics::EngineState> save() const override;
    void restore(const physics::EngineState& state) override;

    [[nodiscard]] ::sofa::simulation::Node& root() const override { return *graph_.root; }
    [[nodiscard]] ::sofa::simulation::Node* nodeOf(BodyId id) const override;

private:
    struct Seen {
        BodyId id = {};
        std::size_t item = 0;
    };
    /// A graph and how its objects are seen.
    struct Graph {
        ::sofa::simulation::Node::SPtr root = {};
        std::vector<ItemView> views = {};
        Graph() = default;
        ~Graph();
        Graph(Graph&& other) noexcept { *this = std::move(other); }
        Graph& operator=(Graph&& other) noexcept;
    };
    void apply(physics::Command& command, physics::StepReport& report);
    void advance(double dt, physics::StepReport& report);
    void reset();
    void look(); ///< reads what frames show
    [[nodiscard]] Graph loadAgain() const;
    [[nodiscard]] bool isCut() const;

    Graph graph_;
    LoadDef def_;
    std::vector<Seen> seen_; ///< the bodies that were added, in the order of ids
    double time_ = 0.0;      ///< [s]
    std::uint64_t steps_ = 0;
};

} // namespace filasofia::sofaengine

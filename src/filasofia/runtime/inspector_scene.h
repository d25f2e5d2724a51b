#pragma once

#include "filasofia/runtime/simulation_impl.h"
#include "filasofia/visual/debug_draw.h"

#include <map>
#include <memory>

namespace filasofia::runtime {

/// What the inspector draws into the scene.
struct InspectorShow {
    bool wireframe = false;       ///< edges of what is drawn
    bool collision = false;       ///< edges of collision models
    bool contacts = false;        ///< where surfaces are near each other
    bool forces = false;          ///< arrows of what contacts do to a body that moves, the first of two
    double metresPerNewton = 0.0; ///< [m/N], of the arrows; 0: such that the largest is seen well
};

/// Draws it, from what can be seen from outside: visual bodies, Frames, Defs.
class InspectorScene {
public:
    explicit InspectorScene(Simulation::Impl& impl) : impl_(impl) {}

    void draw(const InspectorShow& show, visual::VisualServer& visual);
    /// [m/N]: what is asked for, or the round number found for the last forces.
    [[nodiscard]] double scaleOf(const InspectorShow& show) const;

private:
    using Edges = std::vector<std::array<int, 2>>;
    struct Wires {
        std::vector<geometry::Triangle> triangles; ///< that the edges are of
        Edges edges;
    };
    /// One collision model of a body.
    struct Model {
        int element = 0; ///< of a rigid body
        mapping::MappedSurface surface;
        Edges edges;
    };

    static Edges edgesOf(std::span<const geometry::Triangle> triangles);
    void drawWireframe(visual::VisualServer& visual);
    void drawModels(const frame::Frame& frame, visual::DebugDraw& debug);
    const std::vector<Model>& modelsOf(BodyId id);
    /// Chooses a scale anew where the largest arrow has grown out of the scene or can hardly be seen.
    void fitScale(const frame::Frame& frame);
    static void drawContacts(const frame::Frame& frame, visual::DebugDraw& debug);
    void drawForces(const frame::Frame& frame, double metresPerNewton, visual::DebugDraw& debug) const;
    /// It goes where it is told, whatever pushes it.
    [[nodiscard]] bool isLed(BodyId id) const;

    Simulation::Impl& impl_;
    std::map<const visual::VisualBody*, Wires> wires_;
    std::map<BodyId, std::vector<Model>> models_;
    std::vector<Vec3> vertices_;
    double fitted_ = 0.02; ///< [m/N]
};

} // namespace filasofia::runtime

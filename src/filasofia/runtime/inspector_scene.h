#pragma once

#include "filasofia/runtime/simulation_impl.h"
#include "filasofia/visual/debug_draw.h"

#include <map>
#include <memory>

namespace filasofia::runtime {

/// What the inspector draws into the scene.
struct InspectorShow {
    bool wireframe = false; ///< edges of the drawn surfaces
    bool collision = false; ///< edges of collision models
    bool contacts = false;  ///< points where surfaces are near each other
    /// arrows of the contact forces on the first of two bodies, or on the second if the first is kinematic
    bool forces = false;
    double metresPerNewton = 0.0; ///< [m/N], length of the arrows; 0: chosen so that the largest is easily seen
};

/// Draws what InspectorShow asks for. It reads public data only: visual bodies, Frames, Defs.
class InspectorScene {
public:
    explicit InspectorScene(Simulation::Impl& impl) : impl_(impl) {}

    void draw(const InspectorShow& show, visual::VisualServer& visual);
    /// [m/N], the scale that is asked for, or the round number chosen for the last forces.
    [[nodiscard]] double scaleOf(const InspectorShow& show) const;

private:
    using Edges = std::vector<std::array<int, 2>>;
    struct Wires {
        std::vector<geometry::Triangle> triangles; ///< the edges belong to these
        Edges edges;
    };
    /// One collision model of a body.
    struct Model {
        int element = 0; ///< index in a rigid body
        mapping::MappedSurface surface;
        Edges edges;
    };

    static Edges edgesOf(std::span<const geometry::Triangle> triangles);
    void drawWireframe(visual::VisualServer& visual);
    void drawModels(const frame::Frame& frame, visual::DebugDraw& debug);
    const std::vector<Model>& modelsOf(BodyId id);
    /// Chooses a new scale if the largest arrow has grown out of the scene or can hardly be seen.
    void fitScale(const frame::Frame& frame);
    static void drawContacts(const frame::Frame& frame, visual::DebugDraw& debug);
    void drawForces(const frame::Frame& frame, double metresPerNewton, visual::DebugDraw& debug) const;
    /// Whether the body is kinematic: its motion is prescribed, whatever pushes it.
    [[nodiscard]] bool isKinematic(BodyId id) const;

    Simulation::Impl& impl_;
    std::map<const visual::VisualBody*, Wires> wires_;
    std::map<BodyId, std::vector<Model>> models_;
    std::vector<Vec3> vertices_;
    double fitted_ = 0.02; ///< [m/N]
};

} // namespace filasofia::runtime

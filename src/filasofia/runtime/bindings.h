#pragma once

#include "filasofia/runtime/followers.h"
#include "filasofia/runtime/mesh_worker.h"
#include "filasofia/runtime/painted_surfaces.h"

#include "filasofia/geometry/box.h"

#include <set>

namespace filasofia::visual {
class VisualBody;
class VisualServer;
} // namespace filasofia::visual

namespace filasofia::runtime {

/// How the names of materials begin that Bindings puts into the visual server's pool.
inline constexpr std::string_view kInteriorOf = "interior of ";

/// What is drawn of which body: the one place where the two servers meet. Frames come in, vertices go out.
class Bindings {
public:
    explicit Bindings(MeshWorker::Prepare prepare = prepareMesh) : worker_(std::move(prepare)) {}

    /// Prepares a surface on the caller's thread; it appears at the next update(). Any thread. Throws Error.
    ShownId show(BodyId id, const ShowDef& def, const physics::PhysicsServer& physics);

    // Any thread; they take effect at the next update(). An Error where the id was never given; nothing happens where
    // what it names is gone.
    void setVisible(ShownId id, bool visible);
    void setMaterial(ShownId id, const visual::Material& material);
    void remove(ShownId id);
    /// A mark on what is drawn of a body; how many vertices it reached. Any thread.
    int paint(BodyId id, const PaintDef& def, physics::PhysicsServer& physics);
    /// Everything is clean again. Any thread.
    void clearPaint() { painted_.clear(); }
    /// The body's boundary has new triangles: `surface` at rest in the world, on its nodes, which only grow in number.
    /// What is drawn of the boundary follows with its old triangles until the new ones are ready. `interior`: what cuts
    /// have opened of it, drawn in a material of its own; none: nothing. Other surfaces of its skin are opened as
    /// `boundary` tells, and stay without one. Any thread.
    void retopologise(BodyId id, SharedSurface surface, SharedSurface interior = nullptr,
                      std::shared_ptr<const frame::Boundary> boundary = nullptr);

    /// Makes visual bodies of what was prepared. Main thread, like all that follows. Where the visual server refuses
    /// one, its Error comes through, and that one and those after it stay pending.
    void addPending(visual::VisualServer& visual);
    /// Moves everything to where the frame says; removes what belongs to a body that is gone.
    void update(const frame::Frame& frame, const physics::PhysicsServer& physics, visual::VisualServer& visual);
    /// Waits for the new triangles that are under way, those of the cuts in `newest` too: the next update() has them
    /// all.
    void finishMeshes(const frame::Frame* newest = nullptr);
    /// A Transform of the visual server goes where a body goes, from now until unfollow(), its own end, the body's, or
    /// until it gets a parent. Throws an Error where there is no visual server or the transform is not of it.
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def, const physics::PhysicsServer& physics);
    void unfollow(const visual::Transform& transform) { followers_.unfollow(transform); }
    /// Forgets the visual bodies, because their server ends; they are pending again.
    void release();

    /// The box around all surfaces where they are at the start; empty without any.
    [[nodiscard]] geometry::Box bounds() const;
    /// The box around what is drawn and visible, where it is now.
    [[nodiscard]] geometry::Box boundsNow() const;
    /// The visual server, while there is one.
    [[nodiscard]] visual::VisualServer* visual() const { return visual_; }

private:
    struct Binding {
        SurfaceKey key = 0;
        ShownId shown = {};
        BodyId id = {};
        bool soft = true;
        std::string name = {};
        SharedSurface mapped = {}; ///< of a rigid body: without a map
        int nodes = 0;             ///< that a frame of the body must have for it
        mapping::RigidMap rigidMap = {};
        Pose start = {}; ///< of the surface's coordinates, for a rigid body
        ShowDef def = {};
        int subdivision = 0;   ///< that is drawn: less than in def where a cut surface takes none
        bool boundary = false; ///< drawn is a soft body's own boundary
        bool interior = false; ///< of that, what was opened
        std::shared_ptr<const mapping::OpeningSurface> opening = {}; ///< drawn is another surface of its skin
        bool seen = false;                                           ///< the body has been in a frame
        visual::VisualBody* drawn = nullptr;                         ///< nullptr while pending
    };
    /// What was asked for and has not been done. The newest of each kind is enough.
    struct Wish {
        std::optional<bool> visible = {};
        std::optional<visual::Material> material = {};
        bool gone = false;
    };

    Wish& wish(ShownId id, const char* what);
    void applyWishes(visual::VisualServer& visual);
    [[nodiscard]] bool isCut(BodyId id) const;
    void followTopology(const frame::Frame& frame);
    void applyTopology();
    void openInteriors();
    void askMesh(const Binding& binding); ///< the newest triangles of its body, where it has new ones
    bool healed(const Binding& binding);  ///< what was open is closed again
    bool place(Binding& binding, const frame::Frame& frame);
    void forget(const Binding& binding);
    static void apply(const Wish& wish, Binding& binding, const visual::VisualServer& visual);

    mutable std::mutex mutex_; ///< guards these
    std::vector<Binding> pending_;
    std::map<ShownId, Wish> wishes_;
    struct Topology {
        SharedSurface skin, interior; ///< none: nothing is open
        std::shared_ptr<const frame::Boundary> boundary = {};
    };
    std::map<BodyId, Topology> topology_; ///< the newest boundary of each body whose topology has changed
    std::set<BodyId> changed_;            ///< those that the worker has not been told of
    std::uint32_t lastShown_ = 0;
    SurfaceKey lastKey_ = 0;

    std::map<BodyId, std::shared_ptr<const frame::Boundary>> boundaries_; ///< that the last frame had

    std::vector<Binding> shown_; // the main thread's, like these
    std::vector<Vec3> vertices_;
    Followers followers_;
    visual::VisualServer* visual_ = nullptr;

    PaintedSurfaces painted_;
    MeshWorker worker_;
};

/// While it lives there may be visual bodies; when it ends, also by an exception, none is remembered.
class DrawnBindings {
public:
    explicit DrawnBindings(Bindings& bindings) : bindings_(bindings) {}
    ~DrawnBindings() { bindings_.release(); }
    DrawnBindings(const DrawnBindings&) = delete;
    DrawnBindings& operator=(const DrawnBindings&) = delete;

private:
    Bindings& bindings_;
};

} // namespace filasofia::runtime

#pragma once

#include "filasofia/runtime/film_marks.h"
#include "filasofia/runtime/followers.h"
#include "filasofia/runtime/mesh_worker.h"
#include "filasofia/runtime/painted_surfaces.h"

#include "filasofia/geometry/box.h"
#include "filasofia/mapping/printed_sheet.h"

#include <set>
#include <vector>

namespace filasofia::visual {
class VisualBody;
class VisualServer;
} // namespace filasofia::visual

namespace filasofia::runtime {

/// Prefix of the names of materials that Bindings adds to the visual server's pool.
inline constexpr std::string_view kInteriorOf = "interior of ";

/// Which body is drawn how: the one place that knows both servers. It reads frames and moves vertices.
class Bindings {
public:
    explicit Bindings(MeshWorker::Prepare prepare = prepareMesh) : worker_(std::move(prepare)) {}

    /// Prepares a surface on the caller's thread; it appears at the next update(). Any thread. Throws Error.
    ShownId show(BodyId id, const ShowDef& def, const physics::PhysicsServer& physics);

    // Any thread; they take effect at the next update(). Error if the id was never given; nothing happens if what it
    // names is gone.
    void setVisible(ShownId id, bool visible);
    void setMaterial(ShownId id, const visual::Material& material);
    void remove(ShownId id);
    /// Paints everything that is drawn of a body. Returns how many vertices it reached. Any thread.
    int paint(BodyId id, const PaintDef& def, physics::PhysicsServer& physics);
    /// Removes all paint. Any thread.
    void clearPaint() { painted_.clear(); }
    /// What lies on these bodies from now on, in addition to paint; drawn at the next update(). Main thread.
    void setFilms(const std::map<BodyId, NodeFilm>& blood, const std::map<BodyId, NodeFilm>& burns);
    /// Gives the body's boundary new triangles: `surface` at rest in the world, on the body's nodes, whose number only
    /// grows. The drawn boundary follows with its old triangles until the new ones are ready. `interior` is what cuts
    /// have opened, drawn in a material of its own; null if nothing is open. Other surfaces of the skin open as
    /// `boundary` says; if it is null they stay closed. Any thread.
    void retopologise(BodyId id, SharedSurface surface, SharedSurface interior = nullptr,
                      std::shared_ptr<const frame::Boundary> boundary = nullptr);

    /// Forgets pending visuals of bodies that have been removed since: they would be drawn once, and they count towards
    /// the most bodies that a visual server holds. Main thread.
    void forgetRemoved(const physics::PhysicsServer& physics);
    /// Makes visual bodies of what was prepared. Main thread, like everything below. If the visual server refuses one,
    /// its Error is passed on, and that one and those after it stay pending.
    void addPending(visual::VisualServer& visual);
    /// Moves everything to the places given by the frame, and removes what belongs to a removed body.
    void update(const frame::Frame& frame, const physics::PhysicsServer& physics, visual::VisualServer& visual);
    /// Waits for the new triangles that are under way, including those of the cuts in `newest`. The next update() then
    /// has them all.
    void finishMeshes(const frame::Frame* newest = nullptr);
    /// Makes a Transform of the visual server follow a body until unfollow(), its own end, the body's end, or until it
    /// gets a parent. Throws an Error if there is no visual server or the transform does not belong to it.
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def, const physics::PhysicsServer& physics);
    void unfollow(const visual::Transform& transform) { followers_.unfollow(transform); }
    /// Forgets the visual bodies because their server ends; they are pending again.
    void release();

    /// The vertices of all surfaces in their start poses [m], and the box around them; empty if there are none.
    [[nodiscard]] std::vector<Vec3> points() const;
    [[nodiscard]] geometry::Box bounds() const { return geometry::boxAround(points()); }
    /// The same of everything that is drawn and visible, where it is now.
    [[nodiscard]] std::vector<Vec3> pointsNow() const;
    [[nodiscard]] geometry::Box boundsNow() const { return geometry::boxAround(pointsNow()); }
    /// The visual server, while there is one.
    [[nodiscard]] visual::VisualServer* visual() const { return visual_; }

private:
    struct Binding {
        SurfaceKey key = 0;
        ShownId shown = {};
        BodyId id = {};
        bool soft = true;
        std::string name = {};
        SharedSurface mapped = {}; ///< a rigid body's has no map
        int nodes = 0;             ///< number of nodes that a frame of the body must have
        mapping::RigidMap rigidMap = {};
        Pose start = {};       ///< start pose of the surface's coordinates, for a rigid body
        ShowDef def = {};      ///< with its material
        int subdivision = 0;   ///< the level that is drawn; less than in def if a cut surface cannot be subdivided
        bool boundary = false; ///< a soft body's own boundary is drawn
        bool interior = false; ///< the opened inside of that boundary is drawn
        std::shared_ptr<const mapping::OpeningSurface> opening = {}; ///< another surface of the body's skin is drawn
        NodeMarks marks = {};                                        ///< those that are drawn
        bool seen = false;                                           ///< the body has been in a frame
        AttachmentId strandsOf = {}; ///< its strands are drawn, and `mapped` is only what there is before the first
        int strands = 0;             ///< as many have triangles now
        visual::VisualBody* drawn = nullptr; ///< nullptr while pending
    };
    /// Changes that were asked for and not yet made. The newest of each kind is enough.
    struct PendingChange {
        std::optional<bool> visible = {};
        std::optional<visual::Material> material = {};
        bool gone = false;
    };

    PendingChange& change(ShownId id, const char* what);
    void applyChanges(visual::VisualServer& visual);
    [[nodiscard]] bool isCut(BodyId id) const;
    void followTopology(const frame::Frame& frame);
    void applyTopology();
    void openInteriors();
    void askMesh(const Binding& binding);     ///< asks for the newest triangles of its body, if it has new ones
    bool closedAgain(const Binding& binding); ///< the opened inside is closed again
    bool place(Binding& binding, const frame::Frame& frame);
    void placeStrands(Binding& binding, const frame::Frame& frame);
    void drawMarks(Binding& binding);             ///< paint and film, if one of them has changed
    static void drawSeam(const Binding& binding); ///< the rim of its cuts, which its triangles have
    void forget(const Binding& binding);
    static void apply(const PendingChange& change, Binding& binding, const visual::VisualServer& visual);

    mutable std::mutex mutex_; ///< guards the members up to boundaries_
    std::vector<Binding> pending_;
    std::map<ShownId, PendingChange> changes_;
    struct Topology {
        SharedSurface skin, interior; ///< null: nothing is open
        std::shared_ptr<const frame::Boundary> boundary = {};
    };
    std::map<BodyId, Topology> topology_;             ///< the newest boundary of each body whose topology has changed
    std::map<BodyId, mapping::PrintedSheet> printed_; ///< shells with texture coordinates that may be cut
    std::set<BodyId> changed_;                        ///< bodies whose new triangles the worker was not yet asked for
    std::uint32_t lastShown_ = 0;
    SurfaceKey lastKey_ = 0;

    std::map<BodyId, std::shared_ptr<const frame::Boundary>> boundaries_; ///< the boundaries of the last frame

    std::vector<Binding> shown_; // main thread only, like the members below
    std::vector<Vec3> vertices_;
    std::map<BodyId, NodeMarks> marks_; ///< the newest
    Followers followers_;
    visual::VisualServer* visual_ = nullptr;

    PaintedSurfaces painted_;
    MeshWorker worker_;
};

/// While it lives there may be visual bodies; when it ends, also by an exception, all are forgotten.
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

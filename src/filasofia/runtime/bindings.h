#pragma once

#include "filasofia/runtime/show.h"

#include "filasofia/frame/frame.h"
#include "filasofia/geometry/box.h"
#include "filasofia/mapping/map.h"

#include <mutex>
#include <vector>

namespace filasofia::physics {
class PhysicsServer;
}
namespace filasofia::visual {
class VisualBody;
class VisualServer;
} // namespace filasofia::visual

namespace filasofia::runtime {

/// What is drawn of which body: the one place where the two servers meet. Frames come in, vertices go out.
class Bindings {
public:
    /// Prepares a surface on the caller's thread; it appears at the next update(). Any thread. Throws Error.
    void show(BodyId id, const ShowDef& def, const physics::PhysicsServer& physics);

    /// Makes visual bodies of what was prepared. Main thread, like all that follows. Where the visual server refuses
    /// one, its Error comes through, and that one and those after it stay pending.
    void addPending(visual::VisualServer& visual);
    /// Moves everything to where the frame says; removes what belongs to a body that is gone.
    void update(const frame::Frame& frame, const physics::PhysicsServer& physics, visual::VisualServer& visual);
    /// Forgets the visual bodies, because their server ends; they are pending again.
    void release();

    /// The box around all surfaces where they are at the start; empty without any.
    [[nodiscard]] geometry::Box bounds() const;

private:
    struct Binding {
        BodyId id = {};
        bool soft = true;
        std::string name = {};
        geometry::TriangleMesh surface = {};
        mapping::SoftMap softMap = {};
        mapping::RigidMap rigidMap = {};
        Pose start = {}; ///< of the surface's coordinates, for a rigid body
        ShowDef def = {};
        bool seen = false;                   ///< the body has been in a frame
        visual::VisualBody* drawn = nullptr; ///< nullptr while pending
    };

    static bool place(Binding& binding, const frame::Frame& frame, std::vector<Vec3>& vertices);

    mutable std::mutex pendingMutex_;
    std::vector<Binding> pending_;
    std::vector<Binding> shown_;
    std::vector<Vec3> vertices_;
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

#include "filasofia/prefab/clip_applier.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <tuple>

namespace filasofia::prefab {
namespace {

/// Clips that wait are out of the way, where nobody looks, 2 cm from each other.
Vec3 waitingPlace(int clip) { return {2.0, -3.0, 2.0 + 0.02 * clip}; }

/// A U of wire, open towards -z, whose legs are `apart` [m] from each other.
std::shared_ptr<const geometry::TriangleMesh> wire(const physics::ClipDef& clip, double apart)
{
    const double half = 0.5 * clip.length, thick = 0.3 * clip.width, y = 0.5 * apart + thick;
    return geometry::shapes::tube({{0, y, -half},
                                   {0, y, half},
                                   {0, 0.6 * y, half + 0.5 * y},
                                   {0, -0.6 * y, half + 0.5 * y},
                                   {0, -y, half},
                                   {0, -y, -half}},
                                  thick, 8);
}

std::shared_ptr<const geometry::TriangleMesh> moved(const geometry::TriangleMesh& mesh, Vec3 by)
{
    geometry::TriangleMesh out = mesh;
    for (Vec3& each : out.vertices) each += by;
    return std::make_shared<const geometry::TriangleMesh>(std::move(out));
}

/// A clip waits, hanging in space by a point; its attachment there is the Def's only one.
physics::RigidBodyDef bodyOf(const ClipApplierDef& def, const std::string& tool, int clip)
{
    physics::RigidBodyDef body{.name = text("clip ", clip + 1, " of ", tool),
                               .elements = {{waitingPlace(clip), {}}},
                               .mesh = wire(def.clip, def.clip.gap),
                               .dynamic = true};
    body.mass = physics::TotalMass{1e-4}; // 0.1 g: a clip of titanium
    body.angularDamping = body.linearDamping = 5.0;
    body.attachments = {{.points = {Vec3{}}}};
    return body;
}

} // namespace

struct ClipApplier::Impl {
    Impl(runtime::Simulation& sim, const ArticulatedInstrument& instrument, const ClipApplierDef& asked)
        : simulation(sim), tool(instrument), def(asked)
    {
        const std::string name =
            std::visit([](const auto& each) { return each.name; }, *sim.physics().def(tool.body()));
        const std::string object = text("clip applier '", name, "'");
        validate(def, object);
        validate(def.clip, object + ": clip");
        if (!(def.clip.opening > def.clip.gap))
            fail(object, ": clip.opening must be > gap, ", def.clip.gap, " m, got ", def.clip.opening);
        if (def.clip.element != 0) fail(object, ": clip.element must be 0, got ", def.clip.element);
        if (def.targets.empty()) fail(object, ": targets must name at least one soft body, got none");
        for (const BodyId each : def.targets)
            if (const auto body = sim.physics().def(each); !std::holds_alternative<physics::SoftBodyDef>(*body))
                fail(object, ": targets must be soft bodies, got ", physics::describeBody(*body));
        for (int i = 0; i < def.clips; ++i) {
            clips.push_back(sim.add(bodyOf(def, name, i)));
            closed.push_back(sim.show(clips.back(), {.material = def.material, .visible = false}));
            waits.push_back(sim.physics().attachments(clips.back()).front());
        }
        holds.resize(clips.size());
        tell();
        const auto open = wire(def.clip, 0.8 * def.clip.opening);
        loaded =
            sim.show(tool.body(), {.surface = moved(*open, def.place), .material = def.material, .visible = false});
    }

    // Stepping thread, before each step.
    void watch()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        const frame::RigidBodyFrame* now = frame->rigidBody(tool.body());
        if (now == nullptr) return;
        turns.now([&] {
            const double opening = tool.opening();
            if (!ready && opening > std::min(0.95, def.closesAt + 0.2)) {
                ready = used < std::ssize(clips);
            } else if (ready && opening < def.closesAt) {
                ready = false;
                shut(*frame, now->poses.front());
            }
            if (ready != shownLoaded) simulation.setVisible(loaded, shownLoaded = ready);
            tell();
        });
    }

    /// The target with most nodes in the box between the legs; none if all are elsewhere.
    [[nodiscard]] BodyId between(const frame::Frame& frame, const Pose& clip) const
    {
        const Pose back = inverse(clip);
        BodyId best = {};
        int most = 0;
        for (const BodyId each : def.targets) {
            const frame::SoftBodyFrame* body = frame.softBody(each);
            if (body == nullptr) continue;
            int inside = 0;
            for (Vec3 node : body->positions) {
                const Vec3 p = transform(back, node);
                inside += std::abs(p.x) < 2.0 * def.clip.width && std::abs(2.0 * p.y) < def.clip.opening &&
                          std::abs(2.0 * p.z) < def.clip.length;
            }
            if (inside > most) most = inside, best = each;
        }
        return best;
    }

    void shut(const frame::Frame& frame, const Pose& pivot)
    {
        const auto index = static_cast<std::size_t>(used++);
        const Pose place{transform(pivot, def.place), pivot.orientation};
        physics::PhysicsServer& physics = simulation.physics();
        physics.release(waits[index]);
        physics.setPose(clips[index], place);
        simulation.setVisible(closed[index], true);
        const BodyId target = between(frame, place);
        if (target) holds[index] = physics.clip(clips[index], target, def.clip);
        ++(target ? applied : missed);
        if (def.onClip) def.onClip(target);
    }

    void reload()
    {
        physics::PhysicsServer& physics = simulation.physics();
        for (std::size_t i = 0; i < static_cast<std::size_t>(used); ++i) {
            if (holds[i]) physics.release(holds[i]);
            holds[i] = {};
            physics.setPose(clips[i], {waitingPlace(static_cast<int>(i)), {}});
            waits[i] = physics.attach(clips[i], physics::RigidAttachmentDef{.points = {Vec3{}}});
            simulation.setVisible(closed[i], false);
        }
        used = 0;
        applied = missed = 0;
        ready = false;
        tell();
    }
    void tell() { newest.write({static_cast<int>(clips.size()) - used, applied, missed}); }

    using Kept = std::tuple<int, int, int, bool, std::vector<AttachmentId>, std::vector<AttachmentId>>;
    auto kept() { return std::tie(used, applied, missed, ready, waits, holds); }
    void publish()
    {
        simulation.setVisible(loaded, shownLoaded = ready);
        for (std::size_t i = 0; i < clips.size(); ++i) simulation.setVisible(closed[i], static_cast<int>(i) < used);
        tell();
    }

    runtime::Simulation& simulation;
    const ArticulatedInstrument& tool;
    const ClipApplierDef def;
    Turns turns; // guards the members below
    std::vector<BodyId> clips;
    std::vector<runtime::ShownId> closed; ///< each clip as it is drawn once it is used
    runtime::ShownId loaded = {};         ///< the open clip in the jaws
    bool shownLoaded = false;
    std::vector<AttachmentId> waits; ///< by which those in the magazine hang in space
    std::vector<AttachmentId> holds; ///< by which used ones hang on tissue
    int used = 0, applied = 0, missed = 0;
    bool ready = false; ///< a clip is in the jaws
    struct Counts {
        int left = 0, applied = 0, missed = 0;
    };
    Published<Counts> newest; // for all threads
};

ClipApplier::ClipApplier(runtime::Simulation& simulation, const ArticulatedInstrument& tool, const ClipApplierDef& def)
    : impl_(std::make_shared<Impl>(simulation, tool, def))
{
    simulation.everyStep([weak = std::weak_ptr(impl_)](double) {
        if (const auto impl = weak.lock()) impl->watch();
    });
    remember(simulation, text("clips of body ", tool.body().value), impl_);
}
ClipApplier::~ClipApplier() = default;

int ClipApplier::left() const { return impl_->newest.read().left; }
int ClipApplier::applied() const { return impl_->newest.read().applied; }
int ClipApplier::missed() const { return impl_->newest.read().missed; }
std::vector<BodyId> ClipApplier::bodies() const { return impl_->clips; }
void ClipApplier::reload()
{
    impl_->turns.take(!impl_->simulation.physics().stepsHere(), [impl = impl_] { impl->reload(); });
}

} // namespace filasofia::prefab

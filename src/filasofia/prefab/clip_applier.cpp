#include "filasofia/prefab/clip_applier.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/check_clip.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

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
    Impl(runtime::Simulation& sim, const ArticulatedInstrument* instrument, BodyId toolBody,
         const ClipApplierDef& given)
        : simulation(sim), jaws(instrument), tool(toolBody), def(given)
    {
        const auto held = sim.physics().def(tool);
        const std::string name = std::visit([](const auto& each) { return each.name; }, *held);
        const std::string object = text("clip applier '", name, "'");
        if (!std::holds_alternative<physics::RigidBodyDef>(*held))
            fail(object, ": the tool must be a rigid body, got ", physics::describeBody(*held));
        validate(def, object);
        physics::check(def.clip, object + ": clip");
        if (def.clip.element != 0) fail(object, ": clip.element must be 0, got ", def.clip.element);
        if (def.targets.empty()) fail(object, ": targets must name at least one soft body, got none");
        for (const BodyId each : def.targets) {
            const auto body = sim.physics().def(each);
            const auto* soft = std::get_if<physics::SoftBodyDef>(body.get());
            if (!soft) fail(object, ": targets must be soft bodies, got ", physics::describeBody(*body));
            physics::checkClipped(*soft, text(object, ": targets: ", physics::describeBody(*body)));
        }
        for (int i = 0; i < def.clips; ++i) {
            clips.push_back(sim.add(bodyOf(def, name, i)));
            closed.push_back(sim.show(clips.back(), {.material = def.material, .visible = false}));
            waits.push_back(sim.physics().attachments(clips.back()).front());
        }
        holds.resize(clips.size());
        on.resize(clips.size());
        usedAt.resize(clips.size());
        tell();
        const auto open = wire(def.clip, 0.8 * def.clip.opening);
        loaded = sim.show(tool, {.surface = moved(*open, def.place), .material = def.material, .visible = false});
    }

    // Stepping thread, before each step.
    void watch()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        const frame::RigidBodyFrame* now = frame->rigidBody(tool);
        if (now == nullptr) return;
        turns.now([&] {
            if (wasReset(*frame)) reload();
            findOut(*frame);
            findSlipped(*frame);
            if (!jaws) ready = next() < std::ssize(clips);
            const double opening = jaws ? jaws->opening() : def.closesAt;
            if (!ready && opening > std::min(0.95, def.closesAt + 0.2)) {
                ready = next() < std::ssize(clips);
            } else if (ready && opening < def.closesAt) {
                ready = false;
                shut(*frame, now->poses.front());
            }
            if (ready != shownLoaded) simulation.setVisible(loaded, shownLoaded = ready);
            tell();
        });
    }

    /// The next clip in the magazine; a body that was removed is none.
    [[nodiscard]] int next() const
    {
        int clip = used;
        while (clip < std::ssize(clips) && !simulation.physics().has(clips[static_cast<std::size_t>(clip)])) ++clip;
        return clip;
    }

    /// A reset takes used clips to where they were at first; nothing else brings them there.
    [[nodiscard]] bool wasReset(const frame::Frame& frame) const
    {
        for (int i = 0; i < used; ++i) {
            const frame::RigidBodyFrame* body = frame.rigidBody(clips[static_cast<std::size_t>(i)]);
            if (body == nullptr || frame.step <= usedAt[static_cast<std::size_t>(i)]) continue;
            if (distance(body->poses.front().position, waitingPlace(i)) < 1e-3) return true;
        }
        return false;
    }

    /// For who has no jaws, or does not ask them.
    void closeNow()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) fail("clip applier: close() needs a step before it");
        const frame::RigidBodyFrame* now = frame->rigidBody(tool);
        if (now == nullptr) return;
        ready = false;
        shut(*frame, now->poses.front());
        tell();
    }

    /// Clips that were on tissue and are not there any more.
    void findSlipped(const frame::Frame& frame)
    {
        for (std::size_t i = 0; i < static_cast<std::size_t>(used); ++i) {
            if (!on[i] || std::ranges::find(frame.clips, holds[i], &frame::Clip::id) != frame.clips.end()) continue;
            on[i] = false;
            ++slipped;
        }
    }

    /// Whether the clips that were closed last hold: the step after it tells.
    void findOut(const frame::Frame& frame)
    {
        for (const int clip : std::exchange(asked, {})) {
            const auto index = static_cast<std::size_t>(clip);
            if (frame.step <= usedAt[index]) {
                asked.push_back(clip);
                continue;
            }
            const auto found = std::ranges::find(frame.clips, holds[index], &frame::Clip::id);
            on[index] = found != frame.clips.end();
            tellClip(on[index] ? found->tissue : BodyId{});
        }
    }
    void tellClip(BodyId tissue)
    {
        ++(tissue ? applied : missed);
        if (def.onClip) def.onClip(tissue);
    }

    /// The target with most nodes in the box between the legs; if none has one there, that with the nearest node: the
    /// engine knows whether the legs meet its surface. None if all are removed.
    [[nodiscard]] BodyId between(const frame::Frame& frame, const Pose& clip) const
    {
        const Pose back = inverse(clip);
        BodyId best = {};
        int most = 0;
        double nearest = std::numeric_limits<double>::infinity(); // [m^2]
        for (const BodyId each : def.targets) {
            const frame::SoftBodyFrame* body = frame.softBody(each);
            if (body == nullptr) continue;
            int inside = 0;
            double near = nearest;
            for (Vec3 node : body->positions) {
                const Vec3 p = transform(back, node);
                near = std::min(near, lengthSquared(p));
                inside += std::abs(p.x) < 2.0 * def.clip.width && std::abs(2.0 * p.y) < def.clip.opening &&
                          std::abs(2.0 * p.z) < def.clip.length;
            }
            if (inside > most || (most == 0 && near < nearest)) best = each;
            most = std::max(most, inside), nearest = near;
        }
        return best;
    }

    void shut(const frame::Frame& frame, const Pose& pivot)
    {
        findOut(frame);
        const int clip = next();
        if (clip == std::ssize(clips)) return; // it was removed from the jaws
        const auto index = static_cast<std::size_t>(clip);
        used = clip + 1;
        usedAt[index] = frame.step;
        const Pose place{transform(pivot, def.place), pivot.orientation};
        physics::PhysicsServer& physics = simulation.physics();
        physics.release(waits[index]);
        physics.setPose(clips[index], place);
        simulation.setVisible(closed[index], true);
        const BodyId target = between(frame, place);
        if (!target || !physics.has(target)) return tellClip({});
        holds[index] = physics.clip(clips[index], target, def.clip);
        asked.push_back(clip);
    }

    void reload()
    {
        physics::PhysicsServer& physics = simulation.physics();
        for (std::size_t i = 0; i < static_cast<std::size_t>(used); ++i) {
            simulation.setVisible(closed[i], false);
            if (!physics.has(clips[i])) continue;
            if (holds[i]) physics.release(holds[i]);
            holds[i] = {};
            physics.setPose(clips[i], {waitingPlace(static_cast<int>(i)), {}});
            waits[i] = physics.attach(clips[i], physics::RigidAttachmentDef{.points = {Vec3{}}});
        }
        used = 0;
        asked.clear();
        applied = missed = slipped = 0;
        on.assign(on.size(), false);
        ready = false;
        tell();
    }
    void tell() { newest.write({static_cast<int>(clips.size()) - used, applied, missed, slipped}); }

    using Ids = std::vector<AttachmentId>;
    using Kept =
        std::tuple<int, std::vector<int>, int, int, int, bool, Ids, Ids, std::vector<std::uint64_t>, std::vector<bool>>;
    auto kept() { return std::tie(used, asked, applied, missed, slipped, ready, waits, holds, usedAt, on); }
    void publish()
    {
        simulation.setVisible(loaded, shownLoaded = ready);
        for (std::size_t i = 0; i < clips.size(); ++i) simulation.setVisible(closed[i], static_cast<int>(i) < used);
        tell();
    }

    runtime::Simulation& simulation;
    const ArticulatedInstrument* jaws; ///< null: it has none
    const BodyId tool;
    const ClipApplierDef def;
    Turns turns; // guards the members below
    std::vector<BodyId> clips;
    std::vector<runtime::ShownId> closed; ///< each clip as it is drawn once it is used
    runtime::ShownId loaded = {};         ///< the open clip in the jaws
    bool shownLoaded = false;
    std::vector<AttachmentId> waits;   ///< by which those in the magazine hang in space
    std::vector<AttachmentId> holds;   ///< by which used ones hang on tissue
    std::vector<std::uint64_t> usedAt; ///< the step after which each was used
    std::vector<bool> on;              ///< which used ones are on tissue
    int used = 0, applied = 0, missed = 0, slipped = 0;
    std::vector<int> asked; ///< the clips of which the next step tells whether they hold
    bool ready = false;     ///< a clip is in the jaws
    struct Counts {
        int left = 0, applied = 0, missed = 0, slipped = 0;
    };
    Published<Counts> newest; // for all threads
};

ClipApplier::ClipApplier(runtime::Simulation& simulation, const ArticulatedInstrument& tool, const ClipApplierDef& def)
    : impl_(std::make_shared<Impl>(simulation, &tool, tool.body(), def))
{
    begin();
}
ClipApplier::ClipApplier(runtime::Simulation& simulation, BodyId tool, const ClipApplierDef& def)
    : impl_(std::make_shared<Impl>(simulation, nullptr, tool, def))
{
    begin();
}
void ClipApplier::begin()
{
    impl_->simulation.everyStep([weak = std::weak_ptr(impl_)](double) {
        if (const auto impl = weak.lock()) impl->watch();
    });
    remember(impl_->simulation, text("clips of body ", impl_->tool.value), impl_);
}
ClipApplier::~ClipApplier() = default;

int ClipApplier::left() const { return impl_->newest.read().left; }
int ClipApplier::applied() const { return impl_->newest.read().applied; }
int ClipApplier::missed() const { return impl_->newest.read().missed; }
std::vector<BodyId> ClipApplier::bodies() const { return impl_->clips; }
int ClipApplier::slipped() const { return impl_->newest.read().slipped; }
void ClipApplier::close()
{
    impl_->turns.take(!impl_->simulation.physics().stepsHere(), [impl = impl_] { impl->closeNow(); });
}
void ClipApplier::reload()
{
    impl_->turns.take(!impl_->simulation.physics().stepsHere(), [impl = impl_] { impl->reload(); });
}

} // namespace filasofia::prefab

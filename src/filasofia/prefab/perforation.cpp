#include "filasofia/prefab/perforation.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/physics/defs.h"
#include "filasofia/prefab/plain_window.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/smoothed.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <tuple>

namespace filasofia::prefab {
namespace {

constexpr double kOver = 0.5;  ///< [s] without perforation until it is over
constexpr double kLook = 5e-3; ///< [s] between two tests of the tips, each of which visits all elements
constexpr double kShown = 3.0; ///< [s], minimum time for which the picture shows it

PerforationDef checked(runtime::Simulation& simulation, PerforationDef def)
{
    validate(def, "perforation");
    if (def.tools.empty()) fail("perforation: tools must have at least one entry, got none");
    if (!std::holds_alternative<physics::SoftBodyDef>(*simulation.physics().def(def.wall)))
        fail("perforation: wall must be a soft body, got a rigid one");
    for (std::size_t i = 0; i < def.tools.size(); ++i) {
        const auto body = simulation.physics().def(def.tools[i].body);
        const auto* rigid = std::get_if<physics::RigidBodyDef>(body.get());
        if (rigid == nullptr) fail("perforation: tools[", i, "].body must be a rigid body, got a soft one");
        if (def.tools[i].element >= static_cast<int>(physics::elementCount(*rigid)))
            fail("perforation: tools[", i, "].element must be in [0, ", physics::elementCount(*rigid) - 1, "], got ",
                 def.tools[i].element);
    }
    return def;
}

bool isInside(const std::array<Vec3, 4>& corners, Vec3 p)
{
    const auto& [a, b, c, d] = corners;
    using geometry::signedVolume;
    return signedVolume(p, b, c, d) >= 0.0 && signedVolume(a, p, c, d) >= 0.0 && signedVolume(a, b, p, d) >= 0.0 &&
           signedVolume(a, b, c, p) >= 0.0;
}

} // namespace

struct PerforationWatch::Impl {
    Impl(runtime::Simulation& sim, PerforationDef asked)
        : simulation(sim), def(checked(sim, std::move(asked))), force(def.smoothing),
          tetrahedra(physics::worldMesh(std::get<physics::SoftBodyDef>(*sim.physics().def(def.wall))).tetrahedra)
    {
    }

    [[nodiscard]] bool isTool(BodyId id) const
    {
        return std::ranges::find(def.tools, id, &PiercingTool::body) != def.tools.end();
    }

    /// Before every step: evaluates the last one.
    void watch()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        const double pressed = force.follow(frame->time, pressing(*frame));
        std::optional<Vec3> place;
        if (pressed > def.force) place = hardest(*frame);
        if (!place && frame->time >= nextLook) {
            nextLook = frame->time + kLook;
            place = tipInside(*frame);
        }
        now = frame->time;
        if (!place) return;
        const bool another = frame->time - last > kOver;
        last = frame->time;
        if (!another) return;
        ++times;
        if (def.tracker != nullptr) def.tracker->mark(metric::EventKind::Perforation, "wall", pressed);
        if (def.perforated) def.perforated(*place, pressed);
    }

    [[nodiscard]] bool counts(const frame::Contact& contact) const
    {
        return (contact.first == def.wall && isTool(contact.second)) ||
               (contact.second == def.wall && isTool(contact.first));
    }
    [[nodiscard]] double pressing(const frame::Frame& frame) const
    {
        double sum = 0.0;
        for (const frame::Contact& contact : frame.contacts)
            if (counts(contact)) sum += contact.normalForce;
        return sum;
    }
    [[nodiscard]] std::optional<Vec3> hardest(const frame::Frame& frame) const
    {
        const frame::Contact* largest = nullptr;
        for (const frame::Contact& contact : frame.contacts)
            if (counts(contact) && (largest == nullptr || contact.normalForce > largest->normalForce))
                largest = &contact;
        return largest != nullptr ? std::optional(largest->point) : std::nullopt;
    }
    [[nodiscard]] std::optional<Vec3> tipInside(const frame::Frame& frame) const
    {
        const frame::SoftBodyFrame* wall = frame.softBody(def.wall);
        if (wall == nullptr) return {};
        const auto corner = [&](int node) { return wall->positions[static_cast<std::size_t>(node)]; };
        for (const PiercingTool& tool : def.tools) {
            const frame::RigidBodyFrame* body = frame.rigidBody(tool.body);
            if (body == nullptr || tool.element >= std::ssize(body->poses)) continue;
            const Vec3 tip = transform(body->poses[static_cast<std::size_t>(tool.element)], tool.tip);
            for (const auto& [a, b, c, d] : tetrahedra)
                if (isInside({corner(a), corner(b), corner(c), corner(d)}, tip)) return tip;
        }
        return {};
    }

    void draw() const
    {
        if (times == 0 || now - last > kShown) return;
        ImGui::SetNextWindowPos({0.5F * ImGui::GetIO().DisplaySize.x, 60.0F}, ImGuiCond_Always, {0.5F, 0.0F});
        if (ImGui::Begin("perforation", nullptr, kPlain)) ImGui::TextColored({1.0F, 0.25F, 0.2F, 1.0F}, "Perforation");
        ImGui::End();
    }

    using Kept = std::tuple<Smoothed, double, double, double, int>;
    auto kept() { return std::tie(force, nextLook, last, now, times); }

    runtime::Simulation& simulation;
    const PerforationDef def;
    Smoothed force;                                      ///< stepping thread only, as everything that is not atomic
    const std::vector<geometry::Tetrahedron> tetrahedra; ///< the wall's, as it was added
    double nextLook = 0.0;
    std::atomic<double> last = -1e9; ///< [s], time of the last perforation
    std::atomic<double> now = 0.0;
    std::atomic<int> times = 0;
};

PerforationWatch::PerforationWatch(runtime::Simulation& simulation, PerforationDef def)
    : impl_(std::make_shared<Impl>(simulation, std::move(def)))
{
    simulation.everyStep([impl = impl_](double) { impl->watch(); });
    remember(simulation, "perforations", impl_);
    simulation.show(visual::GuiDef{.name = "perforation", .renderCallback = [impl = impl_] { impl->draw(); }});
}

int PerforationWatch::count() const { return impl_->times; }

} // namespace filasofia::prefab

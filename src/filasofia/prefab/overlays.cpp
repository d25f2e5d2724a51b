#include "filasofia/prefab/overlays.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/prefab/plain_window.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/smoothed.h"

#include <imgui.h>

#include <algorithm>
#include <atomic>
#include <tuple>

namespace filasofia::prefab {
namespace {

constexpr double kCalm = 0.8; ///< [-], fraction of the warning below which the warning is over

} // namespace

struct Guidance::Impl {
    explicit Impl(const Task& of) : task(of) {}

    void draw()
    {
        if (!on) return;
        const TaskProgress now = task.progress();
        ImGui::SetNextWindowPos({12, 12});
        if (ImGui::Begin("guidance", nullptr, kPlain)) {
            if (now.state == TaskProgress::State::Running)
                line(text(now.step + 1, "/", task.def().steps.size(), "  ", shown(task.instruction())));
            else
                line(now.state == TaskProgress::State::Done ? "Done" : "Time is up");
        }
        ImGui::End();
        if (server != nullptr && now.target) point(*now.target);
    }

    /// Draws an arrow from the middle of the view to the target, through everything.
    void point(Vec3 target)
    {
        const visual::DebugStyle style{.color = {0.2, 0.9, 0.4}, .width = 2.5, .onTop = true};
        if (server->views().empty()) return;
        const Pose eye = server->views().front()->camera().worldPose();
        const Vec3 ahead = transform(eye, {0.0, 0.0, -12e-3});
        const double far = distance(ahead, target);
        if (far > 4e-3)
            server->debug().arrow(ahead, ahead + (3e-3 / far) * (target - ahead), style);
        else
            server->debug().point(target, {.color = style.color, .width = 10.0, .onTop = true});
    }

    const Task task; // shares the task's state
    visual::VisualServer* server = nullptr;
    std::atomic<bool> on = true;
};

Guidance::Guidance(runtime::Simulation& simulation, const Task& task) : impl_(std::make_shared<Impl>(task))
{
    simulation.show(visual::GuiDef{.name = "guidance", .renderCallback = [impl = impl_] { impl->draw(); }});
}
void Guidance::dress(visual::VisualServer& server) { impl_->server = &server; }
void Guidance::setOn(bool on) { impl_->on = on; }

struct ForceBar::Impl {
    Impl(runtime::Simulation& sim, const ForceBarDef& asked) : simulation(sim), def(asked), smoothed(def.smoothing)
    {
        validate(def, "force bar");
        if (def.bodies.empty()) fail("force bar: bodies must have at least one entry, got none");
        if (!(def.full > def.warning))
            fail("force bar: full must be > warning (", def.warning, " N), got ", def.full, " N");
    }

    [[nodiscard]] bool counts(BodyId id) const { return std::ranges::find(def.bodies, id) != def.bodies.end(); }

    /// Before every step: updates the smoothed force from the last step.
    void watch()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        double sum = 0.0;
        for (const frame::Contact& contact : frame->contacts)
            if (counts(contact.first) != counts(contact.second)) sum += contact.normalForce;
        for (const frame::Attachment& held : frame->attachments)
            if (held.to && counts(held.body) != counts(held.to)) sum += length(held.force);
        mean = smoothed.follow(frame->time, sum);
        largest = std::max(largest.load(), mean.load());
        // A force that oscillates about the threshold is one warning, not a hundred.
        if (mean > def.warning && !warned) ++warnings;
        warned = mean > (warned ? kCalm : 1.0) * def.warning;
    }

    void draw() const
    {
        const float now = static_cast<float>(mean), full = static_cast<float>(def.full);
        const bool high = mean > def.warning;
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({12.0F, screen.y - 12.0F}, ImGuiCond_Always, {0.0F, 1.0F});
        if (ImGui::Begin("force", nullptr, kPlain)) {
            char value[32];
            std::snprintf(value, sizeof value, "%.2f N", static_cast<double>(now));
            line(text(shown(def.name, 30), high ? ": too high" : ""));
            ImGui::PushStyleColor(ImGuiCol_PlotHistogram,
                                  high ? ImVec4(0.85F, 0.15F, 0.1F, 1.0F) : ImVec4(0.2F, 0.65F, 0.35F, 1.0F));
            ImGui::ProgressBar(std::clamp(now / full, 0.0F, 1.0F), {160.0F, 0.0F}, value);
            ImGui::PopStyleColor();
        }
        ImGui::End();
    }

    using Kept = std::tuple<Smoothed, bool, double, double, int>;
    auto kept() { return std::tie(smoothed, warned, mean, largest, warnings); }

    runtime::Simulation& simulation;
    const ForceBarDef def;
    Smoothed smoothed;   // stepping thread only
    bool warned = false; // stepping thread only
    std::atomic<double> mean = 0.0;
    std::atomic<double> largest = 0.0;
    std::atomic<int> warnings = 0;
};

ForceBar::ForceBar(runtime::Simulation& simulation, const ForceBarDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    simulation.everyStep([impl = impl_](double) { impl->watch(); });
    remember(simulation, text("force bar '", shown(def.name), "'"), impl_);
    simulation.show(visual::GuiDef{.name = "force", .renderCallback = [impl = impl_] { impl->draw(); }});
}

struct FluidPanel::Impl {
    explicit Impl(runtime::Simulation& sim) : simulation(sim) { static_cast<void>(sim.distension()); }

    void draw() const
    {
        constexpr double kMillilitres = 1e6, kPerMinute = 60.0 * kMillilitres, kMmHg = 133.322;
        constexpr double kCloudy = 0.002; // [-], share of blood that is seen
        const surface::DistensionBalance now = simulation.distension();
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({screen.x - 12.0F, screen.y - 12.0F}, ImGuiCond_Always, {1.0F, 1.0F});
        ImGui::SetNextWindowSizeConstraints({270.0F, 0.0F},
                                            {270.0F, 200.0F}); // its words change from picture to picture
        if (ImGui::Begin("fluid", nullptr, kPlain)) {
            char words[96];
            std::snprintf(words, sizeof words, "Fluid %.0f mmHg, in %.0f, out %.0f ml/min", now.pressure / kMmHg,
                          now.inflow * kPerMinute, now.outflow * kPerMinute);
            line(words);
            if (now.beyondLimit) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(0.95F, 0.25F, 0.2F, 1.0F));
            std::snprintf(words, sizeof words, "Deficit %.0f ml%s", surface::deficit(now) * kMillilitres,
                          now.beyondLimit ? ": too much" : "");
            line(words);
            if (now.beyondLimit) ImGui::PopStyleColor();
            // Always three lines: a window is as high as it was in the last picture.
            line(surface::bloodShare(now) > kCloudy ? "Blood clouds it: open the outflow" : " ");
        }
        ImGui::End();
    }

    runtime::Simulation& simulation;
};

FluidPanel::FluidPanel(runtime::Simulation& simulation) : impl_(std::make_shared<Impl>(simulation))
{
    simulation.show(visual::GuiDef{.name = "fluid", .renderCallback = [impl = impl_] { impl->draw(); }});
}

double ForceBar::force() const { return impl_->mean; }
double ForceBar::highest() const { return impl_->largest; }
int ForceBar::warnings() const { return impl_->warnings; }

} // namespace filasofia::prefab

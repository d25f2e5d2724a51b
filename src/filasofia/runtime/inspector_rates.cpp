#include "filasofia/runtime/inspector_rates.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {
namespace {

constexpr double kPointInterval = 0.1; // [s], interval of one point in a plot

void plot(const char* name, const Trace& trace, double reference, const char* unit)
{
    char overlay[64];
    std::snprintf(overlay, sizeof overlay, "%s %.0f %s", name, trace.newest(), unit);
    float top = float(1.25 * reference);
    for (int i = 0; i < trace.count(); ++i) top = std::max(top, trace.data()[i]);
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 3.2F * ImGui::GetFontSize()};
    ImGui::PushID(name);
    ImGui::PlotLines("##plot", trace.data(), trace.count(), trace.oldest(), overlay, 0.0F, top, size);
    ImGui::PopID();
}

void stage(const char* name, double seconds, double period)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::Text("%.3f ms", 1e3 * seconds);
    ImGui::TableNextColumn();
    ImGui::ProgressBar(float(seconds / period), {-1.0F, 0.75F * ImGui::GetFontSize()}, "");
}

} // namespace

void InspectorRates::restart()
{
    now_ = {};
    since_ = impl_.clock.now();
}

void InspectorRates::add(const physics::StepReport& report)
{
    using physics::StepFlag;
    ++now_.steps;
    now_.moving += report.dt > 0.0;
    now_.simulated += report.dt;
    now_.times.commands += report.times.commands;
    now_.times.contacts += report.times.contacts;
    now_.times.assemble += report.times.assemble;
    now_.times.advance += report.times.advance;
    now_.times.topology += report.times.topology;
    late_ += report.has(StepFlag::Late);
    clamped_ += report.has(StepFlag::Clamped);
    undone_ += report.has(StepFlag::Undone);
    notConverged_ += report.has(StepFlag::NotConverged);
    outOfTime_ += report.has(StepFlag::OutOfTime);
    inverted_ = report.inverted.count;
    mostInverted_ = std::max(mostInverted_, inverted_);
    intersecting_ = static_cast<int>(report.intersections.size());
    mostIntersecting_ = std::max(mostIntersecting_, intersecting_);
    beyondStrain_ = report.beyondStrain.count;
    mostBeyondStrain_ = std::max(mostBeyondStrain_, beyondStrain_);
    unrest_ = report.unrest;
    energyGained_ += report.has(StepFlag::EnergyGained);
    paused_ = report.dt == 0.0;
    time_ = report.time;
    step_ = report.step;
    contacts_ = report.contacts;
    solves_ = report.solves;
}

void InspectorRates::addPicture(double guiSeconds)
{
    guiSeconds_ = guiSeconds;
    const Nanoseconds now = impl_.clock.now();
    const double seconds = toSeconds(now - since_);
    if (seconds < kPointInterval) return;
    physics_.add(now_.steps / seconds);
    pictures_.add(now_.pictures / seconds);
    const physics::StageTimes& times = now_.times;
    stepTime_.add(1e6 * (times.commands + times.contacts + times.assemble + times.advance + times.topology) /
                  std::max(now_.steps, 1));
    last_ = now_;
    lastSeconds_ = seconds;
    since_ = now;
    now_ = {};
}

void InspectorRates::draw()
{
    const double asked = impl_.def.physics.rate;
    plot("physics", physics_, asked, "Hz");
    plot("picture", pictures_, impl_.def.look.rate, "Hz");
    plot("step", stepTime_, 0.5e6 / asked, "\xc2\xb5s");
    ImGui::Text("t = %.3f s   step %llu", time_, static_cast<unsigned long long>(step_));
    if (lastSeconds_ > 0.0) ImGui::Text("%.2f s simulated per second", last_.simulated / lastSeconds_);
    const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    ImGui::Text("late %llu   clamped %llu   rolled back %llu", count(late_), count(clamped_), count(undone_));
    ImGui::Text("not converged %llu   out of time %llu", count(notConverged_), count(outOfTime_));
    if (mostInverted_ > 0) ImGui::Text("elements inside out %d   at most %d", inverted_, mostInverted_);
    if (mostIntersecting_ > 0)
        ImGui::Text("pairs of bodies through each other %d   at most %d", intersecting_, mostIntersecting_);
    if (mostBeyondStrain_ > 0)
        ImGui::Text("elements beyond their range %d   at most %d", beyondStrain_, mostBeyondStrain_);
    if (unrest_.bodies > 0)
        ImGui::Text("not at rest: %.1f mm/s, %.1f s after a drive", 1e3 * unrest_.speed, unrest_.undriven);
    if (energyGained_ > 0) ImGui::Text("energy from nowhere in %llu steps", count(energyGained_));
    if (const std::uint64_t lost = impl_.feed.lost()) ImGui::Text("%llu step reports dropped", count(lost));
    drawStages();
    drawSolvers();
}

void InspectorRates::drawStages() const
{
    if (!ImGui::TreeNodeEx("Time per stage", ImGuiTreeNodeFlags_DefaultOpen)) return;
    const double steps = std::max(last_.steps, 1), period = 1.0 / impl_.def.physics.rate;
    if (ImGui::BeginTable("stages", 3, ImGuiTableFlags_SizingFixedFit)) {
        ImGui::TableSetupColumn("stage");
        ImGui::TableSetupColumn("mean");
        ImGui::TableSetupColumn("share of the period", ImGuiTableColumnFlags_WidthStretch);
        stage("commands", last_.times.commands / steps, period);
        stage("contacts", last_.times.contacts / steps, period);
        stage("assemble", last_.times.assemble / steps, period);
        stage("advance", last_.times.advance / steps, period);
        stage("topology", last_.times.topology / steps, period);
        stage("this Gui", guiSeconds_, 1.0 / impl_.def.look.rate);
        ImGui::EndTable();
    }
    ImGui::TreePop();
}

std::string InspectorRates::nameOf(BodyId id) const
{
    try {
        return std::visit([](const auto& body) { return body.name; }, *impl_.physics.def(id));
    } catch (const Error&) {
        return text("body ", id.value); // removed meanwhile
    }
}

void InspectorRates::drawSolvers() const
{
    if (!ImGui::TreeNodeEx("Solvers", ImGuiTreeNodeFlags_DefaultOpen)) return;
    if (solves_.empty()) ImGui::TextDisabled("no soft body");
    for (const physics::BodySolve& solve : solves_)
        ImGui::Text("%s: %d iterations, residual %.1e", nameOf(solve.body).c_str(), solve.iterations, solve.residual);
    ImGui::Text("contacts: %d near, %d active, %d rounds", contacts_.found, contacts_.active, contacts_.rounds);
    if (contacts_.penetration > 0.0) ImGui::Text("deepest penetration %.3f mm", 1e3 * contacts_.penetration);
    ImGui::TreePop();
}

} // namespace filasofia::runtime

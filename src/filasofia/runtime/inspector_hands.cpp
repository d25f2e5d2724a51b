#include "filasofia/runtime/inspector_hands.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::runtime {
namespace {

void vector(const char* name, Vec3 v, double unit, const char* format)
{
    char line[128];
    std::snprintf(line, sizeof line, format, v.x / unit, v.y / unit, v.z / unit);
    ImGui::Text("%s %s", name, line);
}

} // namespace

Pose originThrough(Vec3 place, Vec3 hand, double scale, Quat orientation)
{
    return {place - scale * rotate(orientation, hand), orientation};
}

void InspectorHands::draw()
{
    for (const HapticId id : impl_.haptics.ids()) drawHand(id);
    if (!problem_.empty()) ImGui::TextWrapped("%s", problem_.c_str());
}

void InspectorHands::drawHand(HapticId id)
{
    const HapticState state = impl_.haptics.state(id);
    const HapticInterfaceDef def = impl_.haptics.def(id);
    ImGui::PushID(static_cast<int>(id.value));
    const std::string_view word = device::describe(state.state);
    ImGui::Text("%s: %.*s", def.name.c_str(), static_cast<int>(word.size()), word.data());
    vector("position", state.hand.pose.position, 1e-3, "%8.2f %8.2f %8.2f mm");
    vector("rotation", rotationVector(state.hand.pose.orientation), std::acos(-1.0) / 180.0, "%7.1f %7.1f %7.1f deg");
    vector("force", state.onHand.force, 1.0, "%8.3f %8.3f %8.3f N");
    ImGui::ProgressBar(static_cast<float>(length(state.onHand.force) / def.forceLimit), {-1.0F, 0.0F}, "force / limit");
    ImGui::Text("energy given to the hand %.2f mJ", 1e3 * state.servo.energy);
    drawJitter(state.servo);
    drawPlace(id, state);
    ImGui::PopID();
}

void InspectorHands::drawJitter(const device::ServoStatistics& servo) const
{
    const device::JitterHistogram& jitter = servo.jitter;
    ImGui::Text("servo %.1f Hz, longest call %.2f ms", servo.rate, 1e3 * servo.longestCall);
    if (jitter.total() == 0) return; // a headless run has no jitter
    std::array<float, device::JitterHistogram::kBins> bars{};
    for (std::size_t i = 0; i < bars.size(); ++i) // logarithmic, because the rare late ticks matter
        bars[i] = jitter.counts[i] > 0 ? 1.0F + std::log10(static_cast<float>(jitter.counts[i])) : 0.0F;
    char overlay[96];
    std::snprintf(overlay, sizeof overlay, "late by: median %.2f, p99.9 %.2f, max %.2f ms",
                  1e3 * jitter.percentile(0.5), 1e3 * jitter.percentile(0.999), 1e3 * servo.latest);
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 3.2F * ImGui::GetFontSize()};
    ImGui::PlotHistogram("##jitter", bars.data(), static_cast<int>(bars.size()), 0, overlay, 0.0F, 8.0F, size);
}

void InspectorHands::drawPlace(HapticId id, const HapticState& state)
{
    HapticInterfaceDef def = impl_.haptics.def(id);
    const Pose origin = def.origin.value_or(Pose{});
    const Vec3 hand = impl_.haptics.deviceHand(id).pose.position;
    auto scale = static_cast<float>(def.scale);
    if (ImGui::SliderFloat("scale", &scale, 0.1F, 10.0F, "%.3g",
                           ImGuiSliderFlags_Logarithmic)) // about the hand's present place
        place(id, scale, originThrough(state.hand.pose.position, hand, scale, origin.orientation));
    std::array<float, 3> at{};
    for (int k = 0; k < 3; ++k) at[static_cast<std::size_t>(k)] = static_cast<float>(1e3 * origin.position[k]);
    if (ImGui::DragFloat3("origin [mm]", at.data(), 0.1F))
        place(id, def.scale, {1e-3 * Vec3{at[0], at[1], at[2]}, origin.orientation});
    if (!def.body || !ImGui::Button("Place the hand at the body")) return;
    const frame::FrameRef frame = impl_.physics.latest();
    const frame::RigidBodyFrame* body = frame ? frame->rigidBody(def.body) : nullptr;
    if (!body) return;
    const Vec3 there = body->poses[static_cast<std::size_t>(def.element)].position;
    place(id, def.scale, originThrough(there, hand, def.scale, origin.orientation));
}

void InspectorHands::place(HapticId id, double scale, const Pose& origin)
{
    try {
        impl_.haptics.place(id, scale, origin);
        problem_.clear();
    } catch (const Error& error) {
        problem_ = error.what();
    }
}

} // namespace filasofia::runtime

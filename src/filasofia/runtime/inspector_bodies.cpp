#include "filasofia/runtime/inspector_bodies.h"

#include "filasofia/runtime/inspector_fields.h"

#include <imgui.h>

#include <algorithm>

namespace filasofia::runtime {
namespace {

/// A number that the user drags or types. Returns true at the end of a drag, when the value is to be applied, not at
/// each pixel.
bool editNumber(const char* name, double& value, double speed, const char* format, double low = 0.0, double high = 0.0)
{
    auto shown = float(value);
    if (ImGui::DragFloat(name, &shown, float(speed), float(low), float(high), format)) value = double(shown);
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool editVector(const char* name, Vec3& value, double speed, const char* format)
{
    float shown[3] = {float(value.x), float(value.y), float(value.z)};
    if (ImGui::DragFloat3(name, shown, float(speed), 0.0F, 0.0F, format))
        value = {double(shown[0]), double(shown[1]), double(shown[2])};
    return ImGui::IsItemDeactivatedAfterEdit();
}

/// All numbers of a Def, within their ranges.
template <class T> bool editNumbers(T& def)
{
    bool changed = false;
    forEachField<T>([&](const auto& each) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(def.*(each.member))>, double>)
            changed = editNumber(std::string(each.name).c_str(), def.*(each.member), 0.01, "%.3g", each.range.low,
                                 each.range.high) ||
                      changed;
    });
    return changed;
}

bool editLaw(physics::ElasticLaw& law)
{
    bool changed = false;
    std::visit([&](auto& each) { changed = editNumbers(each); }, law);
    const auto name = [](const physics::ElasticLaw& each) { return std::string(physics::nameOf(each)); };
    if (!ImGui::BeginCombo("law", name(law).c_str())) return changed;
    for (const physics::ElasticLaw& each : physics::elasticLaws())
        if (ImGui::Selectable(name(each).c_str(), each.index() == law.index()) && each.index() != law.index()) {
            law = each;
            changed = true;
        }
    ImGui::EndCombo();
    return changed;
}

bool editMaterial(physics::FemMaterial& material)
{
    const bool law = editLaw(material.law);
    const bool young = editNumber("E [Pa]", material.youngModulus, 0.005 * material.youngModulus, "%.0f", 1.0, 1e9);
    const bool poisson = editNumber("nu", material.poissonRatio, 0.001, "%.3f", 0.0, 0.499);
    return law || young || poisson;
}

bool editMaterial(physics::MassSpringMaterial& material)
{
    const bool stiffness = editNumber("k [N/m]", material.stiffness, 0.005 * material.stiffness, "%.3g", 1e-3, 1e9);
    const bool damping = editNumber("d [N s/m]", material.damping, 0.01, "%.3g", 0.0, 1e6);
    return stiffness || damping;
}

bool editMaterial(physics::ShellMaterial& material)
{
    const bool young = editNumber("E [Pa]", material.youngModulus, 0.005 * material.youngModulus, "%.0f", 1.0, 1e9);
    const bool poisson = editNumber("nu", material.poissonRatio, 0.001, "%.3f", 0.0, 0.499);
    const bool bending = editNumber("bending [-]", material.bendingScale, 0.01, "%.3g", 0.0, 1e6);
    return young || poisson || bending;
}

std::string titleOf(const physics::BodyDef& def, BodyId id)
{
    const std::string name = std::visit([](const auto& body) { return body.name; }, def);
    constexpr std::array kinds{"  (soft, ", "  (rigid, ", "  (rod, "};
    return name + kinds.at(def.index()) + std::to_string(id.value) + ")###body" + std::to_string(id.value);
}

} // namespace

InspectorBodies::InspectorBodies(Simulation::Impl& impl) : impl_(impl), gravity_(impl.def.physics.gravity) {}

template <class Command> void InspectorBodies::attempt(Command&& command)
{
    try {
        command();
        problem_.clear();
    } catch (const Error& error) {
        problem_ = error.what();
    }
}

InspectorBodies::Body* InspectorBodies::bodyOf(BodyId id)
{
    const auto found = bodies_.find(id);
    if (found != bodies_.end()) return &found->second;
    try {
        Body body{.def = impl_.physics.def(id)};
        if (const auto* soft = std::get_if<physics::SoftBodyDef>(&*body.def)) {
            body.material = soft->material;
            body.pressure = soft->pressure;
        }
        return &(bodies_[id] = std::move(body));
    } catch (const Error&) {
        return nullptr; // removed; the next frame lacks it
    }
}

void InspectorBodies::draw()
{
    const frame::FrameRef frame = impl_.physics.latest();
    if (editVector("g [m/s\xc2\xb2]", gravity_, 0.05, "%.2f")) attempt([&] { impl_.physics.setGravity(gravity_); });
    if (!frame) return;
    const bool few = frame->softBodies.size() + frame->rigidBodies.size() <= 4;
    const ImGuiTreeNodeFlags open = few ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None;
    const auto drawEach = [&](const auto& states, auto drawOne) {
        for (const auto& state : states) {
            Body* body = bodyOf(state.id);
            if (!body || !ImGui::TreeNodeEx(titleOf(*body->def, state.id).c_str(), open)) continue;
            (this->*drawOne)(state, *body);
            ImGui::TreePop();
        }
    };
    drawEach(frame->softBodies, &InspectorBodies::drawSoft);
    drawEach(frame->rigidBodies, &InspectorBodies::drawRigid);
    drawAttachments(*frame);
}

void InspectorBodies::drawSoft(const frame::SoftBodyFrame& state, Body& body)
{
    double fastest = 0.0;
    for (const Vec3& v : state.velocities) fastest = std::max(fastest, length(v));
    ImGui::Text("%zu nodes, fastest %.3f m/s", state.positions.size(), fastest);
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&*body.def)) {
        if (ImGui::TreeNode("definition")) {
            drawFields(*rod);
            ImGui::TreePop();
        }
        return;
    }
    if (std::visit([](auto& material) { return editMaterial(material); }, body.material))
        attempt([&] { impl_.physics.setMaterial(state.id, body.material); });
    if (editNumber("pressure [Pa]", body.pressure, 1.0, "%.1f"))
        attempt([&] { impl_.physics.setPressure(state.id, body.pressure); });
    if (ImGui::TreeNode("definition")) {
        drawFields(std::get<physics::SoftBodyDef>(*body.def));
        ImGui::TreePop();
    }
}

void InspectorBodies::drawRigid(const frame::RigidBodyFrame& state, Body& body)
{
    const auto& def = std::get<physics::RigidBodyDef>(*body.def);
    drawPlaces(state, def.dynamic);
    if (def.dynamic && editVector("force [N]", body.force, 0.01, "%.3f")) // at the first element's centre of mass
        attempt([&] { impl_.physics.setWrench(state.id, body.force, {}); });
    if (ImGui::TreeNode("definition")) {
        drawFields(def);
        ImGui::TreePop();
    }
}

void InspectorBodies::drawPlaces(const frame::RigidBodyFrame& state, bool dynamic)
{
    for (std::size_t element = 0; element < state.poses.size(); ++element) {
        ImGui::PushID(int(element));
        Pose pose = state.poses[element];
        Vec3 millimetres = 1e3 * pose.position;
        float shown[3] = {float(millimetres.x), float(millimetres.y), float(millimetres.z)};
        if (ImGui::DragFloat3("position [mm]", shown, 0.1F, 0.0F, 0.0F, "%.1f")) { // the body follows the mouse
            pose.position = 1e-3 * Vec3{double(shown[0]), double(shown[1]), double(shown[2])};
            attempt([&] { impl_.physics.setPose(state.id, pose, int(element)); });
        }
        if (dynamic) ImGui::Text("%.3f m/s", length(state.velocities[element]));
        ImGui::PopID();
    }
}

void InspectorBodies::drawAttachments(const frame::Frame& frame) const
{
    if (frame.attachments.empty() || !ImGui::TreeNode("Attachments")) return;
    for (const frame::Attachment& each : frame.attachments)
        ImGui::Text("%u: body %u, %d points, %.3g N%s", unsigned(each.id.value), unsigned(each.body.value), each.points,
                    length(each.force), each.broken ? ", broken" : "");
    ImGui::TreePop();
}

} // namespace filasofia::runtime

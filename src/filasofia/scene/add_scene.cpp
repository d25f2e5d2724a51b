#include "filasofia/scene/def_shapes.h"
#include "filasofia/scene/motion.h"

#include "filasofia/core/error.h"

namespace filasofia::scene {
namespace {

/// Replaces the numbers of bodies in a Def by their ids.
class BodyNumbers {
public:
    explicit BodyNumbers(const std::vector<BodyId>& ids) : ids_(ids) {}

    template <class T> void replaceIn(T& value) const
    {
        if constexpr (std::is_same_v<T, BodyId>) {
            if (value && value.value > ids_.size())
                fail("the scene has ", ids_.size(), " bodies before this one, got body ", value.value);
            if (value) value = ids_[value.value - 1];
        } else if constexpr (kIsOptional<T>) {
            if (value) replaceIn(*value);
        } else if constexpr (kIsVector<T>) {
            if constexpr (!std::is_arithmetic_v<typename T::value_type>)
                for (auto& each : value) replaceIn(each);
        } else if constexpr (kIsVariant<T>) {
            std::visit([&](auto& held) { replaceIn(held); }, value);
        } else if constexpr (HasFields<T>) {
            forEachField<T>([&](const auto& each) { replaceIn(value.*(each.member)); });
        }
    }

private:
    const std::vector<BodyId>& ids_;
};

BodyId addBody(runtime::Simulation& simulation, const SceneBody& body, const std::vector<BodyId>& before)
{
    physics::BodyDef def = body.def;
    BodyNumbers(before).replaceIn(def);
    checkMotions(body);
    if (body.show.empty() && !body.paint.empty())
        fail(physics::describeBody(body.def), ": paint needs a body that is drawn: give it a show");
    if (auto* rigid = std::get_if<physics::RigidBodyDef>(&def)) setFirstPoses(body.motions, *rigid);
    const BodyId id = std::visit([&](auto& each) { return simulation.add(std::move(each)); }, def);
    for (const runtime::ShowDef& each : body.show) simulation.show(id, each);
    for (const runtime::PaintDef& each : body.paint) simulation.paint(id, each);
    followMotions(simulation, id, body);
    return id;
}

/// The place of what an Error of a body speaks of: "soft body 'liver': attachments[0].box: high must ..."
std::string placeOf(const SceneBody& body, std::string_view error)
{
    const std::string object = physics::describeBody(body.def) + ": ";
    std::string path;
    if (error.starts_with(object)) path = error.substr(object.size(), error.find(' ', object.size()) - object.size());
    if (path.ends_with(':')) path.pop_back();
    while (!body.places.contains(path)) { // from the member to what it is in
        if (path.empty()) return {};
        const auto end = path.find_last_of(".[");
        path.erase(end == std::string::npos ? 0 : end);
    }
    return body.places.at(path);
}

} // namespace

runtime::SimulationDef simulationDef(const SceneDef& scene)
{
    return {.physics = scene.physics, .window = scene.window, .look = scene.look};
}

std::vector<BodyId> addScene(runtime::Simulation& simulation, const SceneDef& scene)
{
    std::vector<BodyId> ids;
    for (const SceneBody& body : scene.bodies) try {
            ids.push_back(addBody(simulation, body, ids));
        } catch (const Error& error) {
            const std::string place = placeOf(body, error.what());
            fail(place, place.empty() ? "" : ": ", error.what());
        }
    for (std::size_t i = 0; i < scene.haptics.size(); ++i) try {
            runtime::HapticInterfaceDef haptic = scene.haptics[i];
            BodyNumbers(ids).replaceIn(haptic);
            simulation.add(haptic);
        } catch (const Error& error) {
            fail("haptics[", i, "]: ", error.what());
        }
    return ids;
}

} // namespace filasofia::scene

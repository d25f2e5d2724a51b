#include "filasofia/scene/commands.h"
#include "filasofia/scene/dress.h"
#include "filasofia/scene/instruments.h"
#include "filasofia/scene/knots.h"
#include "filasofia/scene/motion.h"
#include "filasofia/scene/pedals.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/scene_numbers.h"
#include "filasofia/scene/task.h"

#include "filasofia/core/error.h"

#include <algorithm>

namespace filasofia::scene {
namespace {

/// `drawn`: it is drawn as what it is; otherwise as it says.
BodyId addBody(runtime::Simulation& simulation, const SceneBody& body, const std::vector<BodyId>& before, bool drawn,
               AddedScene& added)
{
    physics::BodyDef def = body.def;
    SceneNumbers(before).replaceIn(def);
    checkMotions(body);
    if (body.show.empty() && !drawn && !body.paint.empty())
        fail(physics::describeBody(body.def), ": paint needs a body that is drawn: give it a show");
    if (auto* rigid = std::get_if<physics::RigidBodyDef>(&def)) setFirstPoses(body.motions, *rigid);
    const BodyId id = std::visit([&](auto& each) { return simulation.add(std::move(each)); }, def);
    if (drawn) added.drawn[id] = simulation.show(id);
    for (const runtime::ShowDef& each : body.show) simulation.show(id, each);
    for (const runtime::PaintDef& each : body.paint) simulation.paint(id, each);
    if (body.bleeding) simulation.bleed(id, *body.bleeding);
    if (body.burning) simulation.burn(id, *body.burning);
    addElectrodes(simulation, id, body.electrodes, before);
    for (const surface::DuctDef& each : body.ducts) simulation.addDuct(id, each);
    followMotions(simulation, id, body);
    return id;
}

std::shared_ptr<prefab::Sensors> addSensors(runtime::Simulation& simulation, const SceneDef& scene,
                                            const std::vector<BodyId>& ids, std::string file)
{
    if (scene.sensors.empty()) {
        if (!file.empty()) fail("sensors: there must be a sensor: without one there is nothing to write");
        return {};
    }
    prefab::SensorsDef def{.sensors = scene.sensors, .rate = scene.sensorRate, .file = std::move(file)};
    for (prefab::SensorDef& each : def.sensors) SceneNumbers(ids).replaceIn(each);
    try {
        return std::make_shared<prefab::Sensors>(simulation, std::move(def));
    } catch (const Error& error) {
        std::string_view words = error.what();
        if (words.starts_with("sensors: sensors["))
            words.remove_prefix(std::string_view("sensors: ").size()); // it begins with the member's path
        failAtPlace(scene.places, words);
    }
}

/// The path of what an Error of a body speaks of: "soft body 'liver': attachments[0].box: high must ..."
std::string pathIn(const SceneBody& body, std::string_view error)
{
    const std::string object = physics::describeBody(body.def) + ": ";
    std::string path;
    if (error.starts_with(object)) path = error.substr(object.size(), error.find(' ', object.size()) - object.size());
    if (path.ends_with(':')) path.pop_back();
    return path;
}

} // namespace

std::string placeOf(const Places& places, std::string path)
{
    while (!places.contains(path)) { // from the member to what it is in
        if (path.empty()) return {};
        const auto end = path.find_last_of(".[");
        path.erase(end == std::string::npos ? 0 : end);
    }
    return places.at(path);
}

void failAtPlace(const Places& places, const std::string& path, std::string_view error)
{
    const std::string place = placeOf(places, path);
    fail(place, place.empty() ? "" : ": ", error);
}

void failAtPlace(const Places& places, std::string_view error)
{
    failAtPlace(places, std::string(error.substr(0, error.find_first_of(" :"))), error);
}

runtime::SimulationDef simulationDef(const SceneDef& scene)
{
    return {.physics = scene.physics, .window = scene.window, .look = scene.look};
}

AddedScene addScene(runtime::Simulation& simulation, const SceneDef& scene, prefab::MetricTrackerDef tracker,
                    std::string sensorsFile)
{
    AddedScene added;
    std::vector<BodyId>& ids = added.bodies;
    if (scene.smoke) try {
            simulation.addSmoke(*scene.smoke);
        } catch (const Error& error) {
            failAtPlace(scene.places, "smoke", error.what());
        }
    if (scene.distension) try {
            simulation.addDistension(*scene.distension);
        } catch (const Error& error) {
            failAtPlace(scene.places, "distension", error.what());
        }
    const bool showsNone = std::ranges::all_of(scene.bodies, [](const SceneBody& each) { return each.show.empty(); });
    for (const SceneBody& body : scene.bodies) try {
            const bool drawn = showsNone && physics::hasSurface(body.def); // or the picture would be black
            ids.push_back(addBody(simulation, body, ids, drawn, added));
        } catch (const Error& error) {
            failAtPlace(body.places, pathIn(body, error.what()), error.what());
        }
    const Instruments instruments = addInstruments(simulation, scene, ids);
    added.knots = addKnots(simulation, scene, ids);
    dressScene(simulation, scene, ids);
    for (const TimedCommand& each : scene.commands)
        if (const auto* gone = std::get_if<physics::RemoveBody>(&each.command);
            gone && gone->id.value > scene.bodies.size())
            fail(each.place, ".id must not be an instrument: what moves it would go on");
    followCommands(simulation, scene.commands, ids);
    Hands hands;
    for (std::size_t i = 0; i < scene.haptics.size(); ++i) try {
            runtime::HapticInterfaceDef haptic = scene.haptics[i];
            SceneNumbers(ids).replaceIn(haptic);
            const BodyId body = haptic.body;
            haptic.body = heldFor(instruments, body);
            hands.emplace_back(simulation.add(haptic), body);
            giveToHand(simulation, instruments, body, hands.back().first);
        } catch (const Error& error) {
            const std::string path = text("haptics[", i, "]");
            failAtPlace(scene.places, path, text(path, ": ", error.what()));
        }
    followPedals(simulation, scene, ids, instruments, hands);
    try {
        added.tracker = addTracker(simulation, scene, ids, std::move(tracker));
        const bool dressed = !scene.cameras.empty() || std::ranges::any_of(instruments, &Instrument::isScope);
        if (scene.task) added.task = addTask(simulation, withNames(*scene.task), ids, added.tracker.get(), dressed);
    } catch (const Error& error) {
        std::string words = error.what();
        if (constexpr std::string_view kBodies = "metric tracker: bodies["; words.starts_with(kBodies))
            words.replace(0, kBodies.size(), "measured["); // as the file calls them
        failAtPlace(scene.places, words);
    }
    added.sensors = addSensors(simulation, scene, ids, std::move(sensorsFile));
    return added;
}

} // namespace filasofia::scene

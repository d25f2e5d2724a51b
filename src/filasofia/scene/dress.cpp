#include "filasofia/scene/dress.h"

#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/scene_numbers.h"
#include "filasofia/visual/visual_server.h"

#include <algorithm>

namespace filasofia::scene {
namespace {

/// What a scene adds to the visual server, with the ids of the bodies.
struct Dress {
    std::vector<SceneCamera> cameras;
    std::vector<SceneLight> lights;
    std::vector<SceneView> views;
    visual::EnvironmentDef environment;
    Places places;
};

/// Runs `act` for a member of a list; its Error gets the member's place.
template <class Act> void forMember(const Places& places, const char* list, std::size_t i, const Act& act)
{
    try {
        act();
    } catch (const Error& error) {
        const std::string path = text(list, "[", i, "]");
        failAtPlace(places, path, text(path, ": ", error.what()));
    }
}

/// The index of the camera of this name.
std::size_t indexOf(const std::vector<SceneCamera>& cameras, const std::string& name, const std::string& field)
{
    std::vector<std::string> known;
    for (const SceneCamera& each : cameras) {
        if (each.def.name == name) return known.size();
        known.push_back(each.def.name);
    }
    fail(field, " must be the name of a camera of the scene, got '", name, "'", didYouMean(name, known));
}

/// Checks where it is and makes its body's number an id.
template <class Def> void place(std::vector<Placed<Def>>& all, const char* list,
                                const std::vector<SceneCamera>& cameras, const std::vector<BodyId>& ids)
{
    for (std::size_t i = 0; i < all.size(); ++i) {
        Placed<Def>& each = all[i];
        const std::string name = text(list, "[", i, "]");
        SceneNumbers(ids).replaceIn(each.follow);
        if (each.follow && !each.on.empty()) fail(name, ".follow needs an empty `on`: a body carries it, or a camera");
        if (!each.on.empty()) {
            const std::size_t carrier = indexOf(cameras, each.on, name + ".on");
            if (std::is_same_v<Def, visual::CameraDef> && carrier >= i)
                fail(name, ".on must be a camera before this one, got '", each.on, "'");
        }
        each.pose = physics::unitPose(each.pose, name + ".pose");
        if (each.target && *each.target == each.pose.position) fail(name, ".target must differ from its position");
        if (each.target) each.pose = visual::lookAt(each.pose.position, *each.target);
    }
}

template <class Def> void put(visual::Transform& transform, const Placed<Def>& at,
                              const std::vector<visual::Camera*>& cameras, const std::vector<SceneCamera>& defs,
                              runtime::Simulation& simulation)
{
    transform.setPose(at.pose);
    if (!at.on.empty()) transform.attachTo(*cameras.at(indexOf(defs, at.on, "on")));
    if (at.follow) simulation.follow(transform, at.follow->body, at.follow->def);
}

void make(const Dress& dress, visual::VisualServer& visual, runtime::Simulation& simulation)
{
    visual.setEnvironment(dress.environment);
    std::vector<visual::Camera*> cameras;
    for (std::size_t i = 0; i < dress.cameras.size(); ++i)
        forMember(dress.places, "cameras", i, [&] {
            cameras.push_back(&visual.add(dress.cameras[i].def));
            put(*cameras.back(), dress.cameras[i], cameras, dress.cameras, simulation);
        });
    for (std::size_t i = 0; i < dress.lights.size(); ++i)
        forMember(dress.places, "lights", i,
                  [&] { put(visual.add(dress.lights[i].def), dress.lights[i], cameras, dress.cameras, simulation); });
    for (std::size_t i = 0; i < dress.views.size(); ++i)
        forMember(dress.places, "views", i, [&] {
            const SceneView& view = dress.views[i];
            visual.add(view.def, *cameras.at(indexOf(dress.cameras, view.camera, "camera")));
        });
}

/// Checks what a scene with cameras says of its picture.
Dress checked(const SceneDef& scene, const std::vector<BodyId>& ids)
{
    Dress dress{scene.cameras, scene.lights, scene.views, scene.environment.value_or(visual::EnvironmentDef{}),
                scene.places};
    for (std::size_t i = 0; i < dress.cameras.size(); ++i) {
        const visual::CameraDef& lens = dress.cameras[i].def;
        if (!(lens.far > lens.near)) fail("cameras[", i, "].far must be > near ", lens.near, " m, got ", lens.far);
        if (indexOf(dress.cameras, dress.cameras[i].def.name, "cameras") != i)
            fail("cameras[", i, "].name must differ from those of the other cameras, got '", dress.cameras[i].def.name,
                 "'");
    }
    place(dress.cameras, "cameras", dress.cameras, ids);
    place(dress.lights, "lights", dress.cameras, ids);
    for (std::size_t i = 0; i < dress.views.size(); ++i)
        (void)indexOf(dress.cameras, dress.views[i].camera, text("views[", i, "].camera"));
    if (dress.views.empty()) {
        SceneView& whole = dress.views.emplace_back();
        whole.def.quality = scene.look.quality;
        whole.camera = dress.cameras.front().def.name;
    }
    return dress;
}

void checkWithoutCameras(const SceneDef& scene)
{
    const auto refuse = [](const char* what) { fail(what, ": give the scene cameras, too: the look has its own"); };
    if (!scene.lights.empty()) refuse("lights[0]");
    if (!scene.views.empty()) refuse("views[0]");
    if (scene.environment) refuse("environment");
}

} // namespace

void dressScene(runtime::Simulation& simulation, const SceneDef& scene, const std::vector<BodyId>& ids)
{
    Dress dress;
    try {
        if (scene.cameras.empty()) return checkWithoutCameras(scene);
        dress = checked(scene, ids);
    } catch (const Error& error) {
        failAtPlace(scene.places, error.what());
    }
    simulation.dress(
        [&simulation, dress = std::move(dress)](visual::VisualServer& visual) { make(dress, visual, simulation); });
}

} // namespace filasofia::scene

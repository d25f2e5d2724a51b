#pragma once

#include "filasofia/record/recording.h"
#include "filasofia/runtime/simulation.h"

#include <functional>
#include <map>

/// What a recording holds about the picture: one event for every change of what is drawn or how.
namespace filasofia::runtime {

/// The first event: how the picture looks if the program does not dress its own scene.
struct SceneBegan {
    LookDef look = {};
    int width = 0;        ///< [px], in [1, 8192]
    int height = 0;       ///< [px], in [1, 8192]
    bool dressed = false; ///< the program dresses its own scene; if a picture was drawn, a SceneStage describes it
};
/// A file that later events name. The recording does not contain the file itself.
struct SceneFile {
    std::string file = {};
    std::uint64_t bytes = 0;
    std::uint64_t digest = 0; ///< hash of its bytes
};
struct SceneShown {
    std::uint32_t shown = 0; ///< ShownId
    BodyId body = {};
    ShowDef def = {}; ///< with the surface itself
};
struct SceneVisible {
    std::uint32_t shown = 0;
    bool visible = true;
};
struct SceneMaterial {
    std::uint32_t shown = 0;
    visual::Material material = {};
};
struct SceneUnshown {
    std::uint32_t shown = 0;
};
struct ScenePainted {
    BodyId body = {};
    PaintDef def = {};
};
struct SceneBled {
    BodyId body = {};
    surface::BleedingDef def = {};
    Vec3 gravity = {}; ///< [m/s^2], under which its blood flows
};
struct SceneTreated {
    BodyId body = {};
    surface::Treatment command = {};
};
struct SceneBurnt {
    BodyId body = {};
    surface::BurningDef def = {};
};
struct SceneElectrode {
    BodyId body = {};
    surface::ElectrodeDef def = {};
};
struct SceneActivated {
    BodyId body = {};
    int electrode = 0;
    bool on = false;
};
struct SceneDuct {
    BodyId body = {};
    surface::DuctDef def = {};
};
struct SceneSmoke {
    surface::SmokeDef def = {};
    Vec3 gravity = {}; ///< [m/s^2], against which it rises
};
struct SceneExtracted {
    surface::Extract command = {};
};
struct SceneDistension {
    surface::DistensionDef def = {};
    Vec3 gravity = {}; ///< [m/s^2], against which bubbles rise
};
struct SceneDistended {
    surface::Distend command = {};
};
/// All paint, blood, heat, burns and smoke are removed, and all pedals released.
struct SceneCleaned {};

struct StageMaterial {
    std::string name = {};
    visual::Material material = {};
};
struct StageView {
    visual::ViewDef def = {};
    int camera = 0; ///< index into the stage's cameras
    bool visible = true;
};
/// Lights, cameras, views and surroundings, which replace the former ones. The ScenePlaces that follows says where they
/// are.
struct SceneStage {
    visual::EnvironmentDef environment = {};
    std::vector<StageMaterial> materials = {};
    std::vector<visual::CameraDef> cameras = {};
    std::vector<visual::LightDef> lights = {};
    std::vector<StageView> views = {};
};
struct StagePlace {
    Pose pose = {}; ///< in the world
    bool visible = true;
};
struct ScenePlaces {
    std::vector<StagePlace> cameras = {}; ///< in the order of the stage's cameras
    std::vector<StagePlace> lights = {};
};

using SceneEvent =
    std::variant<SceneBegan, SceneFile, SceneShown, SceneVisible, SceneMaterial, SceneUnshown, ScenePainted,
                 SceneCleaned, SceneStage, ScenePlaces, SceneBled, SceneTreated, SceneBurnt, SceneElectrode,
                 SceneActivated, SceneDuct, SceneSmoke, SceneExtracted, SceneDistension, SceneDistended>;

constexpr auto fields(const SceneBegan*)
{
    using T = SceneBegan;
    return describe("SceneBegan", field("look", &T::look, "the picture"),
                    field("width", &T::width, "px", closed(1, 8192), "size of the picture"),
                    field("height", &T::height, "px", closed(1, 8192), "size of the picture"),
                    field("dressed", &T::dressed, "the program made its own scene"));
}
constexpr auto fields(const SceneFile*)
{
    using T = SceneFile;
    return describe("SceneFile", field("file", &T::file, "its name"), field("bytes", &T::bytes, "its length"),
                    field("digest", &T::digest, "hash of its bytes"));
}
constexpr auto fields(const SceneShown*)
{
    using T = SceneShown;
    return describe("SceneShown", field("shown", &T::shown, "its number"), field("body", &T::body, "the body"),
                    field("def", &T::def, "what is drawn"));
}
constexpr auto fields(const SceneVisible*)
{
    using T = SceneVisible;
    return describe("SceneVisible", field("shown", &T::shown, "its number"),
                    field("visible", &T::visible, "whether it is visible"));
}
constexpr auto fields(const SceneMaterial*)
{
    using T = SceneMaterial;
    return describe("SceneMaterial", field("shown", &T::shown, "its number"),
                    field("material", &T::material, "the new material"));
}
constexpr auto fields(const SceneUnshown*)
{
    return describe("SceneUnshown", field("shown", &SceneUnshown::shown, "its number"));
}
constexpr auto fields(const ScenePainted*)
{
    using T = ScenePainted;
    return describe("ScenePainted", field("body", &T::body, "the body"), field("def", &T::def, "the mark"));
}
constexpr auto fields(const SceneBled*)
{
    using T = SceneBled;
    return describe("SceneBled", field("body", &T::body, "the body"), field("def", &T::def, "how it bleeds"),
                    field("gravity", &T::gravity, "m/s^2", finite(), "under which its blood flows"));
}
constexpr auto fields(const SceneTreated*)
{
    using T = SceneTreated;
    return describe("SceneTreated", field("body", &T::body, "the body"),
                    field("command", &T::command, "what was done to its blood or heat"));
}
constexpr auto fields(const SceneBurnt*)
{
    using T = SceneBurnt;
    return describe("SceneBurnt", field("body", &T::body, "the body"), field("def", &T::def, "how it burns"));
}
constexpr auto fields(const SceneElectrode*)
{
    using T = SceneElectrode;
    return describe("SceneElectrode", field("body", &T::body, "the body"), field("def", &T::def, "its electrode"));
}
constexpr auto fields(const SceneActivated*)
{
    using T = SceneActivated;
    return describe("SceneActivated", field("body", &T::body, "the body"),
                    field("electrode", &T::electrode, "-", nonNegative(), "index among those of the body"),
                    field("on", &T::on, "whether its pedal is pressed"));
}
constexpr auto fields(const SceneDuct*)
{
    using T = SceneDuct;
    return describe("SceneDuct", field("body", &T::body, "the body"), field("def", &T::def, "a tube in it"));
}
constexpr auto fields(const SceneSmoke*)
{
    using T = SceneSmoke;
    return describe("SceneSmoke", field("def", &T::def, "the room that holds smoke"),
                    field("gravity", &T::gravity, "m/s^2", finite(), "against which it rises"));
}
constexpr auto fields(const SceneExtracted*)
{
    return describe("SceneExtracted", field("command", &SceneExtracted::command, "an opening that sucks smoke away"));
}
constexpr auto fields(const SceneDistension*)
{
    using T = SceneDistension;
    return describe("SceneDistension", field("def", &T::def, "a fluid that distends a cavity"),
                    field("gravity", &T::gravity, "m/s^2", finite(), "against which bubbles rise"));
}
constexpr auto fields(const SceneDistended*)
{
    return describe("SceneDistended", field("command", &SceneDistended::command, "pump and taps that were turned"));
}
constexpr auto fields(const SceneCleaned*) { return describe("SceneCleaned"); }
constexpr auto fields(const StageMaterial*)
{
    using T = StageMaterial;
    return describe("StageMaterial", field("name", &T::name, "in the pool"),
                    field("material", &T::material, "the material"));
}
constexpr auto fields(const StageView*)
{
    using T = StageView;
    return describe("StageView", field("def", &T::def, "the view"),
                    field("camera", &T::camera, "-", nonNegative(), "index in the stage"),
                    field("visible", &T::visible, "whether it is visible"));
}
constexpr auto fields(const SceneStage*)
{
    using T = SceneStage;
    return describe("SceneStage", field("environment", &T::environment, "surroundings"),
                    field("materials", &T::materials, "materials of the pool"),
                    field("cameras", &T::cameras, "cameras"), field("lights", &T::lights, "lights"),
                    field("views", &T::views, "views of the cameras"));
}
constexpr auto fields(const StagePlace*)
{
    using T = StagePlace;
    return describe("StagePlace", field("pose", &T::pose, "in the world"),
                    field("visible", &T::visible, "whether it is visible"));
}
constexpr auto fields(const ScenePlaces*)
{
    using T = ScenePlaces;
    return describe("ScenePlaces", field("cameras", &T::cameras, "where they are"),
                    field("lights", &T::lights, "where they are"));
}

/// Converts an event into the form that a recording stores, and back. Reading is strict: an Error names what is wrong.
record::SceneRecord recordOf(const SceneEvent& event);
SceneEvent eventOf(const record::SceneRecord& record);

/// The files that an event's materials name, in their order.
std::vector<std::string> filesOf(const SceneEvent& event);
/// Length and digest of a file; nothing if it cannot be read.
std::optional<SceneFile> digested(const std::string& file);

} // namespace filasofia::runtime

#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/import_words.h"
#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/import.h"
#include "filasofia/scene/scene_file.h"

#include <algorithm>
#include <iostream>

namespace filasofia::app {
namespace {

struct SaveCommandOptions {
    std::string source, scene;
    bool check = false;
    bool force = false;
    ImportWords import;
};

/// The first step after which the scene has another hash than the recording; 0: none.
std::uint64_t differentStep(const std::string& file, const std::vector<std::uint64_t>& recorded)
{
    const scene::SceneDef def = scene::loadScene(file);
    runtime::Simulation simulation(scene::simulationDef(def));
    static_cast<void>(scene::addScene(simulation, def));
    runtime::SteppedRun run(simulation);
    for (std::size_t i = 0; i < recorded.size(); ++i) {
        const std::uint64_t step = run.step().step;
        if (recorded[i] == 0) fail(file, ": step ", step, " was recorded without a hash to compare");
        if (simulation.physics().hash() != recorded[i]) return step;
    }
    return 0;
}

int save(const SaveCommandOptions& options)
{
    const bool recording = !scene::isSceneFile(options.source);
    if (options.check && !recording) fail("save: --check compares with a recording, got '", options.source, "'");
    if (const char* word = options.import.given(); word && recording)
        fail("save: ", word, " applies to scene files, got '", options.source, "'");
    std::error_code none;
    if (std::filesystem::equivalent(options.source, options.scene, none))
        fail("save: SCENE must be another file than '", options.source, "'");
    const auto isScene = [&](const std::filesystem::path& file) {
        return std::filesystem::equivalent(file, options.scene, none);
    };
    scene::RecordedScene made;
    if (recording)
        made = scene::sceneOf(options.source);
    else
        made.scene = scene::loadAnyScene(options.source, options.import.options());
    if (const auto read = std::ranges::find_if(made.scene.files, isScene); read != made.scene.files.end())
        fail("save: SCENE must be another file than '", read->string(), "', which SOURCE is made from");
    scene::saveScene(made.scene, options.scene, {.overwrite = options.force});
    for (const std::string& note : made.notes) std::cout << "note: " << note << '\n';
    std::cout << "wrote " << options.scene << '\n';
    if (!options.check) return 0;
    if (const std::uint64_t step = differentStep(options.scene, made.hashes)) {
        std::cout << "step " << step << " of the scene has another hash than that of the recording\n";
        return kFailed;
    }
    std::cout << "every step of the scene has the recorded hash (" << made.hashes.size() << " steps)\n";
    return 0;
}

} // namespace

Command saveCommand()
{
    // Static: there is one command line, and its targets must outlive this function.
    static SaveCommandOptions options;
    std::vector<Option> all = {
        {"SOURCE",
         &options.source,
         "A recording (--record FILE of any program), a robot (.urdf), a model of MuJoCo (.xml), a scene of SOFA "
         "(.scn), or "
         "a scene file, which becomes one without include, defaults and classes",
         "FILE",
         {},
         true},
        {"SCENE",
         &options.scene,
         "The scene file to write (.json); meshes come into a folder beside it",
         "FILE",
         {},
         true},
        {"--check", &options.check,
         "Run the scene, and compare every step with the recording; exit code 1 if one differs"},
        {"--force", &options.force, "Meshes replace files of their names in the folder beside SCENE"}};
    addOptions(options.import, all);
    return {.name = "save",
            .meaning = "Write what a program did as a scene file, from its recording",
            .options = std::move(all),
            .run = [] { return save(options); }};
}

} // namespace filasofia::app

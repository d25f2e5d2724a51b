#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <string>
#include <vector>

namespace filasofia::physics {
class PhysicsEngine;
class PhysicsServer;
} // namespace filasofia::physics

/// A whole scene of SOFA as the physics of a simulator. docs/guide/sofa.md says what of it becomes what.
namespace filasofia::sofaengine {

struct LoadDef {
    std::string file = {}; ///< a scene of SOFA: .scn or .xml
    /// where its meshes are, besides the scene's own folder; the first that has a file counts
    std::vector<std::string> folders = {};
    std::string plugins = {}; ///< folder of SOFA's libraries; empty: where the linked ones are
    double unit = 1.0;        ///< [m], > 0: the scene's unit of length
};
constexpr auto fields(const LoadDef*)
{
    using T = LoadDef;
    return describe("LoadDef", field("file", &T::file, "a scene of SOFA: .scn or .xml"),
                    field("folders", &T::folders, "where its meshes are, besides the scene's own folder"),
                    field("plugins", &T::plugins, "folder of SOFA's libraries; empty: where the linked ones are"),
                    field("unit", &T::unit, "m", positive(), "the scene's unit of length"));
}

/// An object of the scene that is a body of the simulator.
struct LoadedBody {
    /// its path in the scene: "Liver/Visu/VisualModel"; if siblings have the same name, the second has "#2" after it
    std::string name = {};
    BodyId id = {};
    bool picture = false; ///< an OglModel: made to be shown
};

/// What a scene has.
struct LoadedScene {
    double dt = 0.0;                     ///< [s] its step: a simulator with this period steps as SOFA does
    Vec3 gravity = {};                   ///< [m/s^2]
    std::vector<LoadedBody> bodies = {}; ///< in the order of the graph
    std::vector<std::string> left =
        {}; ///< states without elements, or with a mesh that bodies cannot have: nothing shows them

    /// The body with this path, or with this last part of it. Throws an Error if there is none, or more than one.
    [[nodiscard]] BodyId body(const std::string& name) const;
};

/// Makes a scene the physics of a server that has no bodies and has made no step. Its states with tetrahedra,
/// hexahedra, triangles or quads become soft bodies, rigid states become rigid ones, and pictures (OglModel) become
/// soft bodies of triangles. SOFA moves them all; commands other than gravity, pause, reset and tune() are refused.
/// A scene may cut its meshes: frames then have the new boundary. To reset or restore what was cut, the file is read
/// again: what tune() changed is gone then.
/// Throws an Error that names the file and what SOFA could not make, if this program was built without SOFA, or if the
/// server is in use.
LoadedScene load(physics::PhysicsServer& server, const LoadDef& def);

/// Whether an engine runs a loaded scene: then no other engine can take its bodies.
bool isLoadedScene(const physics::PhysicsEngine& engine);

} // namespace filasofia::sofaengine

#pragma once

#include "filasofia/scene/scene_def.h"

#include <filesystem>
#include <string>
#include <vector>

/// Files of other programs as scenes: robots in URDF, models of MuJoCo (MJCF), scenes of SOFA (.scn).
/// docs/guide/import.md says what is carried. The first two have z up; a scene has y up, as all others: x, y, z of the
/// file are x, -z, y of the world. What is inside a body keeps its coordinates.
namespace filasofia::scene {

/// How a file of another program is read.
struct ImportOptions {
    bool anyFolder = false; ///< files that it names may be outside its folder
    bool strict = false;    ///< what is not read is an Error
    /// Where "package://NAME/..." is looked for: NAME is the folder itself, or one in it. Files in it may be read. If
    /// no folder has it, the nearest folder above the file that is called NAME, or has a folder of that name, is meant.
    std::vector<std::filesystem::path> packages = {};
    /// [m] What a scene of SOFA calls a unit of length, > 0: 0.001 for one in millimetres. Its units of mass and time
    /// are kilograms and seconds, so pressures are then in kPa, and forces in mN.
    double unit = 1.0;
};

/// A scene, and what the file says that is not in it.
struct Imported {
    SceneDef scene = {};
    std::vector<std::vector<std::string>> joints = {}; ///< per body, the names of its joints, in their order
    std::vector<std::string> notes = {};               ///< "model.xml:12:3: <tendon> is not read", one per kind
};

/// A robot in URDF: one articulated rigid body whose base stands still. Throws an Error "FILE:LINE:COLUMN: ...".
Imported loadUrdf(const std::filesystem::path& file, const ImportOptions& options = {});

/// A model of MuJoCo: bodies with joints, geoms, and flexible bodies (flexcomp). Throws an Error as loadUrdf does.
Imported loadMjcf(const std::filesystem::path& file, const ImportOptions& options = {});

/// A scene of SOFA: tetrahedra and hexahedra with elasticity, rigid bodies, what holds and what collides, in units of
/// options.unit, kilograms and seconds. If its gravity is along z, it is turned to have y up. Throws an Error as
/// loadUrdf does.
Imported loadScn(const std::filesystem::path& file, const ImportOptions& options = {});

/// Whether a file is a scene by its name: .json, .urdf, .xml, .mjcf or .scn.
bool isSceneFile(const std::filesystem::path& file);

/// A scene of any of these kinds; the notes go to the log as warnings. An .xml file is a robot, a model or a
/// scene of SOFA, as its first element says.
SceneDef loadAnyScene(const std::filesystem::path& file, const ImportOptions& options = {});

} // namespace filasofia::scene

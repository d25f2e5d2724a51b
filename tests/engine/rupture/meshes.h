#pragma once

#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/engine/rupture/cut.h"
#include "filasofia/geometry/shapes.h"

#include <limits>

/// Meshes and blades for the tests of cutting.
namespace filasofia::engine {

/// A bar along x around the origin, 40 x 20 x 20 mm.
inline EditableMesh bar(int cells = 4)
{
    return EditableMesh(*geometry::shapes::block({0.04, 0.02, 0.02}, {2 * cells, cells, cells}));
}

inline double worstQuality(const MeshTopology& mesh)
{
    double worst = 1.0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) worst = std::min(worst, restQuality(mesh, t));
    return worst;
}

/// The violations as one line; empty if there are none.
inline std::string faultsOf(const EditableMesh& mesh, double quality = 0.15)
{
    std::string all;
    for (const TopologyViolation& v : checkTopology(mesh.data(), {.quality = quality, .volume = mesh.startVolume()}))
        all += std::string(name(v.fault)) + ": " + v.where + "; ";
    return all;
}

/// Moves a straight blade along `way` step by step.
inline RuptureReport sweep(EditableMesh& mesh, BladeStroke& stroke, Vec3 from, Vec3 to, Vec3 way, int steps,
                           const CutParameters& parameters = {})
{
    RuptureReport all;
    for (int i = 0; i < steps; ++i) {
        const Vec3 before = (static_cast<double>(i) / steps) * way, now = ((i + 1.0) / steps) * way;
        const BladeSegment segment{from + now, to + now, from + before, to + before};
        all += stroke.step(mesh, {&segment, 1}, parameters);
    }
    return all;
}

inline void finish(EditableMesh& mesh, BladeStroke& stroke, RuptureReport& report, const CutParameters& parameters = {})
{
    while (!stroke.finish(mesh, parameters, report)) {
    }
}

} // namespace filasofia::engine

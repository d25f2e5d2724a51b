#pragma once

#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/engine/rupture/cut.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/testing/fuzz_cuts.h"
#include "filasofia/testing/fuzz_random.h"

namespace filasofia::testing {
using namespace engine;

/// A smooth deformation that changes with time.
struct Waves {
    Vec3 centre, a1, a2, k1, k2;
    double amplitude = 0.0; ///< [m]; 0: at rest
    double omega = 0.0;     ///< [1/s]

    [[nodiscard]] Vec3 at(Vec3 p, double time) const;
};

/// A body being cut, with the data that follow its edits and the counts of the report.
class FuzzBody {
public:
    FuzzBody(EditableMesh mesh, const CutFuzzDef& def, CutFuzzReport& report, RuptureReport& sums, std::string name);

    EditableMesh mesh;
    double time = 0.0; ///< [s]
    Waves waves;

    void begin(); ///< places the mesh in the present deformation
    void step(BladeStroke& stroke, std::span<const BladeSegment> blade);
    void finish(BladeStroke& stroke);
    void tear(int node, Vec3 direction);
    void look(); ///< checks all invariants

    /// True if a connected part has element centres both more than the mean edge length below and more than that above
    /// height 0: then the cut was incomplete. `height` [m]: the signed distance of a point from the cut.
    template <class Height> bool bridged(const Height& height) const
    {
        int count = 0;
        const std::vector<int> part = parts(count);
        std::vector<double> low(count, 0.0), high(count, 0.0);
        for (int t = 0; t < mesh.tetrahedra(); ++t) {
            const double h = height(middleOf(mesh.data().tetrahedra[t], mesh.data().rest));
            low[part[t]] = std::min(low[part[t]], h);
            high[part[t]] = std::max(high[part[t]], h);
        }
        for (int p = 0; p < count; ++p)
            if (low[p] < -mesh.meanEdge() && high[p] > mesh.meanEdge()) return true;
        return false;
    }
    /// [-] The volume of the second largest part over that of the body.
    [[nodiscard]] double secondPart() const;

private:
    [[nodiscard]] std::vector<int> parts(int& count) const;
    void follow();
    void followPieces(const frame::TopologyEdit& edit);

    const CutFuzzDef& def_;
    CutFuzzReport& report_;
    RuptureReport& sums_;
    std::string name_;
    CutParameters parameters_;
    double bound_ = 0.0; ///< [-] lower bound of the quality of elements
    frame::TopologyMirror mirror_;
    std::vector<Vec3> positions_;
    Pieces pieces_, walked_; ///< found by a search near the edits and by a walk over the whole mesh: must agree
    int edits_ = 0;
};

/// The kinds of cuts.
enum class FuzzKind { Plane, Progressive, Curled, Resumed, Strip, Sawing, Scissors, Crossing, Tears, count_ };
const char* name(FuzzKind kind);

/// Makes one cut. Returns whether it left a bridge; nothing if that cannot be judged. `fresh`: the body has not been
/// cut yet.
std::optional<bool> fuzzCut(FuzzBody& body, FuzzKind kind, FuzzRandom& random, bool fresh);

} // namespace filasofia::testing

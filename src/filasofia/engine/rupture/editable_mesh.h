#pragma once

#include "filasofia/frame/topology_edit.h"

#include <cstdint>
#include <span>
#include <vector>

/// A tetrahedral mesh that is cut while it moves. Two primitives change it, and neither can break it: an edge is
/// bisected (all elements around it become two each; conforming, positive and volume-exact by construction), and a node
/// is split into one copy per group of its elements that hang together through unflagged faces. Nodes and elements are
/// only appended.
namespace filasofia::engine {

/// That a node lies on a cut surface, and where the surface runs there.
struct CutLabel {
    int sheet = 0;    ///< 0: on none
    int sequence = 0; ///< which of the mesh's labels this was: the newest is the largest
    Vec3 point;       ///< [m] at rest, on the surface
    Vec3 normal;      ///< unit, at rest
    friend bool operator==(const CutLabel&, const CutLabel&) = default;
};

/// All that a mesh under the knife is. Masks have bit f for face f, mirrored on both sides of an interior face.
struct MeshTopology {
    std::vector<geometry::Tetrahedron> tetrahedra;
    std::vector<std::array<int, 4>> neighbours; ///< across face f; -1: boundary
    std::vector<std::uint8_t> flagged;          ///< faces that a cut wants to open
    std::vector<std::uint8_t> deferred;         ///< the same of faces that could not be opened yet
    std::vector<std::uint8_t> opened;           ///< boundary faces that a cut or a tear made
    std::vector<std::uint8_t> gone;             ///< 1: removed; nothing happens to it any more
    std::vector<int> sides;                     ///< of a sheet: 2 sheet + (1: above); 0: not decided
    std::vector<std::vector<int>> around;       ///< per node, the tetrahedra that use it
    std::vector<Vec3> rest;                     ///< [m]
    std::vector<Vec3> current;                  ///< [m]
    std::vector<Vec3> previous;                 ///< [m] a step ago
    std::vector<CutLabel> labels;               ///< per node
    friend bool operator==(const MeshTopology&, const MeshTopology&) = default;
};

/// The tetrahedra around an edge, ascending through the shorter of its ends' lists.
void edgeStar(const MeshTopology& mesh, int a, int b, std::vector<int>& star);
double restQuality(const MeshTopology& mesh, int tetrahedron);
double restVolume(const MeshTopology& mesh, int tetrahedron); ///< [m^3]
bool onBoundary(const MeshTopology& mesh, int node);
bool onBoundary(const MeshTopology& mesh, int a, int b);

/// One writer per array: rest positions, elements and everything of the topology are written here alone, and the engine
/// copies them from the edits; positions are written by the engine alone, and copied here by moveTo() (between two
/// moveTo() they follow the edits by the same formula as the engine's, so that both stay equal to the last bit).
class EditableMesh {
public:
    /// The mesh is one that geometry::check() accepts.
    explicit EditableMesh(const geometry::TetMesh& mesh);

    [[nodiscard]] const MeshTopology& data() const { return data_; }
    [[nodiscard]] int nodes() const { return static_cast<int>(data_.rest.size()); }
    [[nodiscard]] int tetrahedra() const { return static_cast<int>(data_.tetrahedra.size()); }
    [[nodiscard]] double meanEdge() const { return meanEdge_; }         ///< [m] h, of the mesh as it was given
    [[nodiscard]] double diagonal() const { return diagonal_; }         ///< [m] of the box around it, as it was given
    [[nodiscard]] double startVolume() const { return startVolume_; }   ///< [m^3]
    [[nodiscard]] double reach(int node) const { return reach_[node]; } ///< [m] at rest no edge of it is longer

    /// A step was made: what was current is previous.
    void moveTo(std::span<const Vec3> positions);
    /// The body is somewhere else: both are the same.
    void placeAt(std::span<const Vec3> positions);
    [[nodiscard]] long moves() const { return moves_; }             ///< of moveTo() and placeAt(), until now
    [[nodiscard]] double lastMotion() const { return lastMotion_; } ///< [m] the largest way of a node in moveTo()

    /// The least quality that bisecting the edge would leave around it.
    [[nodiscard]] double qualityAfterBisecting(int a, int b, double s, const std::vector<int>& star) const;
    /// Every tetrahedron around the edge becomes two; the new node. Not within a transaction; s in (0, 1).
    int bisect(int a, int b, double s);
    /// The node slides along the edge, at rest and now. Whoever calls knows that no element suffers.
    void slide(int node, int toward, double s);
    [[nodiscard]] double volumeMoved() const { return volumeMoved_; } ///< [m^3] that slides took and gave, in all
    void addVolumeMoved(double volume) { volumeMoved_ += volume; }
    /// One copy of the node per further group of its elements that hang together through unflagged faces; how many.
    /// Opens the flagged faces between them. Starts a transaction, or goes on with it.
    int split(int node);

    struct Copy {
        int copy, from;
        int origin; ///< what `from` is itself a copy of, or `from`
    };
    struct OpenedFace {
        int tetrahedron, face, other, otherFace; ///< the two sides
    };
    /// What the transaction did until now.
    [[nodiscard]] const std::vector<Copy>& copies() const { return copies_; }
    [[nodiscard]] const std::vector<OpenedFace>& openedFaces() const { return openedFaces_; }
    /// The node that this one was before the transaction.
    [[nodiscard]] int originOf(int node) const;
    void commit();
    void rollBack(); ///< as if the transaction had never been: the same bits

    /// All elements of a piece: no blade finds them, and nothing of them opens.
    void remove(std::span<const int> tetrahedra);
    [[nodiscard]] bool isGone(int node) const
    {
        return !data_.around[node].empty() && data_.gone[data_.around[node].front()] != 0;
    }

    void setFlagged(int tetrahedron, int face, bool on) { setMask(data_.flagged, tetrahedron, face, on); }
    void setDeferred(int tetrahedron, int face, bool on) { setMask(data_.deferred, tetrahedron, face, on); }
    void setSide(int tetrahedron, int side) { data_.sides[tetrahedron] = side; }
    void setLabel(int node, const CutLabel& label) { data_.labels[node] = label; }
    int nextSequence() { return ++sequence_; }
    /// An id for a new cut surface: 1, 2, ...
    int newSheet() { return sheetNormals_.emplace_back(), static_cast<int>(sheetNormals_.size()); }
    [[nodiscard]] Vec3 sheetNormal(int sheet) const { return sheetNormals_[sheet - 1]; } ///< of its newest label
    void setSheetNormal(int sheet, Vec3 normal) { sheetNormals_[sheet - 1] = normal; }

    [[nodiscard]] bool edited() const { return !ops_.empty() || !dirty_.empty(); }
    /// All that happened since the last call.
    frame::TopologyEdit takeEdit(BodyId body);

private:
    struct SplitUndo {
        int node;
        int count; ///< of copies
        std::vector<int> around;
    };
    int addNode(Vec3 rest, Vec3 current, Vec3 previous);
    void setMask(std::vector<std::uint8_t>& mask, int tetrahedron, int face, bool on);
    [[nodiscard]] int faceTowards(int tetrahedron, int other) const;
    void publish(int tetrahedron, frame::TopologyEdit& edit);

    MeshTopology data_;
    double meanEdge_ = 0.0, diagonal_ = 0.0, startVolume_ = 0.0, lastMotion_ = 0.0, volumeMoved_ = 0.0;
    std::vector<double> reach_;
    int sequence_ = 0;
    long moves_ = 0;
    std::vector<Vec3> sheetNormals_;

    std::vector<SplitUndo> splits_;
    std::vector<Copy> copies_;
    std::vector<OpenedFace> openedFaces_;
    std::vector<int> group_, stack_, star_; // scratch

    std::uint64_t revision_ = 0;
    std::vector<frame::TopologyOp> ops_;
    std::vector<int> dirty_;                  ///< tetrahedra that changed
    std::vector<geometry::Tetrahedron> told_; ///< as the last edit said
    std::vector<std::uint8_t> toldBoundary_;  ///< faces that were boundary in the last edit
};

} // namespace filasofia::engine

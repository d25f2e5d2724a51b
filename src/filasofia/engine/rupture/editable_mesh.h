#pragma once

#include "filasofia/frame/topology_edit.h"

#include <cstdint>
#include <span>
#include <vector>

/// A tetrahedral mesh that is cut while it moves. Two primitives change it, and neither can make it invalid. Bisecting
/// an edge divides every element around it into two; the result is conforming, positive and volume-exact by
/// construction. Splitting a node makes one copy per group of its elements that are connected through unflagged faces.
/// Nodes and elements are only appended.
///
/// The same mesh serves a sheet of triangles (frame/topology_edit.h says how they are written): what is said of faces
/// and volumes then holds for edges and areas.
namespace filasofia::engine {

/// Where the path of a blade that bends is, as an unrolled sheet.
struct SweptPlace {
    int pass = 0;       ///< one blade without a break; 0: not known, or the blade is straight
    int segment = 0;    ///< its number in the blade
    double along = 0.0; ///< [m] along the chain
    double way = 0.0;   ///< [m] that the blade has gone there since its pass began
    friend bool operator==(const SweptPlace&, const SweptPlace&) = default;
};

/// Marks a node that lies on a cut surface, with the surface's plane there.
struct CutLabel {
    int sheet = 0;    ///< 0: on no sheet
    int sequence = 0; ///< position in the order of the mesh's labels: the newest has the largest
    Vec3 point;       ///< [m] at rest, on the surface
    Vec3 normal;      ///< unit, at rest; turns smoothly where the blade bends
    Vec3 facet;       ///< the same; that of one segment if the blade is not round there
    SweptPlace swept;
    friend bool operator==(const CutLabel&, const CutLabel&) = default;
};

/// The complete topological state of a mesh that can be cut. Masks have bit f for face f, mirrored on both sides of an
/// interior face.
struct MeshTopology {
    std::vector<geometry::Tetrahedron> tetrahedra;
    std::vector<std::array<int, 4>> neighbours; ///< neighbour across face f; -1: boundary
    std::vector<std::uint8_t> flagged;          ///< faces that a cut will open
    std::vector<std::uint8_t> deferred;         ///< faces that a cut could not open yet
    std::vector<std::uint8_t> opened;           ///< boundary faces that a cut or a tear created
    std::vector<std::uint8_t> gone;             ///< 1: removed and never edited again
    std::vector<int> sides;                     ///< 2 sheet + (1 if above it); 0: not decided
    std::vector<std::vector<int>> around;       ///< per node, the tetrahedra that use it
    std::vector<Vec3> rest;                     ///< [m]
    std::vector<Vec3> current;                  ///< [m]
    std::vector<Vec3> previous;                 ///< [m] one step ago
    std::vector<CutLabel> labels;               ///< per node
    friend bool operator==(const MeshTopology&, const MeshTopology&) = default;
};

/// The tetrahedra around an edge, in the order of the shorter of its ends' lists.
void edgeStar(const MeshTopology& mesh, int a, int b, std::vector<int>& star);
double restQuality(const MeshTopology& mesh, int tetrahedron);
double restVolume(const MeshTopology& mesh, int tetrahedron); ///< [m^3]; a triangle has an area [m^2]
/// Whether a face belongs to the boundary: one without a neighbour, or a triangle itself.
bool isBoundaryFace(const MeshTopology& mesh, int tetrahedron, int face);
bool onBoundary(const MeshTopology& mesh, int node);
bool onBoundary(const MeshTopology& mesh, int a, int b);

/// Each array has one writer. Rest positions, elements and all topology are written only here, and the engine copies
/// them from the edits. Positions are written only by the engine and copied here by moveTo(). Between two calls of
/// moveTo() they follow the edits by the engine's own formula, so both stay bit-identical.
class EditableMesh {
public:
    /// The mesh must be one that geometry::check() accepts.
    explicit EditableMesh(const geometry::TetMesh& mesh);
    /// A sheet of this thickness [m]. Its edges must have at most two triangles, which face the same way.
    EditableMesh(std::vector<Vec3> nodes, const std::vector<geometry::Triangle>& triangles, double thickness);

    [[nodiscard]] const MeshTopology& data() const { return data_; }
    [[nodiscard]] int nodes() const { return static_cast<int>(data_.rest.size()); }
    [[nodiscard]] int tetrahedra() const { return static_cast<int>(data_.tetrahedra.size()); }
    [[nodiscard]] bool isSheet() const { return thickness_ > 0.0; }
    /// [m^2] Area at rest of an opened face. In a sheet, the length of the edge times the thickness.
    [[nodiscard]] double faceArea(int tetrahedron, int face) const;
    [[nodiscard]] double meanEdge() const { return meanEdge_; } ///< [m] h, at construction
    [[nodiscard]] double diagonal() const { return diagonal_; } ///< [m] diagonal of the bounding box at construction
    [[nodiscard]] double startVolume() const { return startVolume_; }   ///< [m^3] or [m^2] at construction
    [[nodiscard]] double reach(int node) const { return reach_[node]; } ///< [m] upper bound of the node's edges at rest

    /// Call this after a step: the current positions become the previous ones.
    void moveTo(std::span<const Vec3> positions);
    /// Call this if the body was moved to another place: current and previous positions become equal.
    void placeAt(std::span<const Vec3> positions);
    [[nodiscard]] long moves() const { return moves_; }             ///< counts moveTo() and placeAt()
    [[nodiscard]] double lastMotion() const { return lastMotion_; } ///< [m] largest displacement of a node in moveTo()

    /// The lowest quality that bisecting the edge at s would leave around it.
    [[nodiscard]] double qualityAfterBisecting(int a, int b, double s, const std::vector<int>& star) const;
    /// Divides every tetrahedron around the edge into two and returns the new node; s lies in (0, 1). Not allowed
    /// within a transaction.
    int bisect(int a, int b, double s);
    /// Slides the node along the edge, in the rest, current and previous positions. The caller makes sure that no
    /// element becomes too bad.
    void slide(int node, int toward, double s);
    /// [m^3] Sum of the volumes that slides of boundary nodes added or removed.
    [[nodiscard]] double volumeMoved() const { return volumeMoved_; }
    void addVolumeMoved(double volume) { volumeMoved_ += volume; }
    /// Adds one copy of the node per further group of its elements that are connected through unflagged faces, opens
    /// the flagged faces between the groups, and returns the number of copies. Starts a transaction or continues it.
    int split(int node);

    struct Copy {
        int copy, from;
        int origin; ///< the node that `from` is itself a copy of, or `from`
    };
    struct OpenedFace {
        int tetrahedron, face, other, otherFace; ///< the two sides
    };
    /// What the transaction has done so far.
    [[nodiscard]] const std::vector<Copy>& copies() const { return copies_; }
    [[nodiscard]] const std::vector<OpenedFace>& openedFaces() const { return openedFaces_; }
    /// The node that this one was before the transaction.
    [[nodiscard]] int originOf(int node) const;
    void commit();
    void rollBack(); ///< restores the state before the transaction bit for bit

    /// Removes all elements of a piece: blades ignore them and none of their faces opens.
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
    int newPass() { return ++passes_; } ///< 1, 2, ...
    /// Adds a cut surface and returns its id: 1, 2, ...
    int newSheet() { return sheetNormals_.emplace_back(), static_cast<int>(sheetNormals_.size()); }
    /// The normal of the sheet's newest label.
    [[nodiscard]] Vec3 sheetNormal(int sheet) const { return sheetNormals_[sheet - 1]; }
    void setSheetNormal(int sheet, Vec3 normal) { sheetNormals_[sheet - 1] = normal; }

    [[nodiscard]] bool edited() const { return !ops_.empty() || !dirty_.empty(); }
    /// Returns all edits since the last call.
    frame::TopologyEdit takeEdit(BodyId body);

private:
    EditableMesh(const geometry::TetMesh& mesh, const std::vector<std::array<int, 4>>& neighbours, double thickness);
    struct SplitUndo {
        int node;
        int count; ///< number of copies
        std::vector<int> around;
    };
    int addNode(Vec3 rest, Vec3 current, Vec3 previous);
    void setMask(std::vector<std::uint8_t>& mask, int tetrahedron, int face, bool on);
    [[nodiscard]] int faceTowards(int tetrahedron, int other) const;
    void publish(int tetrahedron, frame::TopologyEdit& edit);

    MeshTopology data_;
    double thickness_ = 0.0; ///< [m] 0: tetrahedra, no sheet
    double meanEdge_ = 0.0, diagonal_ = 0.0, startVolume_ = 0.0, lastMotion_ = 0.0, volumeMoved_ = 0.0;
    std::vector<double> reach_;
    int sequence_ = 0, passes_ = 0;
    long moves_ = 0;
    std::vector<Vec3> sheetNormals_;

    std::vector<SplitUndo> splits_;
    std::vector<Copy> copies_;
    std::vector<OpenedFace> openedFaces_;
    std::vector<int> group_, stack_, star_; // scratch

    std::uint64_t revision_ = 0;
    std::vector<frame::TopologyOp> ops_;
    std::vector<int> dirty_;                       ///< tetrahedra that changed
    std::vector<geometry::Tetrahedron> published_; ///< elements as published in the last edit
    std::vector<std::uint8_t> publishedBoundary_;  ///< boundary faces as published in the last edit
};

} // namespace filasofia::engine

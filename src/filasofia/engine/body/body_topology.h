#pragma once

#include "filasofia/core/copied_ptr.h"
#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/stroke.h"
#include "filasofia/engine/rupture/tear.h"
#include "filasofia/frame/boundary.h"
#include "filasofia/geometry/box.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// A box around a body that is reused for some steps: `slack` bounds how far a node can have moved since it was built.
struct MovingBounds {
    geometry::Box box;
    double margin = 0.0; ///< [m]
};

/// Which springs belong to which elements, for a mass-spring body that may tear.
struct SpringsOfElements {
    /// Per element: its springs, in the order of geometry::kTetrahedronEdges.
    std::vector<std::array<int, 6>> ofElement;
    std::vector<int> sharedBy; ///< per spring: the number of elements that share it
};

/// An edge of a rod that is to be cut or torn.
struct RodCut {
    int edge = 0;
    double s = 0.5; ///< [-], in [0, 1], where along it
};

/// The editable mesh of a body that may be cut or torn, and the data that follow it triangle by triangle. Elements have
/// the same indices in the mesh and in the model.
struct BodyTopology {
    CopiedPtr<EditableMesh> mesh;                   ///< null: the body is never edited, or is a rod
    std::vector<std::array<int, 4>> boundaryPlaces; ///< per element and face: its triangle of the boundary; -1: inside
    std::vector<std::array<int, 2>> boundaryFaces;  ///< per triangle of the boundary: its element and face
    std::vector<int> vertices;                      ///< per node: its vertex of the surface; -1: not on the surface
    int vertexCount = 0;
    std::vector<std::uint8_t> opened; ///< per triangle of the boundary: 1 if a cut or a tear made it
    /// Per element and face: the cavity whose wall it is; -1: none. Empty without cavities.
    std::vector<std::array<int, 4>> wallOf;
    std::uint64_t revision = 0; ///< number of edits; 0: the mesh is as it was given
    std::uint64_t history = 0;  ///< hash of these edits
    /// The boundary that boundaryOf() last returned; null if it is outdated.
    mutable std::shared_ptr<const frame::Boundary> published;
    std::optional<Pieces> pieces;
    std::vector<Stroke> strokes;
    std::vector<BodyId> toldInVain; ///< tools of which a warning has told that a stroke of theirs opened nothing
    bool closed = false;            ///< it began as a shell without a rim
    bool edited = false;            ///< the mesh has been edited
    bool followed = false;          ///< the mesh moved with the body in the last step
    MovingBounds around;            ///< valid while `followed` holds
    Tearing tearing;
    SpringsOfElements springs;  ///< empty until a step looks for elements that may tear
    std::vector<Mat3> stresses; ///< [Pa] per element, from the last step that computed them
    /// Per block of sixteen elements: bits of the elements that may be near tearing.
    std::vector<std::uint16_t> stressed;
    std::vector<std::uint8_t> held;           ///< per node: 1 if it is pinned hard
    RuptureReport cut, torn;                  ///< what the last step opened
    std::vector<RodCut> cutEdges, tornEdges;  ///< rods only: what the last step crossed and tore, until it is applied
    std::vector<Vec3> places;                 ///< [m] rods only: its nodes after the last step, while `followed` holds
    std::vector<Attachment> startAttachments; ///< the scene's attachments before the body's first edit
    /// The model without any edit, for a reset; materials and pins that change later change here as well.
    CopiedPtr<SoftModel> start;
};

/// The topology of a body at the start; empty unless the body has dynamicTopology.
BodyTopology makeTopology(const SoftModel& model);

/// The node of an element that is not on its face `face`: face f lies opposite corner f. -1 in a shell.
int cornerBehind(int element, int face, const BodyTopology& topology);

/// The surface as frames carry it: the same object until the next edit. Null if the body is never cut or torn.
std::shared_ptr<const frame::Boundary> boundaryOf(const SoftModel& model, const BodyTopology& topology);

} // namespace filasofia::engine

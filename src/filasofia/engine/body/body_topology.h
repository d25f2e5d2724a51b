#pragma once

#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/rupture/cut.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/tear.h"
#include "filasofia/frame/boundary.h"
#include "filasofia/geometry/box.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// A rigid body's blades on their way through a body.
struct Stroke {
    BodyId tool;
    BladeStroke stroke;
    bool arrived = false; ///< something of the mesh was near them
    bool hasCut = false;
    double sinceCrossing = 0.0; ///< [m] that they went since they met an edge
    bool leaving = false;       ///< what waits is done, then it is over
    bool over = false;
};

/// A box around a body that is good for some steps: grown by how far nodes can have gone since it was made.
struct SlackBox {
    geometry::Box box;
    double slack = 0.0; ///< [m]
};

/// Of a mass-spring body that may tear.
struct SpringsOfElements {
    std::vector<std::array<int, 6>> ofElement; ///< in the order of geometry::kTetrahedronEdges
    std::vector<int> sharedBy;                 ///< per spring: by how many elements
};

/// What a body that may be cut is besides its model: the mesh as edits know it, and what follows it triangle by
/// triangle. Elements have the same numbers there and in the model.
struct BodyTopology {
    std::unique_ptr<EditableMesh> mesh;             ///< none: it is never edited
    std::vector<std::array<int, 4>> boundaryPlaces; ///< per element and face, in the boundary; -1: inside
    std::vector<std::array<int, 2>> boundaryFaces;  ///< per triangle of the boundary: its element and face
    std::vector<int> vertices;                      ///< per node: its number among the vertices of the surface; -1
    int vertexCount = 0;
    std::vector<std::uint8_t> opened;                    ///< per triangle of the boundary: a cut or a tear made it
    std::uint64_t revision = 0;                          ///< edits made; 0: as it was given
    std::uint64_t history = 0;                           ///< hash of these edits: what the mesh was made into
    mutable std::shared_ptr<const frame::Boundary> told; ///< by boundaryOf() to who asked last
    std::optional<Pieces> pieces;
    std::vector<Stroke> strokes;
    bool edited = false;   ///< it is no longer as it was made
    bool followed = false; ///< the mesh moved with the body in the last step
    SlackBox around;       ///< of the steps that it followed
    Tearing tearing;
    SpringsOfElements springs;                ///< empty until a step looks for what may tear
    std::vector<Mat3> stresses;               ///< [Pa] of the last step that looked, per element
    std::vector<std::uint16_t> stressed;      ///< per block of elements, bits of those that may be near tearing
    std::vector<std::uint8_t> held;           ///< per node
    RuptureReport cut, torn;                  ///< of the step: what it opened
    std::vector<Attachment> startAttachments; ///< what held it then
    std::unique_ptr<SoftModel> start; ///< what it is without any edit: what is given meanwhile goes there as well
};

/// Nothing but for a body with dynamicTopology.
BodyTopology makeTopology(const SoftModel& model);

/// The fourth node behind a face of an element: face f lies opposite corner f.
int cornerBehind(int element, int face, const BodyTopology& topology);

/// The surface as everyone outside sees it: the same object until the next edit. Null where nothing is ever cut.
std::shared_ptr<const frame::Boundary> boundaryOf(const SoftModel& model, const BodyTopology& topology);

} // namespace filasofia::engine

#pragma once

#include "filasofia/geometry/number_source.h"
#include "filasofia/geometry/split_solid.h"
#include "filasofia/geometry/tet_mesh.h"

#include <optional>

namespace filasofia::geometry {

/// A tetrahedral mesh as read from a file: nodes with the file's own numbers, elements with the position at which they
/// were read.
struct RawTetMesh {
    struct Node {
        std::int64_t number = 0;
        std::size_t place = 0;
        Vec3 position;
    };
    struct Element {
        std::int64_t number = 0;
        std::size_t place = 0; ///< as NumberSource::place()
        std::array<std::int64_t, 4> nodes{};
        int label = 0;
        Solid partOf = Solid::Simplex; ///< what the file has in its place
    };
    /// A node in the middle of an edge of a tetrahedron of second order. It is checked, and left out.
    struct Middle {
        std::int64_t node = 0;
        std::size_t element = 0;
    };
    std::vector<Node> nodes;
    std::vector<Element> elements;
    std::vector<Middle> middles;
    std::size_t split = 0; ///< solids that were no tetrahedra
    bool labelled = false; ///< the elements' labels mean something
    std::vector<MeshLabel> labelNames;
};

/// A number as a label; none if it is no whole number or too large.
std::optional<int> labelOf(double value);

/// The name of a solid.
std::string_view nameOf(Solid solid);

/// Adds the tetrahedra of a solid; `about` has all but its nodes. Throws an Error if it names a node twice. Every
/// element is added by this. Nodes of a simplex behind its four corners are those in the middle of its edges.
void addSolid(std::span<const std::int64_t> nodes, const RawTetMesh::Element& about, const NumberSource& file,
              RawTetMesh& mesh);

/// Throws an Error, with the line or byte in `nodeFile`, if two nodes have the same number.
void checkNumbers(const RawTetMesh& mesh, const NumberSource& nodeFile);

/// Finds each element's nodes by their numbers, checks every element against the bounds of check(), drops unused nodes
/// (a warning counts those in the middle of edges), and checks the whole mesh. Errors name the line or byte in
/// `elementFile` (in `nodeFile` for a node defined twice).
TetMesh resolve(const RawTetMesh& raw, const NumberSource& nodeFile, const NumberSource& elementFile,
                std::string_view name);

} // namespace filasofia::geometry

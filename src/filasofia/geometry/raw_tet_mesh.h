#pragma once

#include "filasofia/geometry/number_source.h"
#include "filasofia/geometry/tet_mesh.h"

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
    };
    std::vector<Node> nodes;
    std::vector<Element> elements;
    bool labelled = false; ///< the elements' labels mean something
    std::vector<MeshLabel> labelNames;
};

/// Finds each element's nodes by their numbers, checks every element against the bounds of check(), drops unused nodes,
/// and checks the whole mesh. Errors name the line or byte in `elementFile` (in `nodeFile` for a node defined twice).
TetMesh resolve(const RawTetMesh& raw, const NumberSource& nodeFile, const NumberSource& elementFile,
                std::string_view name);

} // namespace filasofia::geometry

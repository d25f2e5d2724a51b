#pragma once

#include "filasofia/geometry/raw_tet_mesh.h"

namespace filasofia::geometry {

/// The cells of one of VTK's unstructured grids, as a file has them.
struct VtkCells {
    std::vector<std::size_t> places;        ///< per cell, as NumberSource::place()
    std::vector<std::int64_t> connectivity; ///< the nodes of all cells
    std::vector<std::int64_t> offsets;      ///< per cell: where its nodes begin; then the end of the last
    std::vector<std::int64_t> types;        ///< per cell
    std::vector<int> labels;                ///< per cell; empty: none
};

/// Throws an Error at `place` if the offsets do not ascend from 0 to the end of the connectivity.
void checkOffsets(const VtkCells& cells, const NumberSource& file, std::size_t place);

/// Adds the tetrahedra of the cells. Points, lines and surfaces have no volume and are left out; throws an Error for
/// any other cell that cannot be split.
void addCells(const VtkCells& cells, const NumberSource& file, RawTetMesh& mesh);

} // namespace filasofia::geometry
